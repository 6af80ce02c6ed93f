#include "pliant/controllers/posture_task.h"

#include <cmath>
#include <numbers>

namespace pliant {

namespace {

PerJoint Checked(const PerJoint& x, const RobotModel& model, const std::string& name) {
  Require(x.size() == model.size(),
          name + " has an element for each of the " + Text(model.size()) + " joints", x.size());
  Require(x.allFinite() && x.minCoeff() >= 0, "every " + name + " must be finite and >= 0",
          x.transpose());
  return x;
}

JointMatrix CheckedCompliance(const JointMatrix& gamma, int n) {
  if (gamma.size() == 0) return JointMatrix::Zero(n, n);
  RequireCompliance(gamma, n);
  return gamma;
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
      stiffness{this, "stiffness", {}, Checked(o.stiffness, o.model, "stiffness")},
      damping{this, "damping", {}, Checked(o.damping, o.model, "damping")},
      weight{this, "weight", {}, o.weight},
      compliance{this, "compliance", {}, CheckedCompliance(o.compliance, o.model.size())},
      error{this, "error", o.model.joints()},
      objective{this, "objective", o.model.joints(),
                Objective::Zero(o.model.size(), o.model.size())},
      model_{o.model} {
  Require(o.target.size() == o.model.size(),
          "target has an element for each of the " + Text(o.model.size()) + " joints",
          o.target.size());
  Require(o.target.allFinite(), "target must be finite", o.target.transpose());
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
