#pragma once

#include <optional>

#include "pliant/diagrams/torque_loop_choice.h"
#include "pliant/plants/arm_status.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// What makes an arm deliver the torques of a control law: currents for its motors, or, of an arm
/// that takes torques, nothing but the account of what is missing.
///
///   torque, acceleration, measured_… ─▶ loop ─▶ current, saturated
///                                    ─▶ error ─▶ torque_error
class TorqueActuation final : public Composite {
 public:
  struct Options {
    Joints joints;
    PerJoint rotor_inertia = {};                         ///< B, reflected [kg·m²]; empty: none
    std::optional<LowLevelTorque::Options> motors = {};  ///< none: `current` stays zero
    TorqueLoopChoice loop = {};  ///< of the motors; its gains replace theirs
  };

  explicit TorqueActuation(const Options& o);

  Input<JointTorque> torque;              ///< τ_d, rotors included
  Input<JointAcceleration> acceleration;  ///< q̈_d
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Output<MotorCurrent> current;
  Output<JointTorque> torque_error;  ///< τ_d − B q̈_d − τ, behind the gears
  Output<JointBits> saturated;       ///< joints whose current is cut
};

}  // namespace pliant
