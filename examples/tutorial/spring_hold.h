#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

/// Holds a posture as a damped spring would, beside the arm's own weight:
///
///   τ = g(q) + K (q₀ − q) − D q̇
class SpringHold final : public pliant::Block {
 public:
  struct Options {
    pliant::RobotModel model;
    pliant::JointPosition posture;  ///< q₀ [rad]
    pliant::PerJoint stiffness;     ///< K [N·m/rad], each ≥ 0
    pliant::PerJoint damping;       ///< D [N·m·s/rad], each ≥ 0
    pliant::Duration period = std::chrono::milliseconds(1);
  };

  explicit SpringHold(const Options& o)
      : dynamics{this, "dynamics", o.model.joints()},
        torque{this, "torque", o.model.joints()},
        posture_{o.posture},
        stiffness_{o.stiffness},
        damping_{o.damping} {
    for (const Eigen::Index n : {o.posture.size(), o.stiffness.size(), o.damping.size()})
      pliant::Require(n == o.model.size(), "a number for each joint of the model is needed", n);
    pliant::Require(stiffness_.minCoeff() >= 0, "stiffness must be ≥ 0", stiffness_.minCoeff());
    pliant::Require(damping_.minCoeff() >= 0, "damping must be ≥ 0", damping_.minCoeff());
    Every(o.period).Compute(torque).From(dynamics).As(&SpringHold::Law);
  }

  pliant::Input<pliant::RobotDynamics> dynamics;
  pliant::Output<pliant::JointTorque> torque;

 private:
  pliant::JointTorque Law(const pliant::RobotDynamics& d) const {
    return d.gravity + stiffness_.cwiseProduct(posture_ - d.q) - damping_.cwiseProduct(d.v);
  }

  const pliant::JointPosition posture_;
  const pliant::PerJoint stiffness_, damping_;
};
