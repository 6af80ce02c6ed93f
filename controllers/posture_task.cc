#include "pliant/controllers/posture_task.h"

#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

PerJoint Checked(std::string_view name, const PerJoint& x, std::string_view unit,
                 const Joints& joints) {
  RequireEachInRange(name, x, unit, kNotNegative, joints);
  return x;
}

}  // namespace

PostureTask::PostureTask(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      external_acceleration{this, "external_acceleration", o.model.joints(),
                            JointAcceleration::Zero(o.model.joints())},
      target{this, "target", o.model.joints(), o.target},
      target_velocity{this, "target_velocity", o.model.joints(),
                      JointVelocity::Zero(o.model.joints())},
      target_acceleration{this, "target_acceleration", o.model.joints(),
                          JointAcceleration::Zero(o.model.joints())},
      stiffness{this, "stiffness", {}, Checked("stiffness", o.stiffness, "1/s²", o.model.joints())},
      damping{this, "damping", {}, Checked("damping", o.damping, "1/s", o.model.joints())},
      weight{this, "weight", {}, o.weight},
      compliance{this, "compliance", {}, ComplianceOf<JointMatrix>(o.compliance, o.model.size())},
      error{this, "error", o.model.joints()},
      objective{this, "objective", o.model.joints(),
                Objective::Zero(o.model.size(), o.model.size())},
      model_{o.model} {
  RequireEachInRange("target", o.target, "rad", kAnyNumber, o.model.joints());
  Require(o.weight > 0 && std::isfinite(o.weight), "weight must be finite and > 0", o.weight);
  Compute(error).From(dynamics, target).As(&PostureTask::Error);
  Compute(objective)
      .From(dynamics, external_acceleration, error, target_velocity, target_acceleration, stiffness,
            damping, weight, compliance)
      .As(&PostureTask::Want);
}

JointPosition PostureTask::Error(const RobotDynamics& d, const JointPosition& target) const {
  JointPosition e = d.q - target;
  for (int i = 0; i < model_.size(); ++i)
    if (model_.joint(i).type == Joint::Type::Continuous)
      e(i) = std::remainder(e(i), 2 * std::numbers::pi);
  return e;
}

void PostureTask::Want(Objective& out, const RobotDynamics& d, const JointAcceleration& qdd_e,
                       const JointPosition& e, const JointVelocity& v0, const JointAcceleration& a0,
                       const PerJoint& k, const PerJoint& c, double w,
                       const JointMatrix& gamma) const {
  out.A.setIdentity();
  out.b = a0 - c.cwiseProduct(d.v - v0) - k.cwiseProduct(e);
  out.b.noalias() += gamma.lazyProduct(qdd_e);
  out.weight = w;
}

}  // namespace pliant
