#pragma once

#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What controllers and observers ask of a robot model at one (q, v), computed once for all of
/// them:
///
///   M + diag(B),  C v,  Cᵀ v,  g,  p = (M + diag(B)) v,  frames, Jacobians, J̇ v
///
/// B is the reflected rotor inertia of each joint: give it where torques move the rotors too, as
/// those of a controller do. Torque sensors behind the gears do not feel the rotors; observers
/// that read them are told B and take it off again.
class ModelDynamics final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::vector<std::string> frames = {};  ///< names of links, at most kMaxFrames
    PerJoint rotor_inertia = {};           ///< B [kg·m²], each ≥ 0; empty: none
  };

  explicit ModelDynamics(const Options& o);

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Output<RobotDynamics> dynamics;

 private:
  void At(RobotDynamics& d, const JointPosition& q, const JointVelocity& v) const;

  const RobotModel model_;
  const PerJoint B_;
};

}  // namespace pliant
