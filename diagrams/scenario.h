#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pliant/diagrams/compliance_control.h"
#include "pliant/diagrams/contact_control.h"
#include "pliant/diagrams/friction_experiment.h"
#include "pliant/diagrams/hardware_arm.h"
#include "pliant/diagrams/mode_schedule.h"
#include "pliant/diagrams/null_space_control.h"
#include "pliant/diagrams/simulated_arm.h"
#include "pliant/diagrams/stations.h"
#include "pliant/plants/hand.h"
#include "pliant/plants/live_push.h"
#include "pliant/plants/mass_on_rope.h"
#include "pliant/plants/model_error.h"
#include "pliant/plants/push.h"
#include "pliant/plants/surface.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/integrator.h"
#include "pliant/systems/record_sink.h"
#include "pliant/systems/stop_when.h"

namespace pliant {

/// Where a hand leads what it holds.
struct HandWaypoint {
  double after_s = kToBeGiven;                                 ///< since it took hold, > 0
  Eigen::Vector3d by = Eigen::Vector3d::Constant(kToBeGiven);  ///< from there, world axes [m]

  template <class F>
  void Parameters(F&& f) {
    f("after_s", after_s, "s", kPositive);
    f("by", by, "m");
  }
};

/// A hand that takes hold of a link, where the link is then, leads it from waypoint to waypoint
/// with least jerk, and lets go of it again.
struct HandHold {
  static constexpr const char* kTag = "Hand";

  Hand::Options hand = {};  ///< anchored
  double start_s = kToBeGiven;
  double duration_s = kToBeGiven;
  std::vector<HandWaypoint> path = {};  ///< in order of time; none: it stays

  template <class F>
  void Parameters(F&& f) {
    hand.Parameters(f);
    f("start_s", start_s, "s", Between(0, 1e6));
    f("duration_s", duration_s, "s", Between(1e-9, 1e6));
    f("path", path);
  }
};

/// A ball fixed to a link, of which the controller knows nothing.
struct Payload {
  std::string link;
  double mass = kToBeGiven;                          ///< [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in the link's frame [m]
  double radius = 0.03;                              ///< [m]

  template <class F>
  void Parameters(F&& f) {
    f("link", link);
    f("mass", mass, "kg", kPositive);
    f("center", center, "m");
    f("radius", radius, "m", kPositive);
  }
};

using EnvironmentPart =
    std::variant<Push::Options, HandHold, MassOnRope::Options, Surface::Options, LivePush::Options>;

/// What commands the arm.
using ArmController = std::variant<ComplianceControl::Options, FrictionExperiment::Options,
                                   NullSpaceControl::Options, ContactControl::Options>;

/// The settings of a !Compliance; throws Error if the controller is of another kind.
const ComplianceControl::Options& ComplianceOf(const ArmController& controller);

/// One run of an arm, as a file describes it: the fields are the keys, and what has a default may
/// be left out.
struct Scenario {
  /// gen3, gen3_bota, lwr, the URDF file of another arm, which ends in .urdf, or its text.
  std::string robot;
  std::variant<StationOptions, Gen3Station> station = {};
  std::optional<Payload> payload = {};
  ModelError model_error = {};  ///< of the controller's model
  /// What the controller takes for the joints' friction; without, that of the station.
  std::vector<IdentifiedFriction> assumed_friction = {};
  ArmController controller = {};
  std::vector<ModeChange> schedule = {};  ///< of the arm's mode; none: the controller's all along
  /// Of the supervisor between controller and arm; an arm that is there always has one.
  std::optional<SafetySupervisor::Settings> safety = {};
  std::vector<EnvironmentPart> environment = {};
  IntegratorOptions integrator = {};
  double duration_s = kToBeGiven;
  std::uint64_t seed = 1;                   ///< of the sensors' noise and bias, and of the scatter
  double position_scatter = 0;              ///< of each joint at the start, normal: σ [rad]
  std::optional<Duration> log_period = {};  ///< none: that of the controller
  /// Any of these ends a simulated run before its duration. They see what a log does, at the ticks
  /// of the controller.
  std::vector<StopWhen::Options> stop_when = {};

