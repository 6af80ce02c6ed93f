#pragma once

#include <Eigen/Core>

namespace pliant {

/// What a least-squares problem of any number of rows, A x ≈ b, comes down to: the triangle T with
///
///   Tᵀ T = [A b]ᵀ [A b],   so ‖A x − b‖ = ‖T (x; −1)‖ for every x
///
/// Found by Householder reflections as rows come, in memory of some (p + 1)², and so without the
/// squared condition of normal equations.
///
/// Source: Lawson & Hanson, Solving Least Squares Problems, 1974, ch. 27.
class RowTriangle {
 public:
  explicit RowTriangle(Eigen::Index columns);  ///< p

  void Add(const Eigen::Ref<const Eigen::RowVectorXd>& a, double b);

  /// T, (p + 1) × (p + 1).
  const Eigen::MatrixXd& triangle();
  Eigen::Index count() const { return count_; }  ///< rows so far

  /// √(‖A x − b‖²/count).
  double rms(const Eigen::VectorXd& x);

 private:
  void Fold();

  Eigen::MatrixXd triangle_;
  Eigen::MatrixXd block_;  // T above rows that are not yet in it
  Eigen::Index waiting_ = 0, count_ = 0;
};

}  // namespace pliant
