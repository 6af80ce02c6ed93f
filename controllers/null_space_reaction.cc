#include "pliant/controllers/null_space_reaction.h"

#include <Eigen/Cholesky>

#include "pliant/controllers/bounded_inertia.h"
#include "pliant/controllers/null_space.h"
#include "pliant/systems/elements.h"

namespace pliant {

NullSpaceReaction::NullSpaceReaction(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      external_torque{this, "external_torque", o.joints},
      torque{this, "torque", o.joints},
      o_{o} {
  RequireInRange("", "null_space_gain", o.null_space_gain, "", kNotNegative);
  RequireInRange("", "tool_gain", o.tool_gain, "", kNotNegative);
  RequireInRange("", "stiffness", o.stiffness, "N·m/rad", kNotNegative);
  if (o.stiffness > 0) RequireEachInRange("posture", o.posture, "rad", kAnyNumber, o.joints);
  RequireInRange("", "damping", o.damping, "N·m·s/rad", kNotNegative);
  RequireInRange("", "inertia_limit", o.inertia_limit, "kg", kPositive);
  Compute(torque).From(dynamics, frame, external_torque).As(&NullSpaceReaction::Act);
}

JointTorque NullSpaceReaction::Act(const RobotDynamics& d, const FrameDynamics& now,
                                   const JointTorque& tau_e) const {
  const Eigen::LLT<JointMatrix> M(d.M);
  JacobianInverse root = now.J.transpose();
  M.matrixL().solveInPlace(root);  // J M⁻¹ Jᵀ = rootᵀ root
  const Eigen::Matrix<double, 6, 6> K = root.transpose().lazyProduct(root);
  const auto tool_part = [&](const PerJoint& tau) {  // (I − P) τ = Jᵀ Λ J M⁻¹ τ
    PerJoint half = tau;
    M.matrixL().solveInPlace(half);
    const Vector6 pushed = root.transpose().lazyProduct(half);
    const Vector6 F = internal::BoundedInertia(K, pushed, 2 / o_.inertia_limit);
    return PerJoint(now.J.transpose().lazyProduct(F));
  };
  // q̇_n = q̇ − M⁻¹ Jᵀ Λ J q̇
  const Vector6 V = now.J.lazyProduct(d.v);
  const Vector6 momentum = internal::BoundedInertia(K, V, 2 / o_.inertia_limit);
  PerJoint carried = now.J.transpose().lazyProduct(momentum);
  M.solveInPlace(carried);
  const PerJoint v_n = d.v - carried;

  const PerJoint pushed_tool = tool_part(tau_e);
  PerJoint inside = o_.null_space_gain * tau_e - o_.damping * v_n;
  if (o_.stiffness > 0) inside += o_.stiffness * (o_.posture - d.q);
  return inside - tool_part(inside) - o_.tool_gain * pushed_tool;
}

}  // namespace pliant
