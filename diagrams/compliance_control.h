#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/controllers/collision_damper.h"
#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/compliance_supervisor.h"
#include "pliant/controllers/control_supervisor.h"
#include "pliant/controllers/force_limit.h"
#include "pliant/controllers/frame_speed_limit.h"
#include "pliant/controllers/joint_damper.h"
#include "pliant/controllers/pad_events.h"
#include "pliant/controllers/path_phase.h"
#include "pliant/controllers/pose_reference.h"
#include "pliant/controllers/virtual_door.h"
#include "pliant/controllers/workspace_planes.h"
#include "pliant/diagrams/contact_tasks.h"
#include "pliant/diagrams/external_torque_estimate.h"
#include "pliant/diagrams/torque_loop_choice.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// How far a frame is from where it is to be: [log(R R°ᵀ); p − p°], world axes.
struct PoseError : Signal<PoseError, Frame, 6> {
  using Signal::Signal;
  static constexpr Quantity quantity{"pose error", "rad, m"};
  static constexpr std::array<std::string_view, 6> elements{"rx", "ry", "rz", "x", "y", "z"};
};

/// How a pose is followed, and how much of it gives way.
struct PoseGains {
  double stiffness = 400;                                         ///< λ₂ [1/s²]
  double damping = 40;                                            ///< λ₁ [1/s]
  double weight = 1e4;                                            ///< w; 0: the pose is left alone
  TaskMatrix compliance = {};                                     ///< Γ, as FrameTask has it
  TaskMatrix mobility = {};                                       ///< Y [1/kg, 1/(kg·m²)]
  Eigen::Matrix3d compliance_axes = Eigen::Matrix3d::Identity();  ///< of Γ and Y, as columns

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "1/s²", kNotNegative);
    f("damping", damping, "1/s", kNotNegative);
    f("weight", weight, "", kNotNegative);
    f("compliance", compliance);
    f("mobility", mobility);
    f("compliance_axes", compliance_axes);
  }
};

/// The same of a posture.
struct PostureGains {
  JointMatrix stiffness = {};  ///< λ₂ [1/s²], a number or one for each joint; empty: 0
  JointMatrix damping = JointMatrix::Constant(1, 1, 5);  ///< λ₁ [1/s], the same way
  double weight = 1;                                     ///< w₀
  JointMatrix compliance = {};                           ///< Γ₀, as PostureTask has it

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "1/s²", kNotNegative);
    f("damping", damping, "1/s", kNotNegative);
    f("weight", weight, "", kPositive);
    f("compliance", compliance);
  }
};

/// A mode that begins. What is none stays what it was.
struct ComplianceChange {
  double at_s = kToBeGiven;
  std::optional<ComplianceMode> mode = {};
  std::optional<bool> dynamic = {};
  std::optional<ArmControl> control = {};

  template <class F>
  void Parameters(F&& f) {
    f("at_s", at_s, "s", Between(0, 1e6));
    f("mode", mode);
    f("dynamic", dynamic);
    f("control", control);
  }
};

/// Modes instead of the gains of the tasks.
struct SupervisedModes {
  ComplianceMode mode = ComplianceMode::NullSpace;  ///< at the start
  bool dynamic = false;
  /// What moves the arm at the start, and may change; none: `command` and `torque_loop` all along.
  std::optional<ArmControl> control = {};
  std::optional<KinovaDampedLoop> kinova_loop = {};  ///< of kinova_torque; not of an ideal arm
  ControlSupervisor::Settings switching = {};
  std::vector<ComplianceChange> changes = {};  ///< in order of time
  std::optional<PadEvents> pad = {};  ///< instead: what a game controller was recorded to say
  ComplianceSupervisor::Options supervisor = {};

  template <class F>
  void Parameters(F&& f) {
    f("mode", mode);
    f("dynamic", dynamic);
    f("control", control);
    f("kinova_loop", kinova_loop);
    f("switching", switching);
    f("changes", changes);
    f("pad", pad);
    supervisor.Parameters(f);
  }
};

/// What a tool follows. Poses are relative to the one at the start, in world axes.
using ToolReference = std::variant<PoseWaypoints::Options, PoseTable::Options, PoseSwing::Options,
                                   PoseCircle::Options>;

/// What the arm is commanded.
enum class ArmCommand {
  Torque,    ///< τ_d
  Position,  ///< the accelerations, integrated from the start
};

inline const std::vector<std::string>& Words(ArmCommand) {
  static const std::vector<std::string> words{"torque", "position"};
  return words;
}

/// Holds a pose of a tool and a posture by one QP, with as much compliance in each as asked for.
///
///   measured_… ─▶ dynamics ─▶ pose task, posture task, limits ─▶ qp ─▶ low level ─▶ current
///              ─▶ estimate ─▶ external acceleration ─▶ tasks     ├──▶ torque
///                    └──▶ contact ─▶ supervisor ─▶ tasks         └──▶ reference ─▶ position
///
/// The rotors are part of what the controller moves and gives its compliance to; the observer,
/// which is driven by torque sensors behind the gears, takes them off again. With the command
/// Position, tasks and limits are about the reference, and the estimate about the arm.
///
/// With `modes.control` the arm changes between position control and two torque loops while it
/// runs; ControlSupervisor says when. Then the motors get currents in either loop, which fade from
/// one to the other within `modes.change_s`, or of an ideal arm torques as if 1 A made 1 N·m; the
/// reference follows the arm while torques move it, and a loop that does not move the arm sees no
/// error.
/// With `contacts` wherever the arm is touched is a task beside the pose, under all limits:
///
///   residual ─▶ contact tasks ─▶ objectives ─▶ qp
///                     └──▶ residual less its offset ─▶ external acceleration, qp
///
/// A pose that is to be left to what touches the arm has the weight 0.
///
/// Source: Celerier et al. 2025 (EC); of contacts Magrini, Flacco & De Luca 2015 (CF).
class ComplianceControl final : public Composite {
 public:
  struct Options {
    static constexpr const char* kTag = "Compliance";

