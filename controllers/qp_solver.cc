#include "pliant/controllers/qp_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A limit holds if it is violated by less than this part of the numbers it is computed from.
constexpr double kFeasibility = 1e-12;
// A normal depends on others if less than this part of the numbers it is computed from remains.
constexpr double kDependence = 1e3 * kEpsilon;

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

constexpr int DownTo8(int i) { return i & ~7; }

// f(0), …, f(kCount − 1) with constants.
template <int kCount, class F>
[[gnu::always_inline]] inline void Unroll(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) {
    (f(std::integral_constant<int, k>{}), ...);
  }(std::make_integer_sequence<int, kCount>{});
}

// The method for up to N variables, N a multiple of 8; for exactly kVariables if that is not 0. Vectors are padded to N with zeros, H with the
// identity. Every normal carries the sign that makes its limit aᵀx ≥ b.
//
//   J = L⁻ᵀ D^-½ Q with H = L D Lᵀ, so Jᵀ H J = I;  Jᵀ [a of the working set] = [R; 0]
//
// J is stored by columns, as is R. Q is a product of reflectors until a limit must enter.
template <int N, int kVariables>
class DualActiveSet {
 public:
  DualActiveSet(const QpProblem& problem, QpWorkspace& workspace, const QpOptions& options)
      : qp_{problem},
        w_{workspace},
        n_{problem.variables()},
        m_{problem.rows()},
        max_iterations_{options.max_iterations} {}

  QpStatus Run(QpLimits& active, QpSolution& solution) {
    solution.x.setZero(n_);
    solution.bound_multipliers.setZero(n_);
    solution.row_multipliers.setZero(m_);
    solution.conflict.clear();
    QpStatus status = Iterate(active, solution);
    if (status != QpStatus::Solved && !IsUsable()) status = QpStatus::InvalidData;
    active.clear();
    if (status == QpStatus::NotConvex || status == QpStatus::InvalidData) count_ = 0;
    for (int k = 0; k < count_; ++k) active.push_back(Named(w_.limit[k], w_.sign[k]));
    if (status == QpStatus::InvalidData) {
      solution.x.setZero();
      solution.bound_multipliers.setZero();
      solution.row_multipliers.setZero();
      solution.conflict.clear();
    } else if (status == QpStatus::Solved || status == QpStatus::IterationLimit) {
      for (int k = 0; k < count_; ++k) SetMultiplier(solution, w_.limit[k], w_.sign[k] * w_.multiplier[k]);
    }
    if (status != QpStatus::NotConvex && status != QpStatus::InvalidData)
      for (int i = 0; i < n_; ++i) solution.x(i) = w_.x[i];
    solution.iterations = iterations_;
    return solution.status = status;
  }

 private:
  QpStatus Iterate(const QpLimits& proposed, QpSolution& solution) {
    if (!Factor()) return QpStatus::NotConvex;
    std::fill_n(w_.active.data(), n_ + m_, false);
    std::fill_n(w_.slack.data(), n_ + m_, 0.0);
    std::fill_n(w_.reach.data(), n_ + m_, 0.0);
    Start(proposed);
    QpStatus status = Scan(solution);
    if (status == QpStatus::Solved && entering_ >= 0) FormJ();
    while (status == QpStatus::Solved && entering_ >= 0) {
      status = Enter(solution);
      if (status == QpStatus::Solved) status = Scan(solution);
    }
    return status;
  }

  // --- the unconstrained problem ---

