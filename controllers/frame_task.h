#pragma once

#include <string>

#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A frame follows a target: with its whole pose, its orientation or its position.
///
///   e = x(q) − x°,   ë* = −λ₁ ė − λ₂ e                                         (EC 3)
///   w ‖ J q̈ʳ + J̇ q̇ − ẍ° − ë* − Γ J q̈_e ‖²                                    (EC 4, 9)
///
/// World axes, angular part first: e = [log(R R°ᵀ); p − p°], ė = V − V°. λ₁, λ₂ per axis. Γ says
/// how the task gives way to what pushes: 0 not at all, I as the arm's own inertia would, any
/// symmetric positive semi-definite matrix in between and beyond.
///
/// Away from 0 the rate of log(R R°ᵀ) is not ω − ω°, but eᵀ(V − V°) = d/dt ½‖e‖² holds up to half a
/// turn. So with the same λ₁, λ₂ for all axes ½λ₂‖e‖² + ½‖ė‖² falls at λ₁‖ė‖² where nothing hinders
/// the task.
///
/// Source: Celerier et al. 2025 (EC), with J q̈_e where the paper prints Jᵀ q̈_e.
class FrameTask final : public Block {
 public:
  enum class Part { Pose, Orientation, Position };

  struct Options {
    RobotModel model;
    std::string frame;  ///< name of a link
    Part part = Part::Pose;
    Pose target = {};            ///< X_W°, until one is connected
    TaskVector stiffness;        ///< λ₂ [1/s²], each ≥ 0
    TaskVector damping;          ///< λ₁ [1/s], each ≥ 0
    double weight = 1;           ///< w > 0
    TaskMatrix compliance = {};  ///< Γ; empty: 0
  };

  explicit FrameTask(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointAcceleration> external_acceleration;  ///< q̈_e; 0 if not connected
  Input<Pose> target;
  Input<Twist> target_twist;         ///< V°
  Input<Twist> target_acceleration;  ///< V̇°, [rad/s²; m/s²]
  Input<TaskVector> stiffness, damping;
  Input<double> weight;
  Input<TaskMatrix> compliance;
  Output<FrameDynamics> frame;
  Output<TaskVector> error;       ///< e [rad, m]
  Output<TaskVector> error_rate;  ///< ė [rad/s, m/s]
  Output<Objective> objective;

 private:
  FrameDynamics Find(const RobotDynamics& d) const;
  TaskVector Error(const FrameDynamics& now, const Pose& X) const;
  TaskVector ErrorRate(const FrameDynamics& now, const Twist& V) const;
  void Want(Objective& out, const FrameDynamics& now, const JointAcceleration& qdd_e,
            const TaskVector& e, const TaskVector& edot, const Twist& feedforward,
            const TaskVector& k, const TaskVector& c, double w, const TaskMatrix& gamma) const;

  const RobotModel model_;
  const int link_;
  const int first_, rows_;  // of the six
};

}  // namespace pliant
