#include "pliant/controllers/frame_force.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace pliant {

Vector6 FrameForce(const RobotDynamics& d, const FrameDynamics& frame,
                   const JointAcceleration& qdd_e, double inertia_limit) {
  const Eigen::LLT<JointMatrix> M(d.M);
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxJoints, 6> root =
      frame.J.transpose();
  M.matrixL().solveInPlace(root);  // J M⁻¹ Jᵀ = rootᵀ root
  const Eigen::Matrix<double, 6, 6> K = root.transpose().lazyProduct(root);
  const Vector6 pushed = frame.J.lazyProduct(qdd_e);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(K);
  const double k0 = 2 / inertia_limit;
  const auto inverse = [k0](double k) {
    return k >= k0 ? 1 / k : (2 * k0 - std::max(k, 0.0)) / (k0 * k0);
  };
  const Vector6 in_axes = eigen.eigenvectors().transpose() * pushed;
  const Vector6 inverses = eigen.eigenvalues().unaryExpr(inverse);
  return eigen.eigenvectors() * inverses.cwiseProduct(in_axes);
}

}  // namespace pliant
