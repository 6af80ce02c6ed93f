#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pliant {

/// Which combinations of parameters x the rows A x ≈ b tell apart.
///
/// Column by column from the first: one that depends on those kept before it is dropped,
/// a_d = Σ β_kd a_k, and each kept parameter becomes a base parameter,
///
///   y_k = x_k + Σ_d β_kd x_d,   A x = A_kept y
///
/// Order the columns of an arm from its base to its tip, and the combinations are those of the
/// textbooks: a link's with parts of the links it carries.
///
/// Source: Gautier & Khalil, IEEE Trans. Robotics and Automation 6(3), 1990; numerically: Gautier,
/// J. Robotic Systems 8(4), 1991.
struct BaseParameters {
  std::vector<Eigen::Index> kept;     ///< columns of the base parameters
  std::vector<Eigen::Index> dropped;  ///< columns that depend on them
  std::vector<Eigen::Index> without;  ///< columns of zeros: x has no effect
  Eigen::MatrixXd beta;               ///< kept × dropped
  /// Of A_kept with its columns scaled to length 1: the greatest singular value over the least.
  double condition = 0;

  /// Parameters that stand alone: in no combination, so A tells each of them by itself.
  std::vector<Eigen::Index> alone() const;
  /// y of x.
  Eigen::VectorXd Of(const Eigen::VectorXd& x) const;
  /// "link_7.m + 0.5 link_6.mc_x", a term whose factor is below 1e-6 left out.
  std::string text(std::size_t base, const std::vector<std::string>& names) const;
};

/// Of any A, or the triangle of its rows. A column depends on others if what is left of it is below
/// `tolerance` of its length; it is zero below `tolerance` of the longest column's.
BaseParameters FindBaseParameters(const Eigen::MatrixXd& A, double tolerance = 1e-8);

}  // namespace pliant
