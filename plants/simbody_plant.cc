#include "pliant/plants/simbody_plant.h"

#include "pliant/systems/elements.h"

namespace pliant {

SimbodyPlant::SimbodyPlant(const Options& o)
    : torque{this, "torque", o.model.joints()},
      loads{this, "loads", o.model.joints()},
      contacts{this, "contacts"},
      position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      motion{this, "motion", o.model.joints(), RobotDynamics(o.model, o.frames)},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      model_{o.model},
      simbody_{o.engine == Engine::Simbody ? std::make_shared<const SimbodyArm>(o.model) : nullptr},
      d_{EachInRangeOr0("damping", o.damping, "N·m·s/rad", kNotNegative, o.model.joints())},
      B_{EachInRangeOr0("rotor_inertia", o.rotor_inertia, "kg·m²", kNotNegative, o.model.joints())},
      q_{this, "q", o.model.joints(),
         EachInRangeOr0("position", o.position, "rad", kAnyNumber, o.model.joints())},
      v_{this, "v", o.model.joints(),
         EachInRangeOr0("velocity", o.velocity, "rad/s", kAnyNumber, o.model.joints())},
      work_{this, "work"} {
  Derivative(q_).From(v_).As([](const JointVelocity& v) { return v; });
  Derivative(v_).From(acceleration).As([](const JointAcceleration& a) { return a; });
  Compute(position).From(q_).As([](const JointPosition& q) { return q; });
  Compute(velocity).From(v_).As([](const JointVelocity& v) { return v; });
  if (simbody_)
    Compute(acceleration).From(work_, q_, v_, torque, loads, contacts).As(&SimbodyPlant::BySimbody);
  else
    Compute(acceleration).From(motion, torque, loads, contacts).As(&SimbodyPlant::Recursively);
  Compute(motion).From(q_, v_).As(&SimbodyPlant::Move);
  Compute(energy).From(motion).As(&SimbodyPlant::Energy);
  Compute(dissipation).From(v_).As(&SimbodyPlant::Dissipate);
}

JointAcceleration SimbodyPlant::BySimbody(Workspace& w, const JointPosition& q,
                                          const JointVelocity& v, const JointTorque& tau,
                                          const Joined<JointTorque>& joined_loads,
                                          const Joined<ContactForce>& joined_contacts) const {
  w.forces.clear();
  for (int i = 0; i < joined_contacts.size(); ++i) w.forces.push_back(joined_contacts[i]);
  JointTorque net = tau - d_.cwiseProduct(v);
  for (int i = 0; i < joined_loads.size(); ++i) net += joined_loads[i];
  return simbody_->ForwardDynamics(q, v, net, w.forces, B_, w.simbody);
}

JointAcceleration SimbodyPlant::Recursively(const RobotDynamics& d, const JointTorque& tau,
                                            const Joined<JointTorque>& joined_loads,
                                            const Joined<ContactForce>& joined_contacts) const {
  JointTorque net = tau - d_.cwiseProduct(d.v);
  for (int i = 0; i < joined_loads.size(); ++i) net += joined_loads[i];
  for (int i = 0; i < joined_contacts.size(); ++i)
    net += ExternalTorque(model_, d, {&joined_contacts[i], 1});
  return pliant::ForwardDynamics(d, net, JointTorque::Zero(model_.joints()), B_);
}

void SimbodyPlant::Move(RobotDynamics& d, const JointPosition& q, const JointVelocity& v) const {
  ComputeDynamics(model_, q, v, d);
}

double SimbodyPlant::Energy(const RobotDynamics& d) const {
  return KineticEnergy(d) + 0.5 * d.v.dot(B_.cwiseProduct(d.v)) + PotentialEnergy(model_, d);
}

double SimbodyPlant::Dissipate(const JointVelocity& v) const { return v.dot(d_.cwiseProduct(v)); }

}  // namespace pliant
