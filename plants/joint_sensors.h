#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// Samples what an arm shows, every h, and holds it. At tick k the torque is the one that acted up
/// to then, u_{k−1}.
class JointSensors final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;
  };

  explicit JointSensors(const Options& o);

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Input<JointTorque> torque;
  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;
};

}  // namespace pliant
