#include "pliant/controllers/qp_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A limit holds if it is violated by less than this part of the numbers it is computed from.
constexpr double kFeasibility = 1e-12;
// Numbers computed from the problem by a few sums are zero below this part of what they are made
// of.
constexpr double kRoundOff = 1e3 * kEpsilon;
// A normal may depend on others if less than this part of its length, in the norm of H⁻¹, remains.
constexpr double kSuspicious = 1e-4;
// A part of a normal that is less than this part of it is round-off.
constexpr double kNegligible = 1e-12;

// Two lanes of any x86-64 or ARMv8: sums in an order that we choose and no compiler option changes.
using Pair [[gnu::vector_size(16)]] = double;
using UnalignedPair [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;

inline Pair Load(const double* p) { return *reinterpret_cast<const UnalignedPair*>(p); }
inline void Store(double* p, Pair v) { *reinterpret_cast<UnalignedPair*>(p) = v; }

// a · b over [from, to), both multiples of 8.
inline double Dot(const double* a, const double* b, int from, int to) {
  Pair s0{}, s1{}, s2{}, s3{};
  for (int i = from; i < to; i += 8) {
    s0 += Load(a + i) * Load(b + i);
    s1 += Load(a + i + 2) * Load(b + i + 2);
    s2 += Load(a + i + 4) * Load(b + i + 4);
    s3 += Load(a + i + 6) * Load(b + i + 6);
  }
  const Pair s = (s0 + s1) + (s2 + s3);
  return s[0] + s[1];
}

// y += s a over [from, to), both even.
inline void AddScaled(double* y, double s, const double* a, int from, int to) {
  const Pair scale{s, s};
  for (int i = from; i < to; i += 2) Store(y + i, Load(y + i) + scale * Load(a + i));
}

// y += s a + t b over [from, to), both even.
inline void AddScaled(double* y, double s, const double* a, double t, const double* b, int from,
                      int to) {
  const Pair first{s, s}, second{t, t};
  for (int i = from; i < to; i += 2)
    Store(y + i, Load(y + i) + (first * Load(a + i) + second * Load(b + i)));
}

constexpr int DownTo8(int i) { return i & ~7; }

// f(0), …, f(kCount − 1) with constants.
template <int k>
using Constant = std::integral_constant<int, k>;

template <int kCount, class F>
[[gnu::always_inline]] inline void Unroll(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) { (f(Constant<k>{}), ...); }
  (std::make_integer_sequence<int, kCount>{});
}

// What the method for up to N variables works on. It lies as densely as N allows: what is written
// here and read there a multiple of 4 kB away stalls the processor.
template <int N>
struct Memory {
  static constexpr int kLimits = N + kMaxQpRows;
  using Square = std::array<double, N * N>;
  using Column = std::array<double, N>;
  using PerLimit = std::array<double, kLimits>;

  alignas(64) Square J, R, reflector, whitened;
  alignas(64) Column x, c, p, d, r, z, normal, remainder;
  Column reflection, inverse, bound, sign, multiplier, whole;
  PerLimit value, excess, slack, reach, size;
  std::array<std::int16_t, kLimits + 1> suspect;
  std::array<std::int16_t, N> limit;
  std::array<bool, N> equality;
  std::array<bool, kLimits> active;
};

// The method for up to N variables, N a multiple of 8; for exactly kVariables if that is not 0.
// Vectors are padded to N with zeros. A normal a carries the sign that makes its limit aᵀx ≥ b.
//
//   Jᵀ H J = I,   Jᵀ [a of the working set] = [R; 0],   J = J₀ Q,   J₀ = L⁻ᵀ D^-½,   H = L D Lᵀ
//
// J and R are stored by columns. Q is kept as reflectors, and J is J₀, until J must change.
template <int N, int kVariables>
class DualActiveSet {
 public:
  DualActiveSet(const QpProblem& problem, QpWorkspace& workspace, const QpOptions& options)
      : qp_{problem},
        w_{*new (workspace.memory.data()) Memory<N>},
        m_{problem.rows()},
        max_iterations_{options.max_iterations} {
    static_assert(sizeof(Memory<N>) <= sizeof(QpWorkspace));
    static_assert(std::is_trivially_destructible_v<Memory<N>>);
  }

