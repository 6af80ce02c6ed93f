#pragma once

#include "pliant/plants/actuator_parameters.h"
#include "pliant/plants/motor_drive.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// The actuators of an arm: current commands in, torque on the links out.
///
///   command ─▶ drive ─▶ transmission ─▶ torque, joint_torque
///                         ▲     │ ω
///                         └─ friction
///
/// With a rigid transmission the plant carries the rotors: give it rotor_inertia = reflected
/// inertia, and connect its acceleration, which the torque sensors need.
class Actuators final : public Composite {
 public:
  struct Options {
    Joints joints;
    ArmActuators parameters;
    JointPosition position;       ///< of the links at the start [rad]
    JointVelocity velocity = {};  ///< of the links at the start [rad/s]; empty: at rest
    Duration period = 1ms;        ///< at which the drives sample their command
    JointTorque load = {};  ///< what drives and springs carry at the start [N·m]; empty: none
  };

  explicit Actuators(const Options& o);

  Input<MotorCurrent> command;
  Input<JointPosition> position;          ///< q, of the links
  Input<JointVelocity> velocity;          ///< v
  Input<JointAcceleration> acceleration;  ///< v̇; not read by an elastic transmission

  Output<JointTorque> torque;            ///< on the links
  Output<JointTorque> joint_torque;      ///< what torque sensors measure
  Output<MotorCurrent> current;          ///< i
  Output<JointTorque> motor_torque;      ///< τ_m, behind the gear
  Output<JointVelocity> motor_velocity;  ///< ω, behind the gear
  Output<JointTorque> friction;          ///< τ_f
  Output<JointBits> saturated;           ///< joints whose current or torque is cut
  Output<double> energy;       ///< in springs, bristles and rotors; those of a rigid transmission
                               ///< are the plant's [J]
  Output<double> dissipation;  ///< by friction and in the transmission [W]
  Output<double> power;        ///< τ_m ω, what the motors put in [W]
};

}  // namespace pliant
