#include "pliant/controllers/compliance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                             Objective::kMaxRows, Objective::kMaxRows>;

/// Symmetric and PSD up to the round-off of an eigenvalue.
double Tolerance(const Eigen::Ref<const Eigen::MatrixXd>& gamma) {
  return 1e-12 * std::max(1.0, gamma.cwiseAbs().maxCoeff()) * static_cast<double>(gamma.rows());
}

double Skewness(const Eigen::Ref<const Eigen::MatrixXd>& gamma) {
  return (gamma - gamma.transpose()).cwiseAbs().maxCoeff();
}

}  // namespace

bool IsCompliance(const Eigen::Ref<const Eigen::MatrixXd>& gamma, Eigen::Index size) {
  if (gamma.rows() != size || gamma.cols() != size || !gamma.allFinite()) return false;
  const double tolerance = Tolerance(gamma);
  if (!(Skewness(gamma) <= tolerance)) return false;
  Square shifted = gamma;
  shifted.diagonal().array() += tolerance;
  const Eigen::LLT<Eigen::Ref<Square>> factor(shifted);
  return factor.info() == Eigen::Success;
}

void RequireCompliance(const Eigen::Ref<const Eigen::MatrixXd>& gamma, Eigen::Index size,
                       std::string_view name, std::string_view symbol) {
  const std::string what(name), s(symbol);
  Require(gamma.rows() == size && gamma.cols() == size,
          what + " must be " + Text(size) + " x " + Text(size),
          Text(gamma.rows()) + " x " + Text(gamma.cols()));
  Require(gamma.allFinite(), what + " must be finite");
  const double skew = Skewness(gamma);
  Require(skew <= Tolerance(gamma), what + " must be symmetric: |" + s + " − " + s + "ᵀ| must be 0",
          skew);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gamma, Eigen::EigenvaluesOnly);
  Require(eigen.eigenvalues().minCoeff() >= -Tolerance(gamma),
          what + " must be positive semi-definite: every eigenvalue must be >= 0",
          eigen.eigenvalues().minCoeff());
}

TaskMatrix InAxes(const Eigen::Matrix3d& R, const TaskMatrix& gamma) {
  const Eigen::Index n = gamma.rows();
  Require(gamma.cols() == n && (n == 3 || n == 6),
          "a compliance is turned into other axes if it is 3 x 3 or 6 x 6",
          Text(n) + " x " + Text(gamma.cols()));
  TaskMatrix turned(n, n);
  for (Eigen::Index i = 0; i < n; i += 3)
    for (Eigen::Index j = 0; j < n; j += 3)
      turned.block<3, 3>(i, j) = R * gamma.block<3, 3>(i, j) * R.transpose();
  return turned;
}

}  // namespace pliant
