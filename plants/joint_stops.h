#pragma once

#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Hard stops at the ends of the joints' ranges, for each joint
///
///   τ = −N(p, ṗ),   p = q − upper,   ṗ = v     where q > upper
///   τ =  N(p, ṗ),   p = lower − q,   ṗ = −v    where q < lower
///   τ = 0                                      in between
///
/// N = max(0, k p (1 + c ṗ)) is the law of hunt_crossley.h: what a stop stores and loses stands
/// there, and how fast it throws a joint back.
///
/// Assumes: the stop does not move. For a prismatic joint read m for rad and N for N·m.
class JointStops final : public Block {
 public:
  struct Options {
    RobotModel model;
    JointPosition lower = {};  ///< [rad], −∞: no stop; empty: the model's limits
    JointPosition upper = {};  ///< [rad], ∞: no stop; empty: the model's limits
    PerJoint stiffness;        ///< k [N·m/rad], each > 0
    PerJoint damping = {};     ///< c [s/rad], each ≥ 0; empty: none
  };

  explicit JointStops(const Options& o);

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Output<JointTorque> torque;         ///< joins the plant's loads
  Output<JointPosition> penetration;  ///< q − upper > 0, q − lower < 0, or 0 [rad]
  Output<int> stopped;                ///< how many joints are at a stop
  Output<double> energy;              ///< Σ ½ k p² [J]
  Output<double> dissipation;         ///< Σ (|τ| − k p) ṗ [W]

 private:
  JointPosition Penetrate(const JointPosition& q) const;
  JointTorque Push(const JointPosition& p, const JointVelocity& v) const;
  double Store(const JointPosition& p) const;
  double Dissipate(const JointPosition& p, const JointVelocity& v) const;

  const JointPosition lower_, upper_;
  const PerJoint k_, c_;
};

}  // namespace pliant
