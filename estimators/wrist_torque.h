#pragma once

#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a wrist sensor tells of the external torque:
///
///   τ_s = J_sᵀ F_s
///
/// F_s is what touches the tool, in the sensor's frame, as ToolCompensation makes it; J_s is the
/// Jacobian of that frame at its origin, in the same axes. What touches the arm before the sensing
/// plane is not in it.
///
/// Source: Celerier et al. 2025 (26).
class WristTorque final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string frame;  ///< link whose frame is the sensor's
  };

  explicit WristTorque(const Options& o);

  Input<Wrench> contact;  ///< F_s, of the environment on the robot
  Input<RobotDynamics> dynamics;
  Output<JointTorque> torque;  ///< τ_s

 private:
  JointTorque Torque(const Wrench& F, const RobotDynamics& d) const;

  const RobotModel model_;
  const int link_;
};

}  // namespace pliant
