#include "pliant/plants/transmission.h"

#include "pliant/systems/elements.h"

namespace pliant {

RigidTransmission::RigidTransmission(const Options& o)
    : motor_torque{this, "motor_torque", o.joints},
      friction{this, "friction", o.joints, JointTorque::Zero(o.joints)},
      acceleration{this, "acceleration", o.joints},
      torque{this, "torque", o.joints},
      joint_torque{this, "joint_torque", o.joints},
      B_{FiguresOf(Checked(o.joints, o.parameters), &ActuatorParameters::reflected_inertia)} {
  Compute(torque)
      .From(motor_torque, friction)
      .As([](const JointTorque& tau_m, const JointTorque& tau_f) {
        return JointTorque(tau_m - tau_f);
      });
  Compute(joint_torque).From(torque, acceleration).As(&RigidTransmission::Measure);
}

JointTorque RigidTransmission::Measure(const JointTorque& tau, const JointAcceleration& a) const {
  return tau - B_.cwiseProduct(a);
}

ElasticTransmission::ElasticTransmission(const Options& o)
    : motor_torque{this, "motor_torque", o.joints},
      friction{this, "friction", o.joints, JointTorque::Zero(o.joints)},
      position{this, "position", o.joints},
      velocity{this, "velocity", o.joints},
      joint_torque{this, "joint_torque", o.joints},
      motor_position{this, "motor_position", o.joints},
      motor_velocity{this, "motor_velocity", o.joints},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      B_{FiguresOf(Checked(o.joints, o.parameters), &ActuatorParameters::reflected_inertia)},
      K_{FiguresOf(o.parameters, &ActuatorParameters::stiffness)},
      D_{FiguresOf(o.parameters, &ActuatorParameters::damping)},
      theta_{this, "theta", o.joints, Start(o)},
      omega_{this, "omega", o.joints,
             EachInRangeOr0("velocity", o.velocity, "rad/s", kAnyNumber, o.joints)} {
  RequireEachInRange("rotor_inertia behind a spring", B_, "kg·m²", kPositive, o.joints);
  RequireEachInRange("stiffness of a spring", K_, "N·m/rad", kPositive, o.joints);
  Derivative(theta_).From(omega_).As([](const JointVelocity& omega) { return omega; });
  Derivative(omega_)
      .From(motor_torque, friction, joint_torque)
      .As(&ElasticTransmission::Accelerate);
  Compute(joint_torque).From(theta_, omega_, position, velocity).As(&ElasticTransmission::Spring);
  Compute(motor_position).From(theta_).As([](const JointPosition& theta) { return theta; });
  Compute(motor_velocity).From(omega_).As([](const JointVelocity& omega) { return omega; });
  Compute(energy).From(theta_, omega_, position).As(&ElasticTransmission::Energy);
  Compute(dissipation).From(omega_, velocity).As(&ElasticTransmission::Dissipate);
}

JointPosition ElasticTransmission::Start(const Options& o) {
  RequireEachInRange("position", o.position, "rad", kAnyNumber, o.joints);
  return o.position + EachInRangeOr0("load", o.load, "N·m", kAnyNumber, o.joints)
                          .cwiseQuotient(FiguresOf(o.parameters, &ActuatorParameters::stiffness));
}

JointTorque ElasticTransmission::Spring(const JointPosition& theta, const JointVelocity& omega,
                                        const JointPosition& q, const JointVelocity& v) const {
  return K_.cwiseProduct(theta - q) + D_.cwiseProduct(omega - v);
}

JointAcceleration ElasticTransmission::Accelerate(const JointTorque& tau_m,
                                                  const JointTorque& tau_f,
                                                  const JointTorque& tau_J) const {
  return (tau_m - tau_f - tau_J).cwiseQuotient(B_);
}

double ElasticTransmission::Energy(const JointPosition& theta, const JointVelocity& omega,
                                   const JointPosition& q) const {
  return 0.5 *
         (B_.array() * omega.array().square() + K_.array() * (theta - q).array().square()).sum();
}

double ElasticTransmission::Dissipate(const JointVelocity& omega, const JointVelocity& v) const {
  return (D_.array() * (omega - v).array().square()).sum();
}

}  // namespace pliant
