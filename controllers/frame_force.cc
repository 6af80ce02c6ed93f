#include "pliant/controllers/frame_force.h"

#include <Eigen/Cholesky>

#include "pliant/controllers/bounded_inertia.h"

namespace pliant {

Vector6 FrameForce(const RobotDynamics& d, const FrameDynamics& frame,
                   const JointAcceleration& qdd_e, double inertia_limit) {
  const Eigen::LLT<JointMatrix> M(d.M);
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxJoints, 6> root =
      frame.J.transpose();
  M.matrixL().solveInPlace(root);  // J M⁻¹ Jᵀ = rootᵀ root
  const Eigen::Matrix<double, 6, 6> K = root.transpose().lazyProduct(root);
  const Vector6 pushed = frame.J.lazyProduct(qdd_e);
  return internal::BoundedInertia(K, pushed, 2 / inertia_limit);
}

}  // namespace pliant