  QpStatus Run(QpLimits& active, QpSolution& solution) {
    solution.x.setZero(n());
    solution.bound_multipliers.setZero(n());
    solution.row_multipliers.setZero(m_);
    solution.conflict.clear();
    QpStatus status = Iterate(active, solution);
    if (status != QpStatus::Solved && !IsUsable()) status = QpStatus::InvalidData;
    active.clear();
    if (status == QpStatus::InvalidData) solution.conflict.clear();
    if (status != QpStatus::InvalidData && status != QpStatus::NotConvex) {
      for (int i = 0; i < n(); ++i) solution.x(i) = w_.x[i];
      for (int k = 0; k < count_; ++k) active.push_back(Named(w_.limit[k], w_.sign[k]));
    }
    if (status == QpStatus::Solved || status == QpStatus::IterationLimit) {
      for (int k = 0; k < count_; ++k)
        Multiplier(solution, w_.limit[k]) = w_.sign[k] * w_.multiplier[k];
    } else if (status == QpStatus::Infeasible) {
      Prove(solution);
    }
    solution.iterations = iterations_;
    return solution.status = status;
  }

 private:
  int n() const {
    if constexpr (kVariables > 0) return kVariables;
    return qp_.variables();
  }

  QpStatus Iterate(const QpLimits& proposed, QpSolution& solution) {
    if (!Factor()) return QpStatus::NotConvex;
    QpStatus status = Start(proposed, solution);
    while (status == QpStatus::Solved && Scan(status)) status = Enter(solution);
    return status;
  }

  // --- the unconstrained problem ---

  // Elimination of [H | I | g], which leaves rows of D Lᵀ, of L⁻¹ and of L⁻¹ g; J₀ and c = J₀ᵀ g.
  bool Factor() {
    double* const S = w_.reflector.data();
    double* const J = w_.J.data();
    double* const y = w_.p.data();
    double* const c = w_.c.data();
    std::fill_n(J, n() * N, 0.0);
    for (int j = 0; j < n(); ++j) {
      const double* const column = qp_.H.data() + j * n();
      for (int i = j; i < n(); ++i) S[j * N + i] = column[i];
      for (int i = n(); i < N; ++i) S[j * N + i] = 0;
      J[j * N + j] = 1;
      y[j] = qp_.g(j);
    }
    const double smallest = 16 * n() * kEpsilon;
    bool convex = true;
    const auto take_pivot = [&](auto j) {
      const double pivot = S[j * N + j];
      convex &= pivot > smallest * qp_.H.data()[j * (n() + 1)];
      w_.inverse[j] = 1 / pivot;
    };
    // Rows are cleared by two pivots at a time, which halves the traffic to memory.
    const auto clear_two = [&](auto j, auto i) {
      const double a = -S[j * N + i] * w_.inverse[j];
      const double b = -S[(j + 1) * N + i] * w_.inverse[j + 1];
      AddScaled(S + i * N, a, S + j * N, b, S + (j + 1) * N, i & ~1, N);
      AddScaled(J + i * N, a, J + j * N, b, J + (j + 1) * N, 0, j + 2);
      y[i] += a * y[j] + b * y[j + 1];
    };
    const auto eliminate_two = [&](auto j) {
      take_pivot(j);
      const double a = -S[j * N + j + 1] * w_.inverse[j];
      AddScaled(S + (j + 1) * N, a, S + j * N, j, N);
      AddScaled(J + (j + 1) * N, a, J + j * N, 0, j + 2);
      y[j + 1] += a * y[j];
      take_pivot(j + 1);
    };
    if constexpr (kVariables > 0) {
      Unroll<kVariables / 2>([&](auto pair) {
        constexpr int j = 2 * pair;
        eliminate_two(Constant<j>{});
        Unroll<kVariables - 2 - j>(
            [&](auto k) { clear_two(Constant<j>{}, Constant<j + 2 + k>{}); });
      });
    } else {
      for (int j = 0; j + 1 < n(); j += 2) {
        eliminate_two(j);
        for (int i = j + 2; i < n(); ++i) clear_two(j, i);
      }
    }
    if (n() % 2 == 1) take_pivot(n() - 1);
    for (int j = 0; j < n(); ++j) {
      const double scale = std::sqrt(w_.inverse[j]);
      for (int i = 0; i < N; i += 2) Store(J + j * N + i, Pair{scale, scale} * Load(J + j * N + i));
      c[j] = scale * y[j];
    }
    for (int j = n(); j < N; ++j) c[j] = 0;
    return convex;
  }

