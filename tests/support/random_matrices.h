#pragma once

#include <Eigen/Core>
#include <random>

namespace pliant {

/// Matrices of independent standard normal numbers, the same for the same seed.
class RandomMatrices {
 public:
  explicit RandomMatrices(unsigned seed) : random_{seed} {}

  Eigen::MatrixXd Normal(Eigen::Index rows, Eigen::Index cols) {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal_(random_); });
  }
  /// Symmetric and > 0.
  Eigen::MatrixXd Positive(Eigen::Index n) {
    const Eigen::MatrixXd M = Normal(n, n);
    return M * M.transpose() / static_cast<double>(n) + 0.1 * Eigen::MatrixXd::Identity(n, n);
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace pliant
