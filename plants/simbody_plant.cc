#include "pliant/plants/simbody_plant.h"

namespace pliant {

namespace {

/// x, checked to have an element per joint; zero where it was left out.
template <class V>
V PerJointOr0(const V& x, const RobotModel& model, const std::string& name) {
  Require(x.size() == 0 || x.size() == model.size(),
          name + " has an element for each of the " + Text(model.size()) + " joints", x.size());
  Require(x.size() == 0 || x.allFinite(), name + " must be finite", x.transpose());
  return x.size() == model.size() ? x : V(PerJoint::Zero(model.size()));
}

PerJoint NotNegative(const PerJoint& x, const RobotModel& model, const std::string& name) {
  const PerJoint checked = PerJointOr0(x, model, name);
  Require(checked.minCoeff() >= 0, "every " + name + " must be >= 0", checked.minCoeff());
  return checked;
}

}  // namespace

SimbodyPlant::SimbodyPlant(const Options& o)
    : torque{this, "torque", o.model.joints()},
      contacts{this, "contacts"},
      position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      poses{this, "poses"},
      model_{o.model},
      simbody_{o.engine == Engine::Simbody ? std::make_shared<const SimbodyArm>(o.model) : nullptr},
      d_{NotNegative(o.damping, o.model, "damping")},
      B_{NotNegative(o.rotor_inertia, o.model, "rotor_inertia")},
      q_{this, "q", o.model.joints(), PerJointOr0(o.position, o.model, "position")},
      v_{this, "v", o.model.joints(), PerJointOr0(o.velocity, o.model, "velocity")},
      work_{this, "work", Workspace{.simbody = {}, .dynamics = RobotDynamics(o.model)}},
      pose_work_{this, "pose_work", Workspace{.simbody = {}, .dynamics = RobotDynamics(o.model)}} {
  Require(o.frames.size() <= kMaxFrames, "a plant shows at most " + Text(kMaxFrames) + " frames",
          o.frames.size());
  for (const std::string& frame : o.frames) frames_.push_back(o.model.link_index(frame));

  Derivative(q_).From(v_).As([](const JointVelocity& v) { return v; });
  Derivative(v_).From(acceleration).As([](const JointAcceleration& a) { return a; });
  Compute(position).From(q_).As([](const JointPosition& q) { return q; });
  Compute(velocity).From(v_).As([](const JointVelocity& v) { return v; });
  Compute(acceleration).From(work_, q_, v_, torque, contacts).As(&SimbodyPlant::Accelerate);
  Compute(poses).From(pose_work_, q_, v_).As(&SimbodyPlant::Place);
}

JointAcceleration SimbodyPlant::Accelerate(Workspace& w, const JointPosition& q,
                                           const JointVelocity& v, const JointTorque& tau,
                                           const Joined<ContactForce>& joined) const {
  w.forces.clear();
  for (int i = 0; i < joined.size(); ++i) w.forces.push_back(joined[i]);
  const JointTorque net = tau - d_.cwiseProduct(v);
  if (simbody_) return simbody_->ForwardDynamics(q, v, net, w.forces, B_, w.simbody);
  ComputeDynamics(model_, q, v, w.dynamics);
  return pliant::ForwardDynamics(w.dynamics, net, ExternalTorque(model_, w.dynamics, w.forces), B_);
}

void SimbodyPlant::Place(FramePoses& X, Workspace& w, const JointPosition& q,
                         const JointVelocity& v) const {
  X.size = static_cast<int>(frames_.size());
  if (X.size == 0) return;
  ComputeDynamics(model_, q, v, w.dynamics);
  for (std::size_t i = 0; i < frames_.size(); ++i)
    X.pose[i] = LinkPose(model_, w.dynamics, frames_[i]);
}

}  // namespace pliant