  // --- limits: bounds, then rows ---

  double Lower(int limit) const {
    return limit < n() ? qp_.x_lower(limit) : qp_.lower(limit - n());
  }
  double Upper(int limit) const {
    return limit < n() ? qp_.x_upper(limit) : qp_.upper(limit - n());
  }

  QpLimit Named(int limit, double sign) const {
    return {.kind = limit < n() ? QpLimit::Kind::Bound : QpLimit::Kind::Row,
            .side = sign > 0 ? QpLimit::Side::Lower : QpLimit::Side::Upper,
            .index = static_cast<std::int16_t>(limit < n() ? limit : limit - n())};
  }

  double& Multiplier(QpSolution& solution, int limit) const {
    return limit < n() ? solution.bound_multipliers(limit) : solution.row_multipliers(limit - n());
  }

  // normal = a
  void ReadNormal(int limit, double sign) {
    double* const a = w_.normal.data();
    for (int j = n(); j < N; ++j) a[j] = 0;
    if (limit < n()) {
      std::fill_n(a, n(), 0.0);
      a[limit] = sign;
    } else {
      const double* const row = qp_.A.data() + (limit - n());
      for (int j = 0; j < n(); ++j) a[j] = sign * row[j * m_];
    }
  }

  // d = Jᵀ a, where J₀ is triangular
  void Whiten(int limit, double sign, double* d) {
    const double* const J = w_.J.data();
    for (int k = n(); k < N; ++k) d[k] = 0;
    if (limit < n()) {
      for (int k = 0; k < n(); ++k) d[k] = sign * J[k * N + limit];
    } else {
      ReadNormal(limit, sign);
      for (int k = 0; k < n(); ++k)
        d[k] = Dot(J + k * N, w_.normal.data(), 0, formed_ || N == 8 ? N : DownTo8(k) + 8);
    }
  }

  // Lengths of a normal, at most once per problem: reach = aᵀ H⁻¹ a, size = ‖a‖_1.
  void Measure(int limit) {
    if (!measured_) {
      std::fill_n(w_.reach.data(), n() + m_, 0.0);
      std::fill_n(w_.slack.data(), n() + m_, 0.0);
      measured_ = true;
    }
    if (w_.reach[limit] > 0) return;
    double* const d = w_.z.data();
    Whiten(limit, 1, d);
    w_.reach[limit] = Dot(d, d, 0, N) + std::numeric_limits<double>::min();
    w_.size[limit] = 1;
    if (limit >= n()) {
      w_.size[limit] = 0;
      for (int j = 0; j < n(); ++j) w_.size[limit] += std::abs(w_.normal[j]);
    }
  }

  // Violation of a measured limit that can be round-off.
  double Tolerance(int limit) const { return kFeasibility * w_.size[limit] * largest_x_; }

  // Whether a normal depends on the working set: r = R⁻¹ d₁, rest = ‖d₂‖². Where d₂ is so short
  // that round-off could make it, e = a − Σ r_k a_k decides, which no weight in H distorts.
  bool Depends(int limit, double sign, double* d, double whole, double& rest) {
    if (count_ == n()) return true;
    if (rest > kSuspicious * kSuspicious * whole) return false;
    const double size = Refine(limit, sign, d);
    rest = Tail(d);
    return rest == 0 || !(Largest(w_.remainder.data()) > kRoundOff * size);
  }

  // Makes r and d₂ anew from e, unless e is as small as it can be; returns the size of the numbers
  // it is computed from.
  double Refine(int limit, double sign, double* d) {
    double* const r = w_.r.data();
    double* const e = w_.remainder.data();
    double* const correction = w_.z.data();
    const double size = Remainder(limit, sign, r, e);
    if (Largest(e) <= 8 * kEpsilon * size) return size;
    for (int k = 0; k < n(); ++k) correction[k] = Dot(w_.J.data() + k * N, e, 0, N);
    for (int k = n(); k < N; ++k) correction[k] = 0;
    if (!formed_)
      for (int k = 0; k < count_; ++k) Reflect(k, correction);
    std::copy(correction + count_, correction + N, d + count_);
    SolveR(correction);
    for (int k = 0; k < count_; ++k) r[k] += correction[k];
    return Remainder(limit, sign, r, e);
  }

