#pragma once

#include <optional>
#include <string>
#include <variant>

#include "pliant/controllers/motion_generator.h"
#include "pliant/controllers/null_space_impedance.h"
#include "pliant/controllers/null_space_reaction.h"
#include "pliant/controllers/pose_reference.h"
#include "pliant/controllers/tool_impedance.h"
#include "pliant/diagrams/torque_actuation.h"
#include "pliant/estimators/interaction_estimator.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// Classical impedance about a point that goes round a circle in time.
struct ClassicalMotion {
  static constexpr const char* kTag = "Classical";

  PoseCircle::Options circle = {};
  Eigen::Vector3d stiffness = Eigen::Vector3d::Constant(30);  ///< K_c [N/m]

  template <class F>
  void Parameters(F&& f) {
    circle.Parameters(f);
    f("stiffness", stiffness, "N/m", kNotNegative);
  }
};

/// Where the tool goes: by where it is, or by time. Positions are relative to the one at the start,
/// in world axes; the orientation is that at the start.
using ToolMotionChoice = std::variant<CircleGenerator::Options, LimitCycleGenerator::Options,
                                      GoalGenerator::Options, ClassicalMotion>;

/// How the velocity is tracked that a generator wants. NS publishes neither of the gains; these
/// were chosen on NS-A, the circle without interaction, and serve everywhere: docs/experiments.md.
struct TrackingGains {
  double gain = 4;         ///< k_p
  double rate_gain_s = 0;  ///< k_d [s]
  double cutoff_hz = 10;   ///< of the derivative that k_d takes

  template <class F>
  void Parameters(F&& f) {
    f("gain", gain, "", kPositive);
    f("rate_gain_s", rate_gain_s, "s", kNotNegative);
    f("cutoff_hz", cutoff_hz, "Hz", kPositive);
  }
};

/// No torque in the null space.
struct NoNullSpaceTorque {
  static constexpr const char* kTag = "None";

  template <class F>
  void Parameters(F&&) {}
};

/// NullSpaceImpedance, as its equation is printed.
struct PrintedNullSpaceTorque {
  static constexpr const char* kTag = "Printed";

  double damping = 5;        ///< d_n [N·m·s/rad]
  double friction_gain = 1;  ///< α_f
  double damping_gain = 1;   ///< α_d [N·m·s/rad]

  template <class F>
  void Parameters(F&& f) {
    f("damping", damping, "N·m·s/rad", kPositive);
    f("friction_gain", friction_gain, "", kNotNegative);
    f("damping_gain", damping_gain, "N·m·s/rad", kNotNegative);
  }
};

/// The same as its text means it: with the Coulomb friction that the controller takes the joints to
/// have.
struct MeantNullSpaceTorque : PrintedNullSpaceTorque {
  static constexpr const char* kTag = "Meant";
};

/// NullSpaceReaction to what a momentum observer says.
struct ObservedNullSpaceTorque {
  static constexpr const char* kTag = "Observer";

  double null_space_gain = 1;  ///< k_n
  double tool_gain = 0;        ///< k_t
  double stiffness = 0;        ///< K_n [N·m/rad], about the posture at the start
  double damping = 1;          ///< D_n [N·m·s/rad]

  template <class F>
  void Parameters(F&& f) {
    f("null_space_gain", null_space_gain, "", kNotNegative);
    f("tool_gain", tool_gain, "", kNotNegative);
    f("stiffness", stiffness, "N·m/rad", kNotNegative);
    f("damping", damping, "N·m·s/rad", kNotNegative);
  }
};

/// The same with an InteractionEstimator.
struct RegressedNullSpaceTorque : ObservedNullSpaceTorque {
  static constexpr const char* kTag = "LeastSquares";

  double memory_s = 0.1;                    ///< T
  double prior = 1;                         ///< r₀
  std::optional<InteractionPoint> at = {};  ///< none: any torque, as by an observer of K_I = 1/T

  template <class F>
  void Parameters(F&& f) {
    ObservedNullSpaceTorque::Parameters(f);
    f("memory_s", memory_s, "s", kPositive);
    f("prior", prior, "", kPositive);
    f("at", at);
  }
};

using NullSpaceChoice =
    std::variant<PrintedNullSpaceTorque, MeantNullSpaceTorque, NoNullSpaceTorque,
                 ObservedNullSpaceTorque, RegressedNullSpaceTorque>;

