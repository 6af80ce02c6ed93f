#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace pliant {

inline constexpr int kMaxQpVariables = 64;
inline constexpr int kMaxQpRows = 128;

/// A strictly convex quadratic program:
///
///   minimise ½ xᵀ H x + gᵀ x   subject to   x_lower ≤ x ≤ x_upper,   lower ≤ A x ≤ upper
///
/// ±infinity is no limit; lower = upper is an equality. Its sizes are those of the constructor, its
/// numbers are written in place.
struct QpProblem {
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxQpVariables, 1>;
  using RowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxQpRows, 1>;
  using Hessian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                kMaxQpVariables, kMaxQpVariables>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxQpRows,
                             kMaxQpVariables>;

  /// H = I, everything else zero, no limits.
  QpProblem(int variables, int rows);

  int variables() const { return static_cast<int>(H.rows()); }
  int rows() const { return static_cast<int>(A.rows()); }

  Hessian H;  ///< symmetric; the solver reads the lower triangle
  Vector g, x_lower, x_upper;
  Rows A;
  RowVector lower, upper;
};

/// One side of one limit: x_i ≥ x_lower_i, or a_i x ≤ upper_i, …
struct QpLimit {
  enum class Kind : std::uint8_t { Bound, Row };
  enum class Side : std::uint8_t { Lower, Upper };

  Kind kind = Kind::Bound;
  Side side = Side::Lower;
  std::int16_t index = 0;

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("kind", kind, "");
    f("side", side, "");
    f("index", index, "");
  }
  bool operator==(const QpLimit&) const = default;
};

/// Limits in a row: those a solution touches, or those that contradict each other.
class QpLimits {
 public:
  using value_type = QpLimit;
  using const_iterator = const QpLimit*;

  QpLimits() = default;
  QpLimits(std::initializer_list<QpLimit> limits);

  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const_iterator begin() const { return limits_.data(); }
  const_iterator end() const { return limits_.data() + size_; }
  const QpLimit& operator[](int i) const { return limits_[static_cast<std::size_t>(i)]; }

  void clear();
  /// Does nothing once kMaxQpVariables + 1 limits are in: no vertex and no conflict needs more.
  void push_back(const QpLimit& limit);

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("limits", limits_, "");
    f("size", size_, "");
  }
  bool operator==(const QpLimits&) const = default;

 private:
  std::array<QpLimit, kMaxQpVariables + 1> limits_{};  // zero from size_ on, so that == compares
  std::int32_t size_ = 0;
};

enum class QpStatus : std::uint8_t {
  Solved,
  Infeasible,      ///< `conflict` names limits that no x satisfies together
  NotConvex,       ///< H is not positive definite, or no more than its round-off
  IterationLimit,  ///< x is optimal for `active` but violates other limits
  InvalidData,     ///< NaN, an infinite number that is not a missing limit, or changed sizes
};

/// Where the solver ended. The multipliers λ (rows) and μ (bounds) satisfy
///
///   H x + g = Aᵀ λ + μ,   λ_i ≥ 0 at a lower limit, ≤ 0 at an upper one, 0 elsewhere
///
/// If the problem is infeasible they are Farkas' proof of it: Aᵀ λ + μ = 0, while the limits ask
/// for (Aᵀ λ + μ)ᵀ x > 0. Where a single limit has lower > upper, its two sides are the conflict
/// and the multipliers are zero. Without a solution x is the last iterate, or zero if there was
/// none.
struct QpSolution {
  QpStatus status = QpStatus::InvalidData;
  int iterations = 0;  ///< limits that entered or left after the start
  QpProblem::Vector x;
  QpProblem::Vector bound_multipliers;
  QpProblem::RowVector row_multipliers;
  QpLimits conflict;
};

struct QpOptions {
  int max_iterations = 1000;
};

/// Memory of the solver, about 180 kB. No result depends on what it held before.
struct QpWorkspace {
  alignas(64) std::array<std::byte, 180'000> memory{};
};

/// Solves by the dual active-set method: from the minimum subject to the limits in `active` (those
/// of an earlier, similar problem, or none), one violated limit enters at a time, and limits whose
/// multipliers would change sign leave. `active` is overwritten by the limits at the end. No heap,
/// no exceptions; equal arguments give equal bits.
///
/// Source: Goldfarb & Idnani, A numerically stable dual method for solving strictly convex
/// quadratic programs, Mathematical Programming 27 (1983), with L D Lᵀ and Householder factors.
QpStatus Solve(const QpProblem& problem, QpWorkspace& workspace, QpLimits& active,
               QpSolution& solution, const QpOptions& options = {});

}  // namespace pliant