  double Largest(const double* a) const {
    double largest = 0;
    for (int i = 0; i < n(); ++i) largest = std::max(largest, std::abs(a[i]));
    return largest;
  }

  // e = a − Σ r_k a_k; returns the size of the numbers it is computed from.
  double Remainder(int limit, double sign, const double* r, double* e) {
    ReadNormal(limit, sign);
    std::copy_n(w_.normal.data(), N, e);
    double size = Largest(e);
    for (int k = 0; k < count_; ++k) {
      ReadNormal(w_.limit[k], w_.sign[k]);
      AddScaled(e, -r[k], w_.normal.data(), 0, N);
      size = std::max(size, std::abs(r[k]) * Largest(w_.normal.data()));
    }
    return size;
  }

  void Place(int k, int limit, double sign, double bound, bool equality) {
    w_.limit[k] = static_cast<std::int16_t>(limit);
    w_.sign[k] = sign;
    w_.bound[k] = sign * bound;
    w_.equality[k] = equality;
    w_.active[limit] = true;
  }

  void Move(int from, int to) {
    w_.limit[to] = w_.limit[from];
    w_.sign[to] = w_.sign[from];
    w_.bound[to] = w_.bound[from];
    w_.equality[to] = w_.equality[from];
    w_.whole[to] = w_.whole[from];
    w_.multiplier[to] = w_.multiplier[from];
  }

  // --- the start: the minimum on the equalities and the proposed limits with positive multipliers
  // ---

  QpStatus Start(const QpLimits& proposed, QpSolution& solution) {
    std::fill_n(w_.active.data(), n() + m_, false);
    for (int i = 0; i < n(); ++i)
      if (!(qp_.x_lower(i) < qp_.x_upper(i)) && !Fix(i, solution)) return QpStatus::Infeasible;
    for (int i = 0; i < m_; ++i)
      if (!(qp_.lower(i) < qp_.upper(i)) && !Fix(n() + i, solution)) return QpStatus::Infeasible;
    for (const QpLimit& l : proposed) {
      const bool is_row = l.kind == QpLimit::Kind::Row;
      if (l.index >= 0 && l.index < (is_row ? m_ : n()))
        Propose(is_row ? n() + l.index : l.index, l.side == QpLimit::Side::Lower ? 1 : -1, false);
    }
    for (int unchanged = 0; unchanged >= 0; unchanged = LeaveNegative()) {
      FactorWorkingSet(unchanged);
      SolveMultipliers();
    }
    double* const p = w_.p.data();
    for (int k = count_ - 1; k >= 0; --k) Reflect(k, p);
    Combine(p, 0, w_.x.data());
    NoteLargest();
    return QpStatus::Solved;
  }

  // An equality is proposed; false if the limit has lower > upper.
  bool Fix(int limit, QpSolution& solution) {
    if (Lower(limit) == Upper(limit)) {
      Propose(limit, 1, true);
      return true;
    }
    solution.conflict.push_back(Named(limit, 1));
    solution.conflict.push_back(Named(limit, -1));
    count_ = 0;
    std::fill_n(w_.x.data(), n(), 0.0);
    return false;
  }

  void Propose(int limit, double sign, bool equality) {
    const double bound = sign > 0 ? Lower(limit) : Upper(limit);
    if (count_ == N || w_.active[limit] || std::abs(bound) == kInfinity) return;
    Place(count_, limit, sign, bound, equality);
    Whiten(limit, sign, w_.whitened.data() + count_ * N);
    ++count_;
  }