/// Moves a tool along a path so that people may hold it, and the arm's other motions so that people
/// may push them:
///
///   tool ─▶ generator ─▶ tracking ─▶ impedance ─▶ τᶜ ─┐
///    └────▶ null space ─▶ τⁿ ─────────────────────────┼─▶ torque ─▶ actuation
///   dynamics ─▶ g ───────────────────────────────────┘
///
///   τ = g + τᶜ + τⁿ
///
/// where every joint's effort limit cuts it. If a part is not finite, τ = g − d q̇, d the damping of
/// the fallback, and 0 for joints of which that is not finite either. Parts that remember a sample
/// that was not finite do not recover: the arm stays in the fallback.
///
/// The estimate of the external torque is that of the choice, or of a momentum observer for those
/// to see who look on. The rotors are part of what the controller moves; estimates take them off.
/// Before `start_s` nothing moves the tool: ṗ̃_d = 0, and a point that goes by time waits where it
/// is to start. The mean of the estimate over the second half of that time, with the arm at rest
/// and untouched, is taken off it (ResidualTare), and there is no estimate until then. With start_s
/// = 0 the estimate is as it is, with the offsets of the sensors. Of a force at a point, what is
/// taken off is the torque that an offset made there, which changes as the arm moves away.
///
/// Source: Yang, Wang & Kermani 2025 (NS).
class NullSpaceControl final : public Composite {
 public:
  struct Options {
    static constexpr const char* kTag = "NullSpaceCompliance";

    RobotModel model;        ///< the controller's
    JointPosition position;  ///< at the start: the orientation to hold, the origin of positions
    PerJoint rotor_inertia;  ///< B, reflected [kg·m²]; empty: none
    PerJoint coulomb;        ///< what the joints are taken to have [N·m]; empty: none
    Duration period = 1ms;   ///< of the arm's interface
    std::optional<LowLevelTorque::Options> low_level = {};  ///< the motors, if it is to drive them

    std::string tool;    ///< link that is moved
    double start_s = 0;  ///< when the tool begins to move
    ToolMotionChoice motion = {};
    TrackingGains tracking = {};                            ///< of a generator's velocity
    Eigen::Vector3d damping = Eigen::Vector3d(40, 40, 10);  ///< D, D_c [N·s/m]
    OrientationGains orientation = {};
    NullSpaceChoice null_space = {};
    double damped_below = 0.05;   ///< σ₀ of the projector
    double observer_gain = 50;    ///< K_I of the momentum observer [1/s]
    double fallback_damping = 5;  ///< d [N·m·s/rad]
    TorqueLoopChoice torque_loop = {};

    template <class F>
    void Parameters(F&& f) {
      f("tool", tool);
      f("start_s", start_s, "s", kNotNegative);
      f("motion", motion);
      f("tracking", tracking);
      f("damping", damping, "N·s/m", kNotNegative);
      f("orientation", orientation);
      f("null_space", null_space);
      f("damped_below", damped_below, "", kPositive);
      f("observer_gain", observer_gain, "1/s", kPositive);
      f("fallback_damping", fallback_damping, "N·m·s/rad", kNotNegative);
      f("torque_loop", torque_loop);
    }
  };

  explicit NullSpaceControl(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Input<JointTorque> true_torque;  ///< τ_e, of the passivity monitor; 0 if not connected
  Output<JointTorque> torque;      ///< τ
  Output<MotorCurrent> current;
  Output<JointTorque> torque_error;
  Output<JointBits> saturated;            ///< joints whose τ or whose motor's torque is cut
  Output<bool> fallback;                  ///< whether τ is that of the fallback
  Output<JointTorque> tool_torque;        ///< τᶜ
  Output<JointTorque> null_space_torque;  ///< τⁿ
  Output<JointTorque> external_torque;    ///< τ̂_e
  Output<LinearVelocity> desired;         ///< ṗ̃_d, or ṗ_d
  Output<LinearVelocity> velocity_error;  ///< ė_p
  Output<Position> target;                ///< p_d, the point of the path that the tool goes by
  Output<PathError> path_error;           ///< p − p_d
  Output<OrientationError> orientation_error;
  Output<double> storage, supply, excess;  ///< of the passivity monitor [J]
  Output<double> least_singular;           ///< of the tool's Jacobian
};

}  // namespace pliant
