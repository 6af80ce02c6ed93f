#pragma once

#include "pliant/controllers/compliance.h"
#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The joints follow a posture, with what freedom other tasks leave:
///
///   q̈* = q̈° − λ₁ (q̇ − q̇°) − λ₂ (q − q°),   w₀ ‖ q̈ʳ − q̈* − Γ₀ q̈_e ‖²        (EC 9)
///
/// Γ₀ as in FrameTask, n×n. Continuous joints are compared the short way round.
///
/// Source: Celerier et al. 2025 (EC).
class PostureTask final : public Block {
 public:
  struct Options {
    RobotModel model;
    JointPosition target;         ///< q° [rad], until one is connected
    PerJoint stiffness;           ///< λ₂ [1/s²], each ≥ 0
    PerJoint damping;             ///< λ₁ [1/s], each ≥ 0
    double weight = 1;            ///< w₀ > 0
    JointMatrix compliance = {};  ///< Γ₀; empty: 0; a number γ: γ I; a column: the diagonal
  };

  explicit PostureTask(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointAcceleration> external_acceleration;  ///< q̈_e; 0 if not connected
  Input<JointPosition> target;
  Input<JointVelocity> target_velocity;
  Input<JointAcceleration> target_acceleration;
  Input<PerJoint> stiffness, damping;
  Input<double> weight;
  Input<JointMatrix> compliance;
  Output<JointPosition> error;  ///< q − q°
  Output<Objective> objective;

 private:
  JointPosition Error(const RobotDynamics& d, const JointPosition& target) const;
  void Want(Objective& out, const RobotDynamics& d, const JointAcceleration& qdd_e,
            const JointPosition& e, const JointVelocity& v0, const JointAcceleration& a0,
            const PerJoint& k, const PerJoint& c, double w, const JointMatrix& gamma) const;

  const RobotModel model_;
};

}  // namespace pliant
