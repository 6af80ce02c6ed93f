#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/controllers/qp_solver.h"

namespace pliant {

/// How far x and its multipliers are from the optimality conditions of Karush, Kuhn and Tucker,
/// each relative to the numbers it is computed from, where x counts as no less than max |g_i| /
/// H_ii. For a strictly convex problem these are sufficient: all three zero proves that x is the
/// solution, however it was found.
struct KktResidual {
  double stationarity = 0;  ///< H x + g − Aᵀ λ − μ
  double primal = 0;        ///< largest violation of a limit
  double complementarity =
      0;  ///< distance from the limit that a multiplier, by its sign, pushes from

  double max() const { return std::max({stationarity, primal, complementarity}); }
};

/// A vector (λ, μ) with Aᵀ λ + μ = 0 whose limits ask for (Aᵀ λ + μ)ᵀ x ≥ gap > 0 proves that no x
/// satisfies them (Farkas). With a residual r it proves it for all ‖x‖_1 < gap / r.
struct FarkasCertificate {
  double residual = 0;  ///< ‖Aᵀ λ + μ‖_∞
  double gap = 0;       ///< Σ over limits, λ_i lower_i or λ_i upper_i by the sign of λ_i

  /// Whether it rules out every x no larger than `largest` in any component.
  bool Excludes(double largest, int variables) const {
    return gap > residual * largest * variables;
  }
};

/// In long double.
inline KktResidual Kkt(const QpProblem& qp, const QpSolution& solution) {
  using Real = long double;
  using Vector = Eigen::Vector<Real, Eigen::Dynamic>;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix lower_triangle = qp.H.cast<Real>();
  const Matrix H = lower_triangle.selfadjointView<Eigen::Lower>();
  const Matrix A = qp.A.cast<Real>();
  const Vector g = qp.g.cast<Real>(), x = solution.x.cast<Real>();
  const Vector lambda = solution.row_multipliers.cast<Real>();
  const Vector mu = solution.bound_multipliers.cast<Real>();

  const Real largest =
      std::max(x.cwiseAbs().maxCoeff(), (g.array() / H.diagonal().array()).abs().maxCoeff());
  const Vector scale = H.cwiseAbs() * x.cwiseAbs() + g.cwiseAbs() +
                       A.cwiseAbs().transpose() * lambda.cwiseAbs() + mu.cwiseAbs();
  const Vector gradient = H * x + g - A.transpose() * lambda - mu;

  KktResidual residual;
  const Real unit = std::max(scale.maxCoeff(), std::numeric_limits<Real>::min());
  residual.stationarity = static_cast<double>(gradient.cwiseAbs().maxCoeff() / unit);

  const auto check = [&](Real value, Real reach, Real lower, Real upper, Real multiplier) {
    const auto relative = [&](Real distance, Real bound) {
      const Real from = reach * largest + std::abs(bound);
      return from > 0 ? static_cast<double>(distance / from) : 0.0;
    };
    if (value < lower) residual.primal = std::max(residual.primal, relative(lower - value, lower));
    if (value > upper) residual.primal = std::max(residual.primal, relative(value - upper, upper));
    if (multiplier == 0) return;
    const Real bound = multiplier > 0 ? lower : upper;
    residual.complementarity =
        std::max(residual.complementarity,
                 std::isfinite(bound) ? relative(std::abs(value - bound), bound) : HUGE_VAL);
  };
  const Vector values = A * x;
  for (int i = 0; i < qp.variables(); ++i) check(x(i), 1, qp.x_lower(i), qp.x_upper(i), mu(i));
  for (int i = 0; i < qp.rows(); ++i)
    check(values(i), A.row(i).cwiseAbs().sum(), qp.lower(i), qp.upper(i), lambda(i));
  return residual;
}

/// In long double. Two sides of one limit with lower > upper are a proof without multipliers.
inline FarkasCertificate Farkas(const QpProblem& qp, const QpSolution& solution) {
  const QpLimits& conflict = solution.conflict;
  if (conflict.size() == 2 && conflict[0].kind == conflict[1].kind &&
      conflict[0].index == conflict[1].index) {
    const bool is_row = conflict[0].kind == QpLimit::Kind::Row;
    const int i = conflict[0].index;
    return {.residual = 0,
            .gap = is_row ? qp.lower(i) - qp.upper(i) : qp.x_lower(i) - qp.x_upper(i)};
  }
  using Real = long double;
  Eigen::Vector<Real, Eigen::Dynamic> sum =
      qp.A.transpose().cast<Real>() * solution.row_multipliers.cast<Real>();
  sum += solution.bound_multipliers.cast<Real>();
  Real gap = 0;
  const auto add = [&](double multiplier, double lower, double upper) {
    if (multiplier != 0) gap += Real{multiplier} * (multiplier > 0 ? lower : upper);
  };
  for (int i = 0; i < qp.variables(); ++i)
    add(solution.bound_multipliers(i), qp.x_lower(i), qp.x_upper(i));
  for (int i = 0; i < qp.rows(); ++i) add(solution.row_multipliers(i), qp.lower(i), qp.upper(i));
  return {.residual = static_cast<double>(sum.cwiseAbs().maxCoeff()),
          .gap = static_cast<double>(gap)};
}

}  // namespace pliant
