#include "pliant/controllers/tool_impedance.h"

#include "pliant/controllers/rotation.h"
#include "pliant/systems/elements.h"

namespace pliant {

using Eigen::Vector3d;

ToolImpedance::ToolImpedance(const Joints& joints, const OrientationGains& orientation)
    : torque{this, "torque", joints}, orientation_{orientation} {
  RequireEachInRange("orientation.stiffness", orientation.stiffness, "N·m/rad", kNotNegative);
  RequireEachInRange("orientation.damping", orientation.damping, "N·m·s/rad", kNotNegative);
  Compute(orientation_error).From(frame, target).As([](const FrameDynamics& now, const Pose& X) {
    return OrientationError(internal::Log(X.rotation * now.pose.rotation.transpose()));
  });
  Compute(torque).From(frame, wrench).As([](const FrameDynamics& now, const ToolWrench& F) {
    return JointTorque(now.J.transpose().lazyProduct(F));
  });
}

ToolWrench ToolImpedance::Pull(const FrameDynamics& now, const OrientationError& e_r,
                               const Twist& target_twist, const Vector3d& F_v) const {
  const Vector3d turning = now.twist.head<3>() - target_twist.head<3>();
  ToolWrench F;
  F << orientation_.stiffness.cwiseProduct(e_r) - orientation_.damping.cwiseProduct(turning), F_v;
  return F;
}

VelocityImpedance::VelocityImpedance(const Options& o)
    : ToolImpedance(o.joints, o.orientation), D_{o.damping} {
  RequireEachInRange("damping", o.damping, "N·s/m", kNotNegative);
  Compute(wrench).From(frame, orientation_error, target_twist, command).As(&VelocityImpedance::Act);
}

ToolWrench VelocityImpedance::Act(const FrameDynamics& now, const OrientationError& e_r,
                                  const Twist& target_twist, const LinearVelocity& command) const {
  return Pull(now, e_r, target_twist, D_.cwiseProduct(command));
}

ClassicalImpedance::ClassicalImpedance(const Options& o)
    : ToolImpedance(o.joints, o.orientation), K_{o.stiffness}, D_{o.damping} {
  RequireEachInRange("stiffness", o.stiffness, "N/m", kNotNegative);
  RequireEachInRange("damping", o.damping, "N·s/m", kNotNegative);
  Compute(wrench).From(frame, orientation_error, target, target_twist).As(&ClassicalImpedance::Act);
}

ToolWrench ClassicalImpedance::Act(const FrameDynamics& now, const OrientationError& e_r,
                                   const Pose& target, const Twist& target_twist) const {
  const Vector3d e = target.position - now.pose.position;
  const Vector3d e_rate = (target_twist - now.twist).tail<3>();
  return Pull(now, e_r, target_twist, K_.cwiseProduct(e) + D_.cwiseProduct(e_rate));
}

}  // namespace pliant
