#include "pliant/controllers/contact_inertia.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "pliant/controllers/compliance.h"
#include "pliant/systems/parameter.h"

namespace pliant {

ContactInertia::ContactInertia(const TaskMatrix& given) {
  if (given.size() == 0) return;
  const Eigen::Matrix3d M_d = ComplianceOf<TaskMatrix>(given, 3, "inertia", "M_d");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(M_d);
  RequireInRange("", "the smallest eigenvalue of inertia", eigen.eigenvalues()(0), "kg", kPositive);
  inverse_ = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
             eigen.eigenvectors().transpose();
}

Eigen::Vector3d ContactInertia::Accelerate(const RobotDynamics& d, const FrameDynamics& point,
                                           const Eigen::Vector3d& f) const {
  if (inverse_) return *inverse_ * f;
  PerJoint torque = point.J.bottomRows<3>().transpose().lazyProduct(f);
  const Eigen::LLT<JointMatrix> M(d.M);
  if (M.info() != Eigen::Success)
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  M.solveInPlace(torque);
  return point.J.bottomRows<3>().lazyProduct(torque);
}

}  // namespace pliant
