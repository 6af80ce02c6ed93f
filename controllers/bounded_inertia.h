#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace pliant::internal {

/// Λ x for Λ = K⁻¹, K symmetric, ⪰ 0, with 1/k replaced by (2 k₀ − k)/k₀² for each eigenvalue
/// k < k₀: exact away from singularities, never larger than 2/k₀, smooth at k₀.
inline Eigen::Matrix<double, 6, 1> BoundedInertia(const Eigen::Matrix<double, 6, 6>& K,
                                                  const Eigen::Matrix<double, 6, 1>& x, double k0) {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;
  // K − k₀ 1 has a factorization if no eigenvalue is below k₀; then Λ is exact.
  const Matrix margin = K - k0 * Matrix::Identity();
  if (margin.llt().info() == Eigen::Success) return K.llt().solve(x);
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(K);
  const auto inverse = [k0](double k) {
    return k >= k0 ? 1 / k : (2 * k0 - std::max(k, 0.0)) / (k0 * k0);
  };
  const Vector in_axes = eigen.eigenvectors().transpose() * x;
  const Vector inverses = eigen.eigenvalues().unaryExpr(inverse);
  return eigen.eigenvectors() * inverses.cwiseProduct(in_axes);
}

}  // namespace pliant::internal
