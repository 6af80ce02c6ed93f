#pragma once

#include <vector>

#include "pliant/plants/actuator_parameters.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Rotors that turn with their links, in a plant whose inertia they add B = J G_r² to:
///
///   τ = τ_m − τ_f on M + diag(B),   τ_J = τ − B v̇
///
/// τ_J is what a torque sensor between rotor and link measures.
class RigidTransmission final : public Block {
 public:
  struct Options {
    Joints joints;
    std::vector<ActuatorParameters> parameters;  ///< of each joint
  };

  explicit RigidTransmission(const Options& o);

  Input<JointTorque> motor_torque, friction;  ///< τ_m, τ_f
  Input<JointAcceleration> acceleration;      ///< v̇, of the links
  Output<JointTorque> torque;                 ///< τ
  Output<JointTorque> joint_torque;           ///< τ_J

 private:
  JointTorque Measure(const JointTorque& tau, const JointAcceleration& a) const;

  const PerJoint B_;
};

/// Rotors behind springs, which are what a torque sensor measures:
///
///   θ̇ = ω,   B ω̇ = τ_m − τ_f − τ_J,   τ_J = K (θ − q) + D (ω − v)
///
/// θ is the angle of the rotor behind the gear, B = J G_r² [kg·m²]. At the start the rotors stand
/// where their springs carry `load`.
/// Source: Spong, J. Dynamic Systems, Measurement and Control 109(4), 1987.
class ElasticTransmission final : public Block {
 public:
  struct Options {
    Joints joints;
    std::vector<ActuatorParameters> parameters;  ///< of each joint
    JointPosition position;                      ///< q at the start [rad]
    JointVelocity velocity = {};                 ///< ω at the start [rad/s]; empty: at rest
    JointTorque load = {};                       ///< K (θ − q) at the start [N·m]; empty: none
  };

  explicit ElasticTransmission(const Options& o);

  Input<JointTorque> motor_torque, friction;  ///< τ_m, τ_f
  Input<JointPosition> position;              ///< q, of the links
  Input<JointVelocity> velocity;              ///< v, of the links
  Output<JointTorque> joint_torque;           ///< τ_J
  Output<JointPosition> motor_position;       ///< θ
  Output<JointVelocity> motor_velocity;       ///< ω
  Output<double> energy;                      ///< Σ ½ B ω² + ½ K (θ − q)² [J]
  Output<double> dissipation;                 ///< Σ D (ω − v)² [W]

 private:
  JointTorque Spring(const JointPosition& theta, const JointVelocity& omega, const JointPosition& q,
                     const JointVelocity& v) const;
  JointAcceleration Accelerate(const JointTorque& tau_m, const JointTorque& tau_f,
                               const JointTorque& tau_J) const;
  double Energy(const JointPosition& theta, const JointVelocity& omega,
                const JointPosition& q) const;
  double Dissipate(const JointVelocity& omega, const JointVelocity& v) const;

  static JointPosition Start(const Options& o);

  const PerJoint B_, K_, D_;
  Continuous<JointPosition> theta_;
  Continuous<JointVelocity> omega_;
};

}  // namespace pliant