  // Reflectors and R from limit `first` on. What depends on the limits before it is left out.
  void FactorWorkingSet(int first) {
    const int proposed = count_;
    count_ = first;
    for (int k = first; k < proposed; ++k) {
      const double* const whitened = w_.whitened.data() + k * N;
      double* const a = w_.R.data() + count_ * N;
      std::copy_n(whitened, N, a);
      for (int j = 0; j < count_; ++j) Reflect(j, a);
      const double whole = Dot(whitened, whitened, 0, N);
      double rest = Tail(a);
      if (rest <= kSuspicious * kSuspicious * whole) {
        std::copy_n(a, count_, w_.r.data());
        SolveR(w_.r.data());
      }
      if (Depends(w_.limit[k], w_.sign[k], a, whole, rest)) {
        w_.active[w_.limit[k]] = false;
        continue;
      }
      if (k != count_) MoveProposed(k, count_);
      w_.whole[count_] = whole;
      MakeReflector(a, rest);
      ++count_;
    }
  }

  void MoveProposed(int from, int to) {
    Move(from, to);
    std::copy_n(w_.whitened.data() + from * N, N, w_.whitened.data() + to * N);
  }

  // Copies what a has outside the working set to the next reflector; returns its squared length.
  double Tail(const double* a) {
    if (count_ == N) return 0;
    double* const v = w_.reflector.data() + count_ * N;
    for (int i = 0; i < N; ++i) v[i] = i < count_ ? 0.0 : a[i];
    return Dot(v, v, DownTo8(count_), N);
  }

  // Turns that tail into the reflector that maps a to [a_0 … a_{q−1}, diagonal, 0 …], q = count_.
  void MakeReflector(double* a, double rest) {
    const int q = count_;
    double diagonal = a[q];
    w_.reflection[q] = 0;
    if (q < n() - 1) {
      const double length = std::sqrt(rest);
      w_.reflection[q] = 1 / (rest + length * std::abs(diagonal));
      diagonal = diagonal > 0 ? -length : length;
      w_.reflector[q * N + q] -= diagonal;
    }
    a[q] = diagonal;
    w_.inverse[q] = 1 / diagonal;
  }

  void Reflect(int k, double* a) const {
    const double* const v = w_.reflector.data() + k * N;
    const int from = DownTo8(k);
    AddScaled(a, -w_.reflection[k] * Dot(v, a, from, N), v, from, N);
  }

  // With x = J p:  p_1 = R⁻ᵀ b, p_2 = −(Qᵀ c)_2, multipliers = R⁻¹ (p + Qᵀ c)_1.
  void SolveMultipliers() {
    double* const p = w_.p.data();
    double* const u = w_.multiplier.data();
    for (int i = 0; i < N; ++i) p[i] = -w_.c[i];
    for (int k = 0; k < count_; ++k) Reflect(k, p);
    for (int k = 0; k < count_; ++k) {
      const double* const column = w_.R.data() + k * N;
      double sum = w_.bound[k];
      for (int i = 0; i < k; ++i) sum -= column[i] * p[i];
      sum *= w_.inverse[k];
      u[k] = sum - p[k];
      p[k] = sum;
    }
    SolveR(u);
  }

  // Takes limits with negative multipliers out; returns the first place that changed, or −1.
  int LeaveNegative() {
    int kept = 0, first = -1;
    for (int k = 0; k < count_; ++k) {
      if (w_.multiplier[k] < 0 && !w_.equality[k]) {
        w_.active[w_.limit[k]] = false;
        if (first < 0) first = k;
      } else {
        if (k != kept) MoveProposed(k, kept);
        ++kept;
      }
    }
    count_ = kept;
    return first;
  }

  void NoteLargest() { largest_x_ = std::max(largest_x_, Largest(w_.x.data())); }

  // --- violations ---

