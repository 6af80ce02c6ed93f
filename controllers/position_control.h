#pragma once

#include "pliant/plants/arm_status.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Position control by acceleration, every h: the baseline of those that follow torques,
///
///   q̈ = clamp(q̈_r + k_p (r − q) + k_d (ṙ − q̇) + I, ± a_max)
///   τ = clamp(M q̈ + C q̇ + g, ± τ_max)
///   I_{k+1} = clamp(I_k + h k_i (r − q), ± a_max)
///
/// M holds the rotors if `dynamics` does. A joint's integral stands still while its acceleration
/// or torque is cut and the error would drive it further.
/// Source: Celerier et al. 2025 (EC), IV-D; its gains are not published.
class PositionControl final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint stiffness;           ///< k_p [1/s²], each ≥ 0
    PerJoint damping;             ///< k_d [1/s], each ≥ 0
    PerJoint integral;            ///< k_i [1/s³], each ≥ 0
    PerJoint acceleration_limit;  ///< a_max [rad/s²], each > 0
    PerJoint torque_limit;        ///< τ_max [N·m], each > 0
    Duration period;              ///< h
  };

  explicit PositionControl(const Options& o);

  Input<JointPosition> reference;                   ///< r
  Input<JointVelocity> reference_velocity;          ///< ṙ; 0 if not connected
  Input<JointAcceleration> reference_acceleration;  ///< q̈_r; 0 if not connected
  Input<RobotDynamics> dynamics;                    ///< at q and q̇ as they are measured
  Output<JointAcceleration> acceleration;           ///< q̈
  Output<JointTorque> torque;                       ///< τ
  Output<JointBits> saturated;                      ///< joints whose q̈ or τ is cut

 private:
  JointAcceleration Demand(const JointPosition& r, const JointVelocity& r_dot,
                           const JointAcceleration& a_r, const RobotDynamics& d,
                           const JointAcceleration& I) const;
  JointAcceleration Bounded(const JointAcceleration& demand) const;
  JointTorque Deliverable(const JointTorque& asked) const;
  JointAcceleration Integrate(const JointAcceleration& I, const JointPosition& r,
                              const RobotDynamics& d, const JointAcceleration& demand,
                              const JointTorque& asked) const;
  JointBits Cut(const JointAcceleration& demand, const JointTorque& asked) const;

  const Options o_;
  const double h_;
  Output<JointAcceleration> demand_;  // before it is cut
  Output<JointTorque> asked_;         // the same
  Discrete<JointAcceleration> I_;
};

}  // namespace pliant
