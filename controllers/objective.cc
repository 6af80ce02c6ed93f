#include "pliant/controllers/objective.h"

#include <Eigen/Eigenvalues>

#include "pliant/systems/error.h"

namespace pliant {

void RequireCompliance(const Eigen::Ref<const Eigen::MatrixXd>& gamma, Eigen::Index size) {
  Require(gamma.rows() == size && gamma.cols() == size,
          "compliance must be " + Text(size) + " x " + Text(size),
          Text(gamma.rows()) + " x " + Text(gamma.cols()));
  Require(gamma.allFinite(), "compliance must be finite");
  const double scale = std::max(1.0, gamma.cwiseAbs().maxCoeff());
  // Symmetric and PSD up to the round-off of an eigenvalue.
  const double tolerance = 1e-12 * scale * static_cast<double>(size);
  const double skew = (gamma - gamma.transpose()).cwiseAbs().maxCoeff();
  Require(skew <= tolerance, "compliance must be symmetric: |Γ − Γᵀ| must be 0", skew);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gamma, Eigen::EigenvaluesOnly);
  Require(eigen.eigenvalues().minCoeff() >= -tolerance,
          "compliance must be positive semi-definite: every eigenvalue must be >= 0",
          eigen.eigenvalues().minCoeff());
}

}  // namespace pliant