  // value = [x; A x], excess = what each is outside its limits
  void Evaluate() {
    const double* const A = qp_.A.data();
    const double* const x = w_.x.data();
    double* const value = w_.value.data();
    double* const excess = w_.excess.data();
    for (int i = 0; i < n(); ++i) {
      value[i] = x[i];
      excess[i] = std::max(qp_.x_lower(i) - x[i], x[i] - qp_.x_upper(i));
    }
    const auto two_rows = [&](int row, Pair sum) {
      const Pair below = Load(qp_.lower.data() + row) - sum;
      const Pair above = sum - Load(qp_.upper.data() + row);
      Store(value + n() + row, sum);
      Store(excess + n() + row, below > above ? below : above);
    };
    const auto four_rows = [&](int row) {
      Pair s0{}, s1{};
      const double* column = A + row;
      for (int j = 0; j < n(); ++j, column += m_) {
        const Pair scale{x[j], x[j]};
        s0 += scale * Load(column);
        s1 += scale * Load(column + 2);
      }
      two_rows(row, s0);
      two_rows(row + 2, s1);
    };
    if (m_ >= 4) {
      for (int row = 0; row + 4 <= m_; row += 4) four_rows(row);
      if (m_ % 4 != 0) four_rows(m_ - 4);
    } else {
      for (int row = 0; row < m_; ++row) {
        double sum = 0;
        for (int j = 0; j < n(); ++j) sum += A[j * m_ + row] * x[j];
        value[n() + row] = sum;
        excess[n() + row] = std::max(qp_.lower(row) - sum, sum - qp_.upper(row));
      }
    }
  }

  // Whether a limit is violated; entering_ is then the one that costs most to satisfy alone.
  bool Scan(QpStatus& status) {
    Evaluate();
    int suspects = 0;
    double finite = 0;
    for (int i = 0; i < n(); ++i) finite += 0 * w_.x[i];
    for (int i = 0; i < n() + m_; ++i) {
      w_.suspect[suspects] = static_cast<std::int16_t>(i);
      suspects += int{!(w_.excess[i] <= 0)} & int{!w_.active[i]};
    }
    entering_ = -1;
    double worst = 0;
    for (int k = 0; k < suspects; ++k) {
      const int i = w_.suspect[k];
      const double violation = w_.excess[i];
      Measure(i);
      finite += 0 * violation;
      const double cost = violation * violation / w_.reach[i];
      const bool leads = (violation > std::max(Tolerance(i), w_.slack[i])) & (cost > worst);
      worst = leads ? cost : worst;
      entering_ = leads ? i : entering_;
    }
    if (finite != 0) status = QpStatus::InvalidData;
    if (finite != 0 || entering_ < 0) return false;
    violation_ = w_.excess[entering_];
    sign_ = w_.value[entering_] < Lower(entering_) ? 1 : -1;
    return true;
  }

  // --- the dual method ---

  // Raises the multiplier of entering_ until its limit holds; limits whose multipliers reach zero
  // on the way leave. x is then again the minimum on the working set.
  QpStatus Enter(QpSolution& solution) {
    const int p = entering_;
    const double bound = sign_ > 0 ? Lower(p) : Upper(p);
    double* const d = w_.d.data();
    double* const r = w_.r.data();
    double* const u = w_.multiplier.data();
    Whiten(p, sign_, d);
    if (!formed_)
      for (int k = 0; k < count_; ++k) Reflect(k, d);
    const double whole = w_.reach[p];
    double multiplier = 0;
    while (iterations_ < max_iterations_) {
      ++iterations_;
      std::copy_n(d, count_, r);
      SolveR(r);
      double rest = Tail(d);
      const bool depends = Depends(p, sign_, d, whole, rest);

      double step = kInfinity;
      int leaving = -1;
      for (int k = 0; k < count_; ++k) {
        if (w_.equality[k] || !(r[k] > 0) || !Matters(k, whole) || u[k] >= step * r[k]) continue;
        step = u[k] / r[k];
        leaving = k;
      }
      bool enters = false;
      if (depends) {
        const bool in_doubt = leaving < 0 || violation_ <= 1e6 * Tolerance(p);
        if (in_doubt && !Contradicts(p, sign_ * bound)) {
          w_.slack[p] = 2 * violation_;
          return QpStatus::Solved;
        }
        if (leaving < 0) {
          solution.conflict.push_back(Named(p, sign_));
          return QpStatus::Infeasible;
        }
      } else if (violation_ <= step * rest) {
        enters = true;
        step = violation_ / rest;
      }
      if (!formed_) FormJ();
      for (int k = 0; k < count_; ++k) u[k] -= step * r[k];
      multiplier += step;
      if (!depends) {
        Combine(d, count_, w_.z.data());
        AddScaled(w_.x.data(), step, w_.z.data(), 0, N);
        violation_ -= step * rest;
        NoteLargest();
      }
      if (enters) {
        Place(count_, p, sign_, bound, Lower(p) == Upper(p));
        u[count_] = multiplier;
        w_.whole[count_] = whole;
        Add(rest);
        return QpStatus::Solved;
      }
      Drop(leaving);
    }
    return QpStatus::IterationLimit;
  }