    RobotModel model;        ///< the controller's
    JointPosition position;  ///< at the start: the posture and the pose to hold
    PerJoint rotor_inertia;  ///< B, reflected [kg·m²]; empty: none
    Duration period = 1ms;   ///< of the arm's interface
    /// The motors that `torque_loop` makes currents for; its gains replace theirs. Without,
    /// `current` stays zero.
    std::optional<LowLevelTorque::Options> low_level = {};
    std::optional<WristTool> wrist = {};  ///< the sensor, if there is one

    std::string tool;  ///< link whose pose is held
    PoseGains pose = {};
    PostureGains posture = {};
    std::optional<SupervisedModes> modes = {};
    std::optional<ToolReference> reference = {};     ///< none: the pose at the start
    std::optional<PathPhase::Options> scaling = {};  ///< of the reference's time
    std::optional<VirtualDoor::Options> door = {};   ///< that the tool is the handle of
    TorqueEstimate estimate = TorqueEstimate::Observer;
    double observer_gain = 50;   ///< K_I [1/s]
    double observer_rate = 500;  ///< L of the sliding modes [N·m/s]
    JointDamper::Options damper = {};
    std::optional<CollisionDamper::Options> collisions = {};
    std::optional<FrameSpeedLimit::Options> speed_limit = {};
    std::vector<WorkspacePlanes::Options> workspace = {};
    std::optional<ForceLimit::Options> force_limit = {};  ///< of the wrist sensor's contact
    std::optional<ContactSettings> contacts = {};         ///< none: what touches the arm is no task
    double contact_weight = 1e6;  ///< of each of the contacts, beside the pose's
    ArmCommand command = ArmCommand::Torque;
    TorqueLoopChoice torque_loop = {};

    template <class F>
    void Parameters(F&& f) {
      f("tool", tool);
      f("pose", pose);
      f("posture", posture);
      f("modes", modes);
      f("reference", reference);
      f("scaling", scaling);
      f("door", door);
      f("estimate", estimate);
      f("observer_gain", observer_gain, "1/s", kPositive);
      f("observer_rate", observer_rate, "N·m/s", kPositive);
      f("damper", damper);
      f("collisions", collisions);
      f("speed_limit", speed_limit);
      f("workspace", workspace);
      f("force_limit", force_limit);
      f("contacts", contacts);
      f("contact_weight", contact_weight, "", kPositive);
      f("command", command);
      f("torque_loop", torque_loop);
    }
  };

  explicit ComplianceControl(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Input<JointTorque> true_torque;  ///< τ_e; 0 if not connected
  Input<Wrench> wrench;            ///< of the wrist sensor; 0 if not connected
  Input<bool> wrench_valid;        ///< true if not connected
  /// Somebody else has the arm, such as a SafetySupervisor; false if not connected. Read under
  /// position control: the reference then is the arm itself, so that it goes on from there, and
  /// modes hold the tool where it is. Not with a `reference` or a `door`, which go on meanwhile:
  /// who gives the arm back must see how far away they are.
  Input<bool> held;
  Input<MotorCurrent> measured_current;  ///< read with modes.control only
  InputList<ContactForce> contacts;      ///< of the environment
  /// Of the camera, if `contacts` are seen.
  std::optional<Input<DepthImage>> image;
  /// What is wanted of `modes` with neither changes nor a game controller; what the modes are at
  /// the start if not connected. The last one with `modes.control` only.
  std::optional<Input<ComplianceMode>> wanted_mode;
  std::optional<Input<bool>> wanted_dynamic;
  std::optional<Input<ArmControl>> wanted_control;
  Output<JointTorque> torque;  ///< τ_d
  Output<MotorCurrent> current;
  Output<JointTorque> torque_error;        ///< τ_d − B q̈_d − τ, behind the gears
  Output<JointBits> saturated;             ///< joints whose current is cut
  Output<JointPosition> position;          ///< of the reference; measured with the command Torque
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<JointTorque> external_torque;     ///< τ̂_e
  Output<JointTorque> residual;            ///< of the observer
  Output<Wrench> contact;                  ///< at the wrist, without the tool; 0 without a reading
  Output<bool> yields;                     ///< the supervisor, in the mode Dual
  Output<ArmControl> arm_control;          ///< what moves the arm
  Output<ControlMode> arm_mode;            ///< the mode it is to be in for that
  Output<bool> braking;                    ///< from torque to position
  Output<PairDistances> distance;          ///< of what is kept apart
  Output<DoorMotion> door;
  Output<Pose> target;           ///< of the tool, in the world
  Output<PoseError> pose_error;  ///< these three of the reference, with the command Position
  Output<Twist> pose_error_rate;
  Output<JointPosition> posture_error;
  Output<ComplianceQpReport> report;

  const ContactTasks* contact_tasks = nullptr;  ///< if there are `contacts`
};

}  // namespace pliant
