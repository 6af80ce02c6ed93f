#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// What an arm does about an estimate of the external torque, apart in what moves its tool and what
/// does not:
///
///   τⁿ = P ( k_n τ̂_e + K_n (q_0 − q) − D_n q̇_n ) − k_t (I − P) τ̂_e
///   P = I − Jᵀ Λ J M⁻¹,   Λ = (J M⁻¹ Jᵀ)⁻¹,   q̇_n = Pᵀ q̇
///
/// P is the dynamically consistent projector: J M⁻¹ P = 0, so what it leaves does not accelerate
/// the tool, and J q̇_n = 0. D_n takes q̇_nᵀ D_n q̇_n ≥ 0. k_n = 1 eases a push in the null space to
/// half the arm's inertia, k_n = 0 leaves it; k_t = 1 takes off what a push does to the tool, so
/// that with k_n = 0 the arm answers with its own inertia, K_n about a posture q_0 and D_n, in the
/// null space alone: the null-space impedance of Sadeghian et al. with the natural inertia. NS
/// compares itself with k_n = 1, k_t = 0, "the estimated null space interaction forces replace" its
/// own τⁿ, in as far as it can be told.
///
/// Λ is exact while its eigenvalues are at most half of `inertia_limit`, as in FrameTask.
///
/// Source: Sadeghian, Villani, Keshmiri & Siciliano, IEEE Trans. Robotics 30(2), 2014, for the
/// idea; Khatib, IEEE J. Robotics and Automation 3(1), 1987, for P.
class NullSpaceReaction final : public Block {
 public:
  struct Options {
    Joints joints;
    double null_space_gain = 1;  ///< k_n ≥ 0
    double tool_gain = 0;        ///< k_t ≥ 0
    double stiffness = 0;        ///< K_n ≥ 0 [N·m/rad]
    JointPosition posture = {};  ///< q_0; to be given with a stiffness
    double damping = 1;          ///< D_n ≥ 0 [N·m·s/rad]
    double inertia_limit = 200;  ///< [kg, kg·m²]
  };

  explicit NullSpaceReaction(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<FrameDynamics> frame{this, "frame"};
  Input<JointTorque> external_torque;  ///< τ̂_e
  Output<JointTorque> torque;          ///< τⁿ

 private:
  JointTorque Act(const RobotDynamics& d, const FrameDynamics& now, const JointTorque& tau_e) const;

  const Options o_;
};

}  // namespace pliant