  // Elimination of [H | I | g]: rows of D Lᵀ, of L⁻¹ and of L⁻¹ g; then J = L⁻ᵀ D^-½, c = Jᵀ g.
  bool Factor() {
    double* const S = w_.schur.data();
    double* const J = w_.J.data();
    double* const y = w_.y.data();
    double* const c = w_.c.data();
    std::fill_n(J, n_ * N, 0.0);
    for (int j = 0; j < n_; ++j) {
      const double* const column = qp_.H.data() + j * n_;
      for (int i = j; i < n_; ++i) S[j * N + i] = column[i];
      J[j * N + j] = 1;
      y[j] = qp_.g(j);
    }
    const double smallest = 16 * n_ * kEpsilon;
    double least = kInfinity;
    const auto clear = [&](auto j, auto i) {
      const double m = -S[j * N + i] * w_.inverse_pivot[j];
      AddScaled(S + i * N, m, S + j * N, i & ~1, N);
      AddScaled(J + i * N, m, J + j * N, 0, (j | 1) + 1);
      y[i] += m * y[j];
    };
    const auto eliminate = [&](auto j) {
      const double pivot = S[j * N + j];
      least = std::min(pivot - smallest * qp_.H(j, j), least);
      w_.inverse_pivot[j] = 1 / pivot;
      if constexpr (kVariables > 0) {
        Unroll<kVariables - 1 - j>([&](auto k) { clear(j, std::integral_constant<int, j + 1 + k>{}); });
      } else {
        for (int i = j + 1; i < n_; ++i) clear(static_cast<int>(j), i);
      }
    };
    if constexpr (kVariables > 0) {
      Unroll<kVariables>(eliminate);
    } else {
      for (int j = 0; j < n_; ++j) eliminate(j);
    }
    for (int j = 0; j < n_; ++j) {
      const double scale = std::sqrt(w_.inverse_pivot[j]);
      for (int i = 0; i < N; i += 2) Store(J + j * N + i, Load(J + j * N + i) * Pair{scale, scale});
      c[j] = scale * y[j];
    }
    for (int j = n_; j < N; ++j) c[j] = 0;
    return least > 0 && largest < inf;
  }

  // --- limits: bounds, then rows ---

  double Lower(int limit) const { return limit < n_ ? qp_.x_lower(limit) : qp_.lower(limit - n_); }
  double Upper(int limit) const { return limit < n_ ? qp_.x_upper(limit) : qp_.upper(limit - n_); }

  QpLimit Named(int limit, double sign) const {
    return {.kind = limit < n_ ? QpLimit::Kind::Bound : QpLimit::Kind::Row,
            .side = sign > 0 ? QpLimit::Side::Lower : QpLimit::Side::Upper,
            .index = static_cast<std::int16_t>(limit < n_ ? limit : limit - n_)};
  }

  void SetMultiplier(QpSolution& solution, int limit, double value) const {
    if (limit < n_) {
      solution.bound_multipliers(limit) = value;
    } else {
      solution.row_multipliers(limit - n_) = value;
    }
  }

  void ReadNormal(int limit, double sign) {
    double* const a = w_.normal.data();
    std::fill_n(a, N, 0.0);
    if (limit < n_) {
      a[limit] = sign;
    } else {
      for (int j = 0; j < n_; ++j) a[j] = sign * qp_.A(limit - n_, j);
    }
  }

  // Size of the numbers that aᵀx − b is computed from.
  double Scale(int limit, double bound) const {
    const double sum = limit < n_ ? 1 : qp_.A.row(limit - n_).cwiseAbs().sum();
    return sum * largest_x_ + std::abs(bound);
  }

  // d = Jᵀ a
  void Whiten(int limit, double sign, double* d) {
    const double* const J = w_.J.data();
    std::fill_n(d + n_, N - n_, 0.0);
    if (limit < n_) {
      for (int k = 0; k < n_; ++k) d[k] = sign * J[k * N + limit];
    } else {
      ReadNormal(limit, sign);
      for (int k = 0; k < n_; ++k) d[k] = Dot(J + k * N, w_.normal.data(), 0, N);
    }
  }

  // Whether what the working set leaves of a normal, of squared length `rest`, is round-off.
  bool Depends(int limit, double rest, double whole) {
    if (count_ == n_) return true;
    if (rest > 1e-10 * whole) return false;
    ReadNormal(limit, 1);
    double noise = whole;
    for (int k = 0; k < n_; ++k) {
      double sum = 0;
      for (int i = 0; i < n_; ++i) sum += std::abs(w_.J[k * N + i] * w_.normal[i]);
      noise += sum * sum;
    }
    return !(rest > kDependence * kDependence * noise);
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
    w_.norm[to] = w_.norm[from];
    w_.multiplier[to] = w_.multiplier[from];
  }

  // --- the start: the minimum on a working set, without J ---

