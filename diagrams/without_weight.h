#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant::internal {

/// The torque that is left to command where the arm makes that of gravity itself.
class WithoutWeight final : public Block {
 public:
  explicit WithoutWeight(const Joints& joints)
      : torque{this, "torque", joints},
        dynamics{this, "dynamics", joints},
        command{this, "command", joints} {
    Compute(command).From(torque, dynamics).As([](const JointTorque& tau, const RobotDynamics& d) {
      return JointTorque(tau - d.gravity);
    });
  }
  Input<JointTorque> torque;
  Input<RobotDynamics> dynamics;
  Output<JointTorque> command;
};

}  // namespace pliant::internal