  // Whether a limit with a = Σ r_k a_k asks for more than the working set gives, b > Σ r_k b_k, and
  // not by round-off in x or r only.
  bool Contradicts(int limit, double bound) {
    if (count_ == n()) Refine(limit, sign_, w_.d.data());
    double gap = bound, size = std::abs(bound);
    for (int k = 0; k < count_; ++k) {
      gap -= w_.r[k] * w_.bound[k];
      size += std::abs(w_.r[k] * w_.bound[k]);
    }
    return gap > kRoundOff * size + n() * Largest(w_.remainder.data()) * largest_x_;
  }

  // Whether limit k of the working set has a part in a = Σ r_k a_k that is more than round-off.
  bool Matters(int k, double whole) const {
    return w_.r[k] * w_.r[k] * w_.whole[k] > kNegligible * kNegligible * whole;
  }

  // Farkas: the entering normal is Σ r_k a_k, with r_k ≤ 0 wherever limit k is not an equality.
  void Prove(QpSolution& solution) const {
    if (solution.conflict.size() != 1) return;
    Multiplier(solution, entering_) = sign_;
    for (int k = 0; k < count_; ++k) {
      if (!Matters(k, w_.reach[entering_])) continue;
      const double value = -w_.r[k] * w_.sign[k];
      solution.conflict.push_back(Named(w_.limit[k], value));
      Multiplier(solution, w_.limit[k]) = value;
    }
  }

  // J := J Q
  void FormJ() {
    for (int k = 0; k < count_; ++k) {
      Combine(w_.reflector.data() + k * N, k, w_.z.data());
      ReflectJ(k);
    }
    formed_ = true;
  }

  // Reflector v_k on the free columns of J; z = J v_k.
  void ReflectJ(int k) {
    if (w_.reflection[k] == 0) return;
    const double* const v = w_.reflector.data() + k * N;
    for (int i = k; i < n(); ++i)
      AddScaled(w_.J.data() + i * N, -w_.reflection[k] * v[i], w_.z.data(), 0, N);
  }

  // out = Σ p_k J_k over k ≥ from
  void Combine(const double* p, int from, double* out) const {
    for (int b = 0; b < N; b += 8) {
      Pair s0{}, s1{}, s2{}, s3{};
      for (int k = from; k < n(); ++k) {
        const double* const column = w_.J.data() + k * N + b;
        const Pair scale{p[k], p[k]};
        s0 += scale * Load(column);
        s1 += scale * Load(column + 2);
        s2 += scale * Load(column + 4);
        s3 += scale * Load(column + 6);
      }
      Store(out + b, s0);
      Store(out + b + 2, s1);
      Store(out + b + 4, s2);
      Store(out + b + 6, s3);
    }
  }

  // r := R⁻¹ r
  void SolveR(double* r) const {
    for (int j = count_ - 1; j >= 0; --j) {
      const double* const column = w_.R.data() + j * N;
      r[j] *= w_.inverse[j];
      for (int i = 0; i < j; ++i) r[i] -= column[i] * r[j];
    }
  }

  // The limit with Jᵀ a = d joins the working set; z = J d outside of it is at hand.
  void Add(double rest) {
    const int q = count_;
    double* const a = w_.R.data() + q * N;
    std::copy_n(w_.d.data(), N, a);
    MakeReflector(a, rest);
    AddScaled(w_.z.data(), -a[q], w_.J.data() + q * N, 0, N);
    ReflectJ(q);
    ++count_;
  }

