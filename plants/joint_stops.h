#pragma once

#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Hard stops at the ends of the joints' ranges, for each joint
///
///   τ = −max(0, k p (1 + c ṗ)),   p = q − upper,   ṗ = v     where q > upper
///   τ =  max(0, k p (1 + c ṗ)),   p = lower − q,   ṗ = −v    where q < lower
///   τ = 0                                                    in between
///
/// A stop pushes back and never pulls: the clip holds where a joint leaves fast, 1 + c ṗ < 0. A
/// joint of inertia M that hits a stop with speed v₁ leaves it with e v₁, for any k and M:
///
///   ln(1 + c v₁) − c v₁ = ln(1 − c e v₁) + c e v₁,   e = 1 − ⅔ c v₁ + O(c² v₁²)
///
/// Energy: E = Σ ½ k p² is stored, and dissipation = Σ (|τ| − k p) ṗ, which is k c p ṗ² ≥ 0 where
/// the stop pushes and −k p ṗ ≥ 0 where the joint leaves fast.
///
/// Assumes: the stop does not move. For a prismatic joint read m for rad and N for N·m.
///
/// Source: Hunt & Crossley, Coefficient of restitution interpreted as damping in vibroimpact,
/// J. Appl. Mech. 42(2), 1975, with damping λ = c k and exponent n = 1.
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
  Output<double> dissipation;         ///< [W]

 private:
  JointPosition Penetrate(const JointPosition& q) const;
  JointTorque Push(const JointPosition& p, const JointVelocity& v) const;
  double Store(const JointPosition& p) const;
  double Dissipate(const JointPosition& p, const JointVelocity& v) const;

  const JointPosition lower_, upper_;
  const PerJoint k_, c_;
};

}  // namespace pliant
