#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/joint_damper.h"
#include "pliant/controllers/low_level_torque.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// How far a frame is from where it is to be: [log(R R°ᵀ); p − p°], world axes.
struct PoseError : Signal<PoseError, Frame, 6> {
  using Signal::Signal;
  static constexpr Quantity quantity{"pose error", "rad, m"};
  static constexpr std::array<std::string_view, 6> elements{"rx", "ry", "rz", "x", "y", "z"};
};

/// Where the controller has τ̂_e from.
enum class TorqueEstimate { True, Observer, Zero };

inline const std::vector<std::string>& Words(TorqueEstimate) {
  static const std::vector<std::string> words{"true", "observer", "zero"};
  return words;
}

/// How a task is followed, and how much of it gives way.
struct TaskGains {
  double stiffness;   ///< λ₂ [1/s²]
  double damping;     ///< λ₁ [1/s]
  double weight;      ///< w
  double compliance;  ///< γ in Γ = γ I

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "1/s²", kNotNegative);
    f("damping", damping, "1/s", kNotNegative);
    f("weight", weight, "", kPositive);
    f("compliance", compliance, "", kNotNegative);
  }
};

/// Holds a pose of a tool and a posture by one QP, with as much compliance in each as asked for.
///
///   measured_… ─▶ dynamics ─▶ pose task, posture task ─▶ qp ─▶ low level ─▶ current
///              ─▶ observer ─▶ estimate ─▶ external acceleration, dampers ─▶ qp ─▶ torque
///
/// The rotors are part of what the controller moves and gives its compliance to; the observer,
/// which is driven by torque sensors behind the gears, takes their momentum off again.
/// Source: Celerier et al. 2025 (EC).
class ComplianceControl final : public Composite {
 public:
  struct Options {
    static constexpr const char* kTag = "Compliance";

    RobotModel model;        ///< the controller's
    JointPosition position;  ///< at the start: the posture and the pose to hold
    PerJoint rotor_inertia;  ///< B, reflected [kg·m²]; empty: none
    Duration period = 1ms;   ///< of the arm's interface
    /// Makes currents of the torques; without, `current` stays zero.
    std::optional<LowLevelTorque::Options> low_level = {};

    std::string tool;  ///< link whose pose is held
    TaskGains pose{.stiffness = 400, .damping = 40, .weight = 1e4, .compliance = 0};
    TaskGains posture{.stiffness = 0, .damping = 5, .weight = 1, .compliance = 0};
    TorqueEstimate estimate = TorqueEstimate::Observer;
    double observer_gain = 50;  ///< K_I [1/s]
    JointDamper::Options damper = {};

    template <class F>
    void Parameters(F&& f) {
      f("tool", tool);
      f("pose", pose);
      f("posture", posture);
      f("estimate", estimate);
      f("observer_gain", observer_gain, "1/s", kPositive);
      f("damper", damper);
    }
  };

  explicit ComplianceControl(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Input<JointTorque> true_torque;  ///< τ_e; 0 if not connected
  Output<JointTorque> torque;      ///< τ_d
  Output<MotorCurrent> current;
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<JointTorque> residual;            ///< of the observer
  Output<PoseError> pose_error;
  Output<Twist> pose_error_rate;
  Output<JointPosition> posture_error;
  Output<ComplianceQpReport> report;
};

}  // namespace pliant