  template <class F>
  void Parameters(F&& f) {
    f("robot", robot);
    f("station", station);
    f("payload", payload);
    f("model_error", model_error);
    f("assumed_friction", assumed_friction);
    f("controller", controller);
    f("schedule", schedule);
    f("safety", safety);
    f("environment", environment);
    f("integrator", integrator);
    f("duration_s", duration_s, "s", Between(1e-3, 1e6));
    f("seed", seed, "", Between(0, 9007199254740992.0));
    f("position_scatter", position_scatter, "rad", kNotNegative);
    f("log_period", log_period);
    f("stop_when", stop_when);
  }
};

/// The URDF file of an arm that comes with pliant.
std::filesystem::path UrdfOf(const std::string& robot);

/// The robot of a scenario as its URDF says, and that.
RobotModel RobotOf(const Scenario& scenario);
std::string UrdfTextOf(const Scenario& scenario);

/// Whether a scenario's robot is none that comes with pliant.
bool IsOtherRobot(const std::string& robot);

/// Whether the arm is one that is there, or an emulated one.
bool IsHardware(const Scenario& scenario);
/// Whether the arm is simulated with torque sources.
bool IsIdeal(const Scenario& scenario);

/// The arm of a scenario, with everything that comes with its name filled in. It starts where the
/// scatter of the seed puts it, for the plant and the controller alike. Of an arm that is there it
/// is what is known of it.
SimulatedArm::Options StationOf(const Scenario& scenario);

/// The controller of a scenario for that arm: its model may have errors.
ArmController ControllerOf(const Scenario& scenario, const SimulatedArm::Options& arm);

/// What all controllers know of their arm.
const RobotModel& ModelOf(const ArmController& controller);
const std::string& ToolOf(const ArmController& controller);
Duration PeriodOf(const ArmController& controller);

/// The period of a scenario's controller, and that of the rows of its log.
Duration ControlPeriodOf(const Scenario& scenario);
Duration LogPeriodOf(const Scenario& scenario);

/// The pushes among a scenario's environment.
std::vector<Push::Options> PushesOf(const Scenario& scenario);

/// An arm, its controller and its environment, before they are built:
///
///   environment ─▶ arm ─▶ control ─▶ arm
///        │         ▲ └──▶ environment
///        └─▶ true_torque ─▶ control
///   schedule ──────┘
///
/// Controllers command the whole torque; of an arm that carries its own weight the gravity of their
/// model is taken off again on the way to it.
///
/// With a supervisor, commands go through it:
///
///   control, arm, timer, operator ─▶ safety ─▶ arm
///
/// A drill spoils what comes from the control and the timer on the way.
///
/// An arm that is there has no environment but its own: nothing here knows true torques.
///
/// True torques are those of contacts as a controller's ticks see them, by the plant's own model.
/// What `sink` gets, if there is one: measurements and truth of the arm, contacts, and the
/// ports of the controller. Throws Error with the path of the block that cannot be.
struct ScenarioDiagram {
  explicit ScenarioDiagram(const Scenario& scenario, std::shared_ptr<RecordSink> sink = {},
                           const Hardware& hardware = {});

  DiagramBuilder builder;
  SimulatedArm* arm = nullptr;             ///< if it is simulated
  HardwareArm* hardware = nullptr;         ///< if it is there
  SafetySupervisor* safety = nullptr;      ///< if there is one
  ComplianceControl* control = nullptr;    ///< if it is !Compliance
  FrictionExperiment* friction = nullptr;  ///< if it is !FrictionExperiment
  NullSpaceControl* null_space = nullptr;  ///< if it is !NullSpaceCompliance
  ContactControl* contact = nullptr;       ///< if it is !ContactControl
  ContactTorque* true_torque = nullptr;    ///< if the arm is simulated
  LivePush* live_push = nullptr;           ///< the last one of the environment, if there is one
  Duration control_period;
};

}  // namespace pliant
