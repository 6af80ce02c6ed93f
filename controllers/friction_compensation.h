#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// Joint friction, fed forward by what is measured and by what is wanted:
///
///   τ_f = c sgn(q̇) + d q̇   where |q̇| ≥ q̇_th
///         s sgn(q̈_d)        where |q̇| < q̇_th and |q̈_d| ≥ q̈_th
///         0                  otherwise
///
/// q̈_d contains the external force, so a joint at rest is eased in the direction a person pushes.
/// Source: Muraccioli et al. 2025 (RSS).
class FrictionCompensation final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint coulomb;                   ///< c [N·m], each ≥ 0
    PerJoint viscous;                   ///< d [N·m·s/rad], each ≥ 0
    PerJoint stiction;                  ///< s [N·m], each ≥ 0
    double velocity_threshold = 0.1;    ///< q̇_th [rad/s], > 0
    double acceleration_threshold = 1;  ///< q̈_th [rad/s²], > 0
  };

  explicit FrictionCompensation(const Options& o);

  Input<JointVelocity> velocity;          ///< q̇
  Input<JointAcceleration> acceleration;  ///< q̈_d
  Output<JointTorque> torque;             ///< τ_f

 private:
  JointTorque Compensate(const JointVelocity& v, const JointAcceleration& a) const;

  const Options o_;
};

}  // namespace pliant
