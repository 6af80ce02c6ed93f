#pragma once

#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The joint acceleration the environment asks for, q̈_e = M⁻¹ τ̂_e, computed once for all tasks.
class ExternalAcceleration final : public Block {
 public:
  struct Options {
    Joints joints;
  };

  explicit ExternalAcceleration(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> external_torque;  ///< τ̂_e; 0 if not connected
  Output<JointAcceleration> acceleration;
};

}  // namespace pliant