  void Start(const QpLimits& proposed) {
    for (int i = 0; i < n_ + m_; ++i)
      if (Lower(i) == Upper(i)) Propose(i, 1, true);
    for (const QpLimit& l : proposed) {
      const bool is_row = l.kind == QpLimit::Kind::Row;
      if (l.index >= 0 && l.index < (is_row ? m_ : n_))
        Propose(is_row ? n_ + l.index : l.index, l.side == QpLimit::Side::Lower ? 1 : -1, false);
    }
    for (int unchanged = 0; unchanged >= 0; unchanged = LeaveNegative()) {
      FactorWorkingSet(unchanged);
      SolveMultipliers();
    }
    SolveX();
  }

  void Propose(int limit, double sign, bool equality) {
    const double bound = sign > 0 ? Lower(limit) : Upper(limit);
    if (count_ == N || w_.active[limit] || !std::isfinite(bound)) return;
    Place(count_, limit, sign, bound, equality);
    Whiten(limit, sign, w_.whitened.data() + count_ * N);
    ++count_;
  }

  // Reflectors and R from limit `first` on. What depends on the limits before it is left out.
  void FactorWorkingSet(int first) {
    const int proposed = count_;
    count_ = first;
    for (int k = first; k < proposed; ++k) {
      double* const whitened = w_.whitened.data() + k * N;
      double* const a = w_.R.data() + count_ * N;
      std::copy_n(whitened, N, a);
      for (int j = 0; j < count_; ++j) Reflect(j, a);
      const double whole = Dot(whitened, whitened, 0, N);
      double rest = 0;
      for (int i = count_; i < n_; ++i) rest += a[i] * a[i];
      if (Depends(w_.limit[k], rest, whole)) {
        w_.active[w_.limit[k]] = false;
        continue;
      }
      if (k != count_) {
        Move(k, count_);
        std::copy_n(whitened, N, w_.whitened.data() + count_ * N);
      }
      w_.norm[count_] = std::sqrt(whole);
      MakeReflector(a, rest);
      ++count_;
    }
  }

  // The reflector that maps a to [a_0 … a_{q−1}, diagonal, 0 …], q = count_; it is kept in `schur`.
  void MakeReflector(double* a, double rest) {
    const int q = count_;
    double* const v = w_.schur.data() + q * N;
    std::fill_n(v, q, 0.0);
    std::copy(a + q, a + N, v + q);
    double diagonal = a[q];
    w_.reflector_scale[q] = 0;
    if (q < n_ - 1) {
      const double length = std::sqrt(rest);
      w_.reflector_scale[q] = 1 / (rest + length * std::abs(diagonal));
      diagonal = diagonal > 0 ? -length : length;
      v[q] -= diagonal;
    }
    a[q] = diagonal;
    w_.inverse_diagonal[q] = 1 / diagonal;
  }

  void Reflect(int k, double* a) const {
    const double* const v = w_.schur.data() + k * N;
    const int from = DownTo8(k);
    AddScaled(a, -w_.reflector_scale[k] * Dot(v, a, from, N), v, from, N);
  }

