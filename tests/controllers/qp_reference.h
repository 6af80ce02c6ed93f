#pragma once

#include <Eigen/LU>

#include "pliant/controllers/qp_certificate.h"

namespace pliant {

/// The solution of the equality-constrained problem on `active` and all equalities, in long double.
/// Where Kkt() of a solver's answer is round-off, this is the exact solution but for 1e-19 cond.
inline Eigen::Vector<long double, Eigen::Dynamic> ReferenceSolution(const QpProblem& qp,
                                                                    const QpLimits& active) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Vector<long double, Eigen::Dynamic>;
  const int n = qp.variables(), k = active.size();
  Matrix K = Matrix::Zero(n + k, n + k);
  Vector right = Vector::Zero(n + k);
  const Matrix lower_triangle = qp.H.cast<long double>();
  K.topLeftCorner(n, n) = lower_triangle.selfadjointView<Eigen::Lower>();
  right.head(n) = -qp.g.cast<long double>();
  for (int i = 0; i < k; ++i) {
    const QpLimit& l = active[i];
    const bool is_lower = l.side == QpLimit::Side::Lower;
    if (l.kind == QpLimit::Kind::Bound) {
      K(n + i, l.index) = 1;
      right(n + i) = is_lower ? qp.x_lower(l.index) : qp.x_upper(l.index);
    } else {
      K.row(n + i).head(n) = qp.A.row(l.index).cast<long double>();
      right(n + i) = is_lower ? qp.lower(l.index) : qp.upper(l.index);
    }
    K.col(n + i).head(n) = K.row(n + i).head(n).transpose();
  }
  const Eigen::PartialPivLU<Matrix> factors{K};
  Vector solution = factors.solve(right);
  solution += factors.solve(right - K * solution);
  return solution.head(n);
}

/// ‖x − reference‖_∞ / ‖reference‖_∞
inline double RelativeError(const QpProblem& qp, const QpLimits& active,
                            const QpSolution& solution) {
  const Eigen::Vector<long double, Eigen::Dynamic> reference = ReferenceSolution(qp, active);
  const long double error = (solution.x.cast<long double>() - reference).cwiseAbs().maxCoeff();
  return static_cast<double>(error / std::max(reference.cwiseAbs().maxCoeff(), 1e-30L));
}

}  // namespace pliant
