#pragma once

#include <optional>

#include "pliant/plants/actuator_parameters.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A bit for each joint: 1, 2, 4, … for the first, second, third.
using JointBits = std::uint32_t;

/// The motors of an arm with their current loops:
///
///   θ di/dt = clamp(i_command, ± i_max) − i,   τ_m = clamp(η K_T G_r i, ± τ_max)
///
/// θ = 0: i is the clamped command. The loops are at rest at first, or at `current`.
class MotorDrive final : public Block {
 public:
  struct Options {
    Joints joints;
    std::vector<ActuatorParameters> parameters;  ///< of each joint
    MotorCurrent current = {};                   ///< i at the start; empty: 0
  };

  explicit MotorDrive(const Options& o);

  Input<MotorCurrent> command;
  Output<MotorCurrent> current;  ///< i
  Output<JointTorque> torque;    ///< τ_m, behind the gear
  Output<JointBits> saturated;   ///< joints whose command or torque is cut

 private:
  MotorCurrent Clamp(const MotorCurrent& command) const;
  MotorCurrentRate Follow(const MotorCurrent& i, const MotorCurrent& command) const;
  MotorCurrent Flowing(const MotorCurrent& i, const MotorCurrent& command) const;
  JointTorque Turn(const MotorCurrent& i) const;
  JointBits Cut(const MotorCurrent& command, const MotorCurrent& i) const;

  PerJoint i_max_, tau_max_, theta_, per_ampere_;
  std::optional<Continuous<MotorCurrent>> i_;
};

}  // namespace pliant
