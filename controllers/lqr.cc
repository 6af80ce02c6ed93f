#include "pliant/controllers/lqr.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pliant {

using Eigen::MatrixXd;

Lqr ContinuousLqr(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost,
                  const std::vector<std::string>& names) {
  const MatrixXd S = SolveRiccati(A, B, cost, names);
  const MatrixXd K = cost.R.llt().solve(B.transpose() * S);
  return {K, S, (A - B * K).eigenvalues()};
}

Lqr DiscreteLqr(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost,
                const std::vector<std::string>& names) {
  const MatrixXd S = SolveDiscreteRiccati(A, B, cost, names);
  const MatrixXd M = cost.R + B.transpose() * S * B;
  const MatrixXd K = M.llt().solve(B.transpose() * S * A);
  return {K, S, (A - B * K).eigenvalues()};
}

}  // namespace pliant