  // With x = J p:  p_1 = R⁻ᵀ b, p_2 = −(Qᵀ c)_2, multipliers = R⁻¹ (p + Qᵀ c)_1.
  void SolveMultipliers() {
    double* const p = w_.y.data();
    double* const u = w_.multiplier.data();
    for (int i = 0; i < N; ++i) p[i] = -w_.c[i];
    for (int j = 0; j < count_; ++j) Reflect(j, p);
    for (int j = 0; j < count_; ++j) {
      const double* const column = w_.R.data() + j * N;
      double sum = w_.bound[j];
      for (int i = 0; i < j; ++i) sum -= column[i] * p[i];
      sum *= w_.inverse_diagonal[j];
      u[j] = sum - p[j];
      p[j] = sum;
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
        if (k != kept) {
          Move(k, kept);
          std::copy_n(w_.whitened.data() + k * N, N, w_.whitened.data() + kept * N);
        }
        ++kept;
      }
    }
    count_ = kept;
    return first;
  }

  void SolveX() {
    double* const p = w_.y.data();
    for (int k = count_ - 1; k >= 0; --k) Reflect(k, p);
    Combine(p, 0, w_.x.data());
    NoteLargest();
  }

  void NoteLargest() {
    for (int i = 0; i < n_; ++i) largest_x_ = std::max(largest_x_, std::abs(w_.x[i]));
  }

  // --- violations ---

  // value = [x; A x]
  void Evaluate() {
    const double* const A = qp_.A.data();
    const double* const x = w_.x.data();
    double* const value = w_.value.data() + n_;
    std::copy_n(x, n_, w_.value.data());
    const auto four_rows = [&](int row) {
      Pair s0{}, s1{};
      const double* column = A + row;
      for (int j = 0; j < n_; ++j, column += m_) {
        const Pair scale{x[j], x[j]};
        s0 += scale * Load(column);
        s1 += scale * Load(column + 2);
      }
      Store(value + row, s0);
      Store(value + row + 2, s1);
    };
    if (m_ >= 4) {
      for (int row = 0; row + 4 <= m_; row += 4) four_rows(row);
      if (m_ % 4 != 0) four_rows(m_ - 4);
    } else {
      for (int row = 0; row < m_; ++row) {
        value[row] = 0;
        for (int j = 0; j < n_; ++j) value[row] += A[j * m_ + row] * x[j];
      }
    }
  }

  // aᵀ H⁻¹ a: how far the limit can be moved at the cost of one unit.
  double SquaredReach(int limit) {
    double& reach = w_.reach[limit];
    if (reach == 0) {
      Whiten(limit, 1, w_.d.data());
      reach = Dot(w_.d.data(), w_.d.data(), 0, N) + std::numeric_limits<double>::min();
    }
    return reach;
  }

  // Solved: entering_ is the violated limit that costs most to satisfy alone, −1 if all hold.
  QpStatus Scan(QpSolution& solution) {
    Evaluate();
    entering_ = -1;
    double worst = 0;
    for (int i = 0; i < n_ + m_; ++i) {
      const double value = w_.value[i];
      const double lower = Lower(i), upper = Upper(i);
      if (lower <= value && value <= upper && std::abs(value) < kInfinity) continue;
      if (lower > upper) {
        solution.conflict.push_back(Named(i, 1));
        solution.conflict.push_back(Named(i, -1));
        return QpStatus::Infeasible;
      }
      const double sign = value < lower ? 1 : -1;
      const double bound = sign > 0 ? lower : upper;
      const double violation = sign * (bound - value);
      if (!(violation < kInfinity)) return QpStatus::InvalidData;
      if (w_.active[i]) continue;
      if (violation <= std::max(kFeasibility * Scale(i, bound), w_.slack[i])) continue;
      if (violation * violation > worst * SquaredReach(i)) {
        worst = violation * violation / SquaredReach(i);
        entering_ = i;
        sign_ = sign;
        violation_ = violation;
      }
    }
    return QpStatus::Solved;
  }

  bool IsUsable() const {
    const auto is_number = [](double v) { return !std::isnan(v); };
    return qp_.H.triangularView<Eigen::Lower>().toDenseMatrix().allFinite() && qp_.g.allFinite() &&
           qp_.A.allFinite() && std::ranges::all_of(qp_.x_lower, is_number);
  }

  // --- the dual method ---

  // J := J Q
  void FormJ() {
    for (int k = 0; k < count_; ++k) {
      const double* const v = w_.schur.data() + k * N;
      Combine(v, k, w_.z.data());
      for (int i = k; i < n_; ++i)
        AddScaled(w_.J.data() + i * N, -w_.reflector_scale[k] * v[i], w_.z.data(), 0, N);
    }
  }

  // out = Σ p_k J_k over k ≥ from
  void Combine(const double* p, int from, double* out) const {
    for (int b = 0; b < N; b += 8) {
      Pair s0{}, s1{}, s2{}, s3{};
      for (int k = from; k < n_; ++k) {
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
      r[j] *= w_.inverse_diagonal[j];
      for (int i = 0; i < j; ++i) r[i] -= column[i] * r[j];
    }
  }

  // Raises the multiplier of entering_ until its limit holds; limits whose multipliers reach zero on
  // the way leave. Solved: x is again the minimum on the working set.
  QpStatus Enter(QpSolution& solution) {
    const int p = entering_;
    const double bound = sign_ > 0 ? Lower(p) : Upper(p);
    double* const d = w_.d.data();
    double* const r = w_.r.data();
    double* const z = w_.z.data();
    double* const u = w_.multiplier.data();
    Whiten(p, sign_, d);
    const double whole = Dot(d, d, 0, N);
    double multiplier = 0;
    while (true) {
      if (iterations_ >= max_iterations_) return QpStatus::IterationLimit;
      ++iterations_;
      std::copy_n(d, count_, r);
      SolveR(r);
      double rest = 0;
      for (int i = count_; i < n_; ++i) rest += d[i] * d[i];
      const bool depends = Depends(p, rest, whole);

      const double negligible = 1e-12 * std::sqrt(whole);
      double step = kInfinity;
      int leaving = -1;
      for (int k = 0; k < count_; ++k) {
        if (w_.equality[k] || r[k] * w_.norm[k] <= negligible || u[k] >= step * r[k]) continue;
        step = u[k] / r[k];
        leaving = k;
      }
      bool full = false;
      if (depends) {
        double scale = Scale(p, bound);
        for (int k = 0; k < count_; ++k)
          scale += std::abs(r[k]) * Scale(w_.limit[k], w_.bound[k]);
        if (violation_ <= kFeasibility * scale) {
          w_.slack[p] = kFeasibility * scale;
          return QpStatus::Solved;
        }
        if (leaving < 0) {
          Prove(solution, negligible);
          return QpStatus::Infeasible;
        }
      } else if (violation_ <= step * rest) {
        full = true;
        step = violation_ / rest;
      }
      for (int k = 0; k < count_; ++k) u[k] -= step * r[k];
      multiplier += step;
      if (!depends) {
        Combine(d, count_, z);
        AddScaled(w_.x.data(), step, z, 0, N);
        violation_ -= step * rest;
        NoteLargest();
      }
      if (full) {
        Add(p, bound, multiplier, rest, whole);
        return QpStatus::Solved;
      }
      Drop(leaving);
    }
  }

  // Farkas: a_p = Σ r_k a_k, and every r_k ≤ 0 unless limit k is an equality.
  void Prove(QpSolution& solution, double negligible) const {
    solution.conflict.push_back(Named(entering_, sign_));
    SetMultiplier(solution, entering_, sign_);
    for (int k = 0; k < count_; ++k) {
      if (std::abs(w_.r[k]) * w_.norm[k] <= negligible) continue;
      const double value = -w_.r[k] * w_.sign[k];
      solution.conflict.push_back(Named(w_.limit[k], value));
      SetMultiplier(solution, w_.limit[k], value);
    }
  }

  // The entering limit joins the working set: one reflector on the free columns of J.
  void Add(int limit, double bound, double multiplier, double rest, double whole) {
    const int q = count_;
    double* const a = w_.R.data() + q * N;
    double* const z = w_.z.data();
    Place(q, limit, sign_, bound, Lower(limit) == Upper(limit));
    w_.multiplier[q] = multiplier;
    w_.norm[q] = std::sqrt(whole);
    std::copy_n(w_.d.data(), N, a);
    MakeReflector(a, rest);
    if (w_.reflector_scale[q] != 0) {
      const double* const v = w_.schur.data() + q * N;
      AddScaled(z, -a[q], w_.J.data() + q * N, 0, N);  // J v, for J d₂ is at hand
      for (int i = q; i < n_; ++i)
        AddScaled(w_.J.data() + i * N, -w_.reflector_scale[q] * v[i], z, 0, N);
    }
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
      const double length = std::hypot(column[k], column[k + 1]);
      const double c = column[k] / length, s = column[k + 1] / length;
      column[k] = length;
      w_.inverse_diagonal[k] = 1 / length;
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

  const QpProblem& qp_;
  QpWorkspace& w_;
  const int n_, m_;
  const int max_iterations_;
  int iterations_ = 0;
  int count_ = 0;
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
  return DualActiveSet<N>{problem, workspace, options}.Run(active, solution);
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
  return SolveUpTo<8>(problem, workspace, active, solution, options);
}

}  // namespace pliant