  // A limit leaves: rotations restore R, and turn J and d with it.
  void Drop(int leaving) {
    w_.active[w_.limit[leaving]] = false;
    --count_;
    for (int k = leaving; k < count_; ++k) {
      Move(k + 1, k);
      std::copy_n(w_.R.data() + (k + 1) * N, k + 2, w_.R.data() + k * N);
    }
    for (int k = leaving; k < count_; ++k) {
      double* const column = w_.R.data() + k * N;
      const double length = std::sqrt(column[k] * column[k] + column[k + 1] * column[k + 1]);
      const double c = column[k] / length, s = column[k + 1] / length;
      column[k] = length;
      w_.inverse[k] = 1 / length;
      for (int j = k + 1; j < count_; ++j) Rotate(c, s, w_.R[j * N + k], w_.R[j * N + k + 1]);
      Rotate(c, s, w_.d[k], w_.d[k + 1]);
      for (int i = 0; i < N; ++i) Rotate(c, s, w_.J[k * N + i], w_.J[(k + 1) * N + i]);
    }
  }

  static void Rotate(double c, double s, double& a, double& b) {
    const double rotated = c * a + s * b;
    b = c * b - s * a;
    a = rotated;
  }

  bool IsUsable() const {
    for (int j = 0; j < n(); ++j)
      if (!qp_.H.col(j).tail(n() - j).allFinite()) return false;
    const auto is_range = [](const auto& lower, const auto& upper) {
      return !lower.hasNaN() && !upper.hasNaN() && (lower.array() < kInfinity).all() &&
             (upper.array() > -kInfinity).all();
    };
    return qp_.g.allFinite() && qp_.A.allFinite() && is_range(qp_.x_lower, qp_.x_upper) &&
           is_range(qp_.lower, qp_.upper);
  }

  const QpProblem& qp_;
  Memory<N>& w_;
  const int m_;
  const int max_iterations_;
  int iterations_ = 0;
  int count_ = 0;  // limits in the working set
  bool measured_ = false, formed_ = false;
  int entering_ = -1;
  double sign_ = 1;
  double violation_ = 0;
  double largest_x_ = 0;
};

bool HasItsSizes(const QpProblem& qp) {
  const Eigen::Index n = qp.H.rows(), m = qp.A.rows();
  return n > 0 && qp.H.cols() == n && qp.g.size() == n && qp.x_lower.size() == n &&
         qp.x_upper.size() == n && qp.A.cols() == n && qp.lower.size() == m && qp.upper.size() == m;
}

template <int N>
QpStatus SolveUpTo(const QpProblem& problem, QpWorkspace& workspace, QpLimits& active,
                   QpSolution& solution, const QpOptions& options) {
  if constexpr (N < kMaxQpVariables) {
    if (problem.variables() > N)
      return SolveUpTo<N + 8>(problem, workspace, active, solution, options);
  }
  return DualActiveSet<N, 0>{problem, workspace, options}.Run(active, solution);
}

}  // namespace

QpProblem::QpProblem(int variables, int rows) {
  Require(variables > 0 && variables <= kMaxQpVariables,
          "variables of a QP must be from 1 to " + Text(kMaxQpVariables), variables);
  Require(rows >= 0 && rows <= kMaxQpRows, "rows of a QP must be from 0 to " + Text(kMaxQpRows),
          rows);
  H.setIdentity(variables, variables);
  g.setZero(variables);
  x_lower.setConstant(variables, -kInfinity);
  x_upper.setConstant(variables, kInfinity);
  A.setZero(rows, variables);
  lower.setConstant(rows, -kInfinity);
  upper.setConstant(rows, kInfinity);
}

QpLimits::QpLimits(std::initializer_list<QpLimit> limits) {
  for (const QpLimit& limit : limits) push_back(limit);
}

void QpLimits::clear() {
  std::fill_n(limits_.begin(), size_, QpLimit{});
  size_ = 0;
}

void QpLimits::push_back(const QpLimit& limit) {
  if (size_ < static_cast<int>(limits_.size())) limits_[size_++] = limit;
}

QpStatus Solve(const QpProblem& problem, QpWorkspace& workspace, QpLimits& active,
               QpSolution& solution, const QpOptions& options) {
  if (!HasItsSizes(problem)) return solution.status = QpStatus::InvalidData;
  if (problem.variables() == 6)
    return DualActiveSet<8, 6>{problem, workspace, options}.Run(active, solution);
  if (problem.variables() == 7)
    return DualActiveSet<8, 7>{problem, workspace, options}.Run(active, solution);
  return SolveUpTo<8>(problem, workspace, active, solution, options);
}

}  // namespace pliant
