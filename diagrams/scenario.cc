#include "pliant/diagrams/scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>

#include "pliant/diagrams/command_faults.h"
#include "pliant/diagrams/scenario_environment.h"
#include "pliant/diagrams/without_weight.h"
#include "pliant/plants/collision_geometry.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/delay.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/random.h"
#include "pliant/systems/recorder.h"

namespace pliant {

namespace {

/// What random numbers are for: other numbers than those of sensors and of models with errors, so
/// that all may have one seed.
enum Use : std::uint64_t { kScatter = 400 };

/// Assumed where an arm has no friction: a pace for ramps and steps [N·m], [N·m·s/rad].
constexpr double kLeastFriction = 0.1;

/// What is known of an arm by its name, or of any other by its model.
struct KnownArm {
  const char* name;
  const char* urdf;
  const char* collisions;  // which links are kept apart
  JointPosition home;      // [rad], for a station without a position
  SimulatedArm::Options (*station)(const RobotModel&, const StationOptions&);
};

const std::array<KnownArm, 3>& KnownArms() {
  constexpr double kPi = std::numbers::pi;
  static const JointPosition gen3{0, 0.2618, kPi, -2.2689, 0, 0.9599, kPi / 2};
  static const JointPosition lwr{0, 2 * kPi / 9, 0, -kPi / 2, 0, 5 * kPi / 18, 0};
  static const std::array<KnownArm, 3> all{
      {{"gen3", "gen3/gen3_7dof.urdf", "gen3/collisions.yaml", gen3, &SimulatedGen3},
       {"gen3_bota", "gen3/gen3_7dof_bota.urdf", "gen3/collisions.yaml", gen3, &SimulatedGen3},
       {"lwr", "lwr/lwr4p.urdf", "lwr/collisions.yaml", lwr, &SimulatedLwr}}};
  return all;
}

const KnownArm& ArmOf(const std::string& robot) {
  std::vector<std::string> names;
  for (const KnownArm& arm : KnownArms()) {
    if (arm.name == robot) return arm;
    names.emplace_back(arm.name);
  }
  throw Error("there is no robot '" + robot + "'" + DidYouMean(robot, names) +
              "\n  known: gen3, gen3_bota, lwr, or a file that ends in .urdf");
}

/// What `robot` is in the log of another arm.
bool IsUrdfText(const std::string& robot) { return robot.find('<') != std::string::npos; }

/// For messages.
std::string NameOf(const Scenario& scenario) {
  return IsOtherRobot(scenario.robot) ? RobotOf(scenario).name() : scenario.robot;
}

/// All joints at zero, or as near as their limits allow.
JointPosition HomeOf(const Scenario& scenario, const RobotModel& model) {
  if (!IsOtherRobot(scenario.robot)) return ArmOf(scenario.robot).home;
  return JointPosition(JointPosition::Zero(model.joints())
                           .cwiseMax(model.lower_limit())
                           .cwiseMin(model.upper_limit()));
}

SimulatedArm::Options Simulated(const Scenario& scenario, const RobotModel& model,
                                const StationOptions& options) {
  if (IsOtherRobot(scenario.robot)) return SimulatedOther(model, options);
  Require(!options.actuators,
          "station.actuators are of an arm that does not come with pliant, and "
          "robot '" +
              scenario.robot + "' has its own; leave them out");
  return ArmOf(scenario.robot).station(model, options);
}

/// Of another arm: all links that no joint connects and that are apart at home.
CollisionPairs PairsOf(const Scenario& scenario, const RobotModel& model) {
  if (!IsOtherRobot(scenario.robot))
    return CollisionPairs::Read(ModelFile(ArmOf(scenario.robot).collisions), model);
  CollisionPairs pairs;
  const CollisionGeometry all(model, pairs, {});
  RobotDynamics home(model);
  ComputeDynamics(model, HomeOf(scenario, model), JointVelocity::Zero(model.joints()), home);
  const PairDistances distances = all.Distances(home);
  const auto link = [&](int part) {
    return std::vector<std::string>{model.link(all.part(part).link).name};
  };
  for (int i = 0; i < all.size(); ++i) {
    const CollisionGeometry::Pair& pair = all.pairs()[static_cast<std::size_t>(i)];
    if (distances(i) <= 0) pairs.ignore.push_back({.links = link(pair.a), .against = link(pair.b)});
  }
  return pairs;
}

/// What a scenario says of a simulation, an arm that is there knows better.
void RequireRunnable(const Scenario& scenario) {
  const std::string on = "station !Gen3 is an arm that is there: ";
  Require(scenario.robot == "gen3" || scenario.robot == "gen3_bota",
          on + "expected robot gen3 or gen3_bota, got '" + NameOf(scenario) + "'");
  Require(scenario.environment.empty(),
          on + "it has its own environment; leave environment out, or --set environment=[]");
  Require(!scenario.payload, on + "it has its own payload; leave payload out");
  Require(scenario.position_scatter == 0, on + "it starts where it is; leave position_scatter out");
  Require(scenario.stop_when.empty(),
          on + "its supervisor brings it to rest, by the limits in safety; leave stop_when out");
  const auto* compliance = std::get_if<ComplianceControl::Options>(&scenario.controller);
  Require(!compliance || compliance->estimate != TorqueEstimate::True,
          on + "nobody knows the true torques; controller.estimate must be another than true");
}

/// Of the controller: that of the arm's interface.
Duration PeriodOf(const SimulatedArm::Options& arm) {
  return arm.interface_period == Duration{} ? arm.period : arm.interface_period;
}

/// The sensor as it is calibrated: its offset and what hangs on it are known.
WristTool WristToolOf(const RobotModel& model, const WristSensor::Options& sensor) {
  const Inertial& load = model.link(model.link_index(sensor.frame)).inertial;
  return {.frame = sensor.frame,
          .tool = {.mass = load.mass, .center = load.center, .bias = sensor.bias}};
}

/// What the controller takes the actuators for.
ArmActuators AssumedActuators(const Scenario& scenario, const SimulatedArm::Options& arm) {
  const RobotModel& model = arm.model;
  return Perturbed(
      WithFriction(arm.actuators, model.joints(), FrictionOf(scenario.assumed_friction, model)),
      scenario.model_error);
}

/// What the torque loop of a controller has to drive: nothing if the arm takes torques.
std::optional<LowLevelTorque::Options> MotorsOf(const RobotModel& assumed, const Scenario& scenario,
                                                const SimulatedArm::Options& arm) {
  if (IsIdeal(scenario) || arm.firmware.compensated) return {};
  return LowLevelTorqueOf(AssumedActuators(scenario, arm), assumed, PeriodOf(arm));
}

/// What of a controller depends on its kind.
void Complete(ComplianceControl::Options& control, const Scenario& scenario,
              const SimulatedArm::Options& arm) {
  Require(
      IsIdeal(scenario) || !arm.firmware.compensated || !(control.modes && control.modes->control),
      "modes.control switches between currents, and robot '" + NameOf(scenario) +
          "' takes torques; leave it out, or give a robot such as gen3");
  if (control.collisions && control.collisions->pairs == CollisionPairs{})
    control.collisions->pairs = PairsOf(scenario, control.model);
  if (arm.wrist) control.wrist = WristToolOf(RobotOf(scenario), *arm.wrist);
}

void Complete(FrictionExperiment::Options& control, const Scenario& scenario,
              const SimulatedArm::Options& arm) {
  Require(!arm.firmware.compensated, "!FrictionExperiment commands currents, and robot '" +
                                         NameOf(scenario) +
                                         "' takes torques: expected a robot such as gen3");
  const ArmActuators assumed = AssumedActuators(scenario, arm);
  const auto friction = [&](double FrictionParameters::*figure) {
    return FiguresOf(assumed.joint, [figure](const ActuatorParameters& p) {
      return std::max(p.friction.*figure, kLeastFriction);
    });
  };
  control.torque_per_ampere = assumed.torque_per_ampere();
  control.coulomb = friction(&FrictionParameters::coulomb);
  control.viscous = friction(&FrictionParameters::viscous);
  control.tool = control.model.links().back().name;
  Require(scenario.schedule.empty(),
          "schedule must be empty: !FrictionExperiment commands currents all along");
  const double length = FrictionExperiment::LengthOf(control);
  Require(scenario.duration_s >= length,
          "duration_s must be >= " + Text(std::ceil(length)) +
              " s for the joints and speeds of !FrictionExperiment",
          scenario.duration_s);
}

void Complete(NullSpaceControl::Options& control, const Scenario& scenario,
              const SimulatedArm::Options& arm) {
  control.coulomb = FiguresOf(AssumedActuators(scenario, arm).joint,
                              [](const ActuatorParameters& p) { return p.friction.coulomb; });
}

/// How contacts are seen; null if they are not.
const SeenContacts* SightOf(const ArmController& controller) {
  const ContactSettings* settings = nullptr;
  if (const auto* contact = std::get_if<ContactControl::Options>(&controller))
    settings = &contact->contact;
  const auto* compliance = std::get_if<ComplianceControl::Options>(&controller);
  if (compliance && compliance->contacts) settings = &*compliance->contacts;
  return settings ? std::get_if<SeenContacts>(&settings->localization) : nullptr;
}

void Complete(ContactControl::Options&, const Scenario&, const SimulatedArm::Options&) {}

/// The mode of the arm that a controller is made for.
ControlMode TorqueMode(const std::optional<LowLevelTorque::Options>& motors) {
  return motors ? ControlMode::Current : ControlMode::Torque;
}
ControlMode ModeOf(const ComplianceControl::Options& control) {
  return control.command == ArmCommand::Position ? ControlMode::Position
                                                 : TorqueMode(control.low_level);
}
ControlMode ModeOf(const FrictionExperiment::Options&) { return ControlMode::Current; }
ControlMode ModeOf(const NullSpaceControl::Options& control) {
  return TorqueMode(control.low_level);
}
ControlMode ModeOf(const ContactControl::Options& control) { return TorqueMode(control.low_level); }

/// What of contacts is.
void Append(std::vector<const internal::Value*>& values, const ContactTasks& tasks) {
  values.insert(values.end(),
                {&tasks.residual, &tasks.touched, &tasks.link, &tasks.external_torque,
                 &tasks.contacts, &tasks.observability, &tasks.sight, &tasks.place_error});
  for (const ContactPlace* place : tasks.places)
    values.insert(values.end(),
                  {&place->error, &place->velocity, &place->force, &place->force_error,
                   &place->observed_error, &place->wanted, &place->status});
}

/// What of a controller is worth a place in the log.
std::vector<const internal::Value*> RecordedOf(const ComplianceControl& control,
                                               const ComplianceControl::Options& o) {
  std::vector<const internal::Value*> values{
      &control.torque,        &control.current,  &control.torque_error, &control.saturated,
      &control.target,        &control.position, &control.acceleration, &control.external_torque,
      &control.residual,      &control.contact,  &control.pose_error,   &control.pose_error_rate,
      &control.posture_error, &control.report};
  if (o.collisions) values.push_back(&control.distance);
  if (o.door) values.push_back(&control.door);
  if (o.modes) values.push_back(&control.yields);
  if (o.contacts) Append(values, *control.contact_tasks);
  if (o.modes && o.modes->control)
    values.insert(values.end(), {&control.arm_mode, &control.arm_control, &control.braking});
  return values;
}
std::vector<const internal::Value*> RecordedOf(const FrictionExperiment& control,
                                               const FrictionExperiment::Options&) {
  return {&control.current,       &control.torque,          &control.reference,
          &control.break_away_up, &control.break_away_down, &control.report};
}
std::vector<const internal::Value*> RecordedOf(const NullSpaceControl& control,
                                               const NullSpaceControl::Options&) {
  return {&control.torque,          &control.current,     &control.torque_error,
          &control.saturated,       &control.tool_torque, &control.null_space_torque,
          &control.external_torque, &control.desired,     &control.velocity_error,
          &control.target,          &control.path_error,  &control.orientation_error,
          &control.storage,         &control.supply,      &control.excess,
          &control.least_singular,  &control.fallback};
}

std::vector<const internal::Value*> RecordedOf(const ContactControl& control,
                                               const ContactControl::Options&) {
  std::vector<const internal::Value*> values{&control.torque,       &control.current,
                                             &control.torque_error, &control.saturated,
                                             &control.acceleration, &control.report};
  Append(values, *control.contact_tasks);
  return values;
}

/// Where the tool is, whatever the controller thinks.
class ToolMotion final : public Block {
 public:
  explicit ToolMotion(const Joints& joints) : motion{this, "motion", joints} {
    Compute(position).From(motion).As(
        [](const RobotDynamics& d) { return Position(d.frame[0].pose.position); });
    Compute(pose).From(motion).As([](const RobotDynamics& d) { return d.frame[0].pose; });
    Compute(twist).From(motion).As([](const RobotDynamics& d) { return d.frame[0].twist; });
  }
  Input<RobotDynamics> motion;
  Output<Position> position{this, "position"};
  Output<Pose> pose{this, "pose"};
  Output<Twist> twist{this, "twist"};
};

}  // namespace

bool IsOtherRobot(const std::string& robot) {
  return IsUrdfText(robot) || robot.ends_with(".urdf");
}

std::filesystem::path UrdfOf(const std::string& robot) { return ModelFile(ArmOf(robot).urdf); }

RobotModel RobotOf(const Scenario& scenario) {
  if (IsUrdfText(scenario.robot)) return RobotModel::FromUrdfText(scenario.robot, "robot");
  return RobotModel::FromUrdf(IsOtherRobot(scenario.robot) ? std::filesystem::path(scenario.robot)
                                                           : UrdfOf(scenario.robot));
}

std::string UrdfTextOf(const Scenario& scenario) {
  if (IsUrdfText(scenario.robot)) return scenario.robot;
  return ParameterFile::TextOf(IsOtherRobot(scenario.robot) ? std::filesystem::path(scenario.robot)
                                                            : UrdfOf(scenario.robot));
}

bool IsHardware(const Scenario& scenario) {
  return std::holds_alternative<Gen3Station>(scenario.station);
}

bool IsIdeal(const Scenario& scenario) {
  const auto* simulated = std::get_if<StationOptions>(&scenario.station);
  return simulated && (simulated->ideal || (IsOtherRobot(scenario.robot) && !simulated->actuators));
}

SimulatedArm::Options StationOf(const Scenario& scenario) {
  RobotModel model = RobotOf(scenario);
  StationOptions options;
  if (const auto* simulated = std::get_if<StationOptions>(&scenario.station)) options = *simulated;
  if (const auto* gen3 = std::get_if<Gen3Station>(&scenario.station)) {
    RequireRunnable(scenario);
    options.position = gen3->position;
    options.friction = gen3->friction;
  }
  if (options.position.size() == 0) options.position = HomeOf(scenario, model);
  const RandomStream scatter = RandomStream(scenario.seed).Part(kScatter);
  for (Eigen::Index j = 0; j < options.position.size(); ++j)
    options.position(j) +=
        scenario.position_scatter * scatter.Normal(static_cast<std::uint64_t>(j));
  options.seed = scenario.seed;
  if (scenario.payload) {
    const Payload& ball = *scenario.payload;
    const double inertia = 0.4 * ball.mass * ball.radius * ball.radius;
    model = model.WithPayload(ball.link, {.mass = ball.mass,
                                          .center = ball.center,
                                          .inertia = inertia * Eigen::Matrix3d::Identity()});
  }
  SimulatedArm::Options station = Simulated(scenario, model, options);
  if (IsHardware(scenario) && station.wrist) station.wrist->bias.setZero();  // taken off by a tare
  return station;
}

const ComplianceControl::Options& ComplianceOf(const ArmController& controller) {
  return std::visit(
      [](const auto& of) -> const ComplianceControl::Options& {
        if constexpr (std::is_same_v<decltype(of), const ComplianceControl::Options&>)
          return of;
        else
          throw Error("it is about a controller of the kind !Compliance, got !" +
                      std::string(of.kTag));
      },
      controller);
}

const RobotModel& ModelOf(const ArmController& controller) {
  return std::visit([](const auto& of) -> const RobotModel& { return of.model; }, controller);
}

const std::string& ToolOf(const ArmController& controller) {
  return std::visit([](const auto& of) -> const std::string& { return of.tool; }, controller);
}

Duration PeriodOf(const ArmController& controller) {
  return std::visit([](const auto& of) { return of.period; }, controller);
}

ArmController ControllerOf(const Scenario& scenario, const SimulatedArm::Options& arm) {
  ArmController controller = scenario.controller;
  std::visit(
      [&](auto& control) {
        control.model = Perturbed(RobotOf(scenario), scenario.model_error);
        control.position = arm.position;
        control.rotor_inertia = arm.actuators.reflected_inertia();
        control.period = PeriodOf(arm);
        if constexpr (requires { control.low_level; }) {
          control.low_level = MotorsOf(control.model, scenario, arm);
          constexpr bool compensates = requires { control.coulomb; };
          Require(control.low_level || compensates || scenario.assumed_friction.empty(),
                  "assumed_friction is of the loop that makes currents of torques, and this arm "
                  "takes torques; leave it out, or give a robot such as gen3 and a station that is "
                  "not ideal");
        }
        Complete(control, scenario, arm);
      },
      controller);
  return controller;
}

Duration ControlPeriodOf(const Scenario& scenario) { return PeriodOf(StationOf(scenario)); }

Duration LogPeriodOf(const Scenario& scenario) {
  return scenario.log_period.value_or(ControlPeriodOf(scenario));
}

std::vector<AnyInputs*> internal::AddWatchers(DiagramBuilder& b, const Scenario& scenario,
                                              Duration control_period,
                                              std::shared_ptr<RecordSink> sink) {
  std::vector<AnyInputs*> watching;
  if (sink)
    watching.push_back(
        &b.Add<Recorder>("recorder", {.period = scenario.log_period.value_or(control_period),
                                      .sink = std::move(sink)})
             .in);
  for (std::size_t i = 0; i < scenario.stop_when.size(); ++i) {
    StopWhen::Options stop = scenario.stop_when[i];
    stop.period = control_period;
    watching.push_back(&b.Add<StopWhen>("stop_when_" + std::to_string(i + 1), stop).in);
  }
  return watching;
}

std::vector<Push::Options> PushesOf(const Scenario& scenario) {
  std::vector<Push::Options> pushes;
  for (const EnvironmentPart& part : scenario.environment)
    if (const auto* push = std::get_if<Push::Options>(&part)) pushes.push_back(*push);
  return pushes;
}

ScenarioDiagram::ScenarioDiagram(const Scenario& scenario, std::shared_ptr<RecordSink> sink,
                                 const Hardware& of) {
  RequireInRange("", scenario);
  SimulatedArm::Options station = StationOf(scenario);
  const ArmController controller = ControllerOf(scenario, station);
  const auto* compliance = std::get_if<ComplianceControl::Options>(&controller);
  const bool is_there = IsHardware(scenario);
  const bool switches = compliance && compliance->modes && compliance->modes->control;
  Require(!switches || scenario.schedule.empty(),
          "controller.modes.control says what mode the arm is in; expected no schedule beside it");
  station.frames = {ToolOf(controller)};
  const Duration period = control_period = PeriodOf(controller);

  // The plant's model at what the sensors say: contacts push the arm that is there.
  DiagramBuilder& b = builder;
  auto& link_motion = b.Add<ModelDynamics>(
      "link_motion",
      {.model = station.model, .frames = is_there ? station.frames : std::vector<std::string>()});
  std::optional<internal::Environment> environment;
  DepthCamera* camera = nullptr;
  if (is_there) {
    Require(!SightOf(controller),
            "station !Gen3 has no camera: controller.contacts.localization "
            "must be another than !DepthCamera");
    hardware =
        &b.Add<HardwareArm>("arm", {.model = station.model,
                                    .position = station.position,
                                    .wrist_frame = station.wrist ? station.wrist->frame : "",
                                    .wrist_range = station.wrist ? station.wrist->range : Wrench(),
                                    .hardware = of,
                                    .period = period});
  } else {
    true_torque = &b.Add<ContactTorque>("true_torque", {.model = station.model});
    arm = &b.Add<SimulatedArm>("arm", station);
    environment.emplace(b, *arm, *true_torque, station.model, period);
    for (const EnvironmentPart& part : scenario.environment) std::visit(*environment, part);
    live_push = environment->live_push;
    b.Connect(link_motion.dynamics, true_torque->dynamics);
    if (const SeenContacts* seen = SightOf(controller)) {
      camera = &b.Add<DepthCamera>("camera", CameraOf(*seen, station.model, scenario.seed));
      b.Connect(arm->position, camera->position);
      for (const Output<ContactForce>* touch : environment->contacts)
        b.Connect(*touch, camera->contacts);
    }
  }
  TickTimer* timer = nullptr;
  Operator* watcher = nullptr;
  CommandFaults* drill = nullptr;
  if (scenario.safety || is_there) {
    const ArmActuators assumed = AssumedActuators(scenario, station);
    safety = &b.Add<SafetySupervisor>(
        "safety", {.model = ModelOf(controller),
                   .position = station.position,
                   .torque_per_ampere = assumed.torque_per_ampere(),
                   .current_limit = FiguresOf(assumed.joint, &ActuatorParameters::current_limit),
                   .settings = scenario.safety.value_or(SafetySupervisor::Settings()),
                   .period = period});
    timer = &b.Add<TickTimer>("timer", {.times = of.times, .period = period});
    watcher =
        &b.Add<Operator>("operator", {.panel = of.panel,
                                      .stop_at_s = is_there ? scenario.duration_s : kUnbounded,
                                      .period = period});
    if (!of.faults.empty())
      drill = &b.Add<CommandFaults>(
          "drill", {.model = ModelOf(controller),
                    .position = station.position,
                    .current_limit = FiguresOf(assumed.joint, &ActuatorParameters::current_limit),
                    .faults = of.faults,
                    .period = period});
  }
  // A simulated arm, one that is there and a supervisor have the same ports.
  const auto with_arm = [&](const auto& act) {
    if (arm)
      act(*arm);
    else
      act(*hardware);
  };
  const auto with_commanded = [&](const auto& act) {
    if (drill)
      act(*drill);
    else if (safety)
      act(*safety);
    else
      with_arm(act);
  };

  // Of the whole torque, what is left to command.
  const auto command_torque = [&](const Output<JointTorque>& torque) {
    with_arm([&](auto& to) {
      if (!station.firmware.compensated) {
        b.Connect(torque, to.torque_command);
        return;
      }
      auto& assumed = b.Add<ModelDynamics>("assumed_motion", {.model = ModelOf(controller)});
      auto& carried = b.Add<internal::WithoutWeight>("carried", station.model.joints());
      b.Connect(to.measured_position, assumed.position);
      b.Connect(to.measured_velocity, assumed.velocity);
      b.Connect(torque, carried.torque);
      b.Connect(assumed.dynamics, carried.dynamics);
      b.Connect(carried.command, to.torque_command);
    });
  };

  std::vector<const internal::Value*> recorded;
  const auto add = [&]<class Controller>(Controller*& added) {
    const auto* options = std::get_if<typename Controller::Options>(&controller);
    if (!options) return;
    Controller& to = b.Add<Controller>("control", *options);
    added = &to;
    recorded = RecordedOf(to, *options);
    with_arm([&](auto& from) {
      b.Connect(from.measured_position, to.measured_position);
      b.Connect(from.measured_velocity, to.measured_velocity);
      b.Connect(from.measured_torque, to.measured_torque);
      if constexpr (requires { to.wrench; }) b.Connect(from.wrench, to.wrench);
      if constexpr (requires { to.wrench_valid; }) b.Connect(from.wrench_valid, to.wrench_valid);
      if constexpr (requires { from.temperature, to.temperature; })
        b.Connect(from.temperature, to.temperature);
    });
    with_commanded([&](auto& by) { b.Connect(to.current, by.current_command); });
    const auto watch = [&](auto& by) {
      b.Connect(to.torque, by.torque_command);
      if constexpr (requires { to.external_torque; })
        b.Connect(to.external_torque, by.external_torque);
    };
    if (drill)
      watch(*drill);
    else if (safety)
      watch(*safety);
    else
      command_torque(to.torque);
    if (is_there) return;
    if constexpr (requires { to.true_torque; }) b.Connect(true_torque->torque, to.true_torque);
    if constexpr (requires { to.contacts; })
      for (const Output<ContactForce>* touch : environment->contacts)
        b.Connect(*touch, to.contacts);
    if constexpr (requires { to.image; })
      if (camera) b.Connect(camera->image, *to.image);
  };
  add(control);
  add(friction);
  add(null_space);
  add(contact);
  auto& tool = b.Add<ToolMotion>("tool", station.model.joints());
  ModeSchedule* schedule = nullptr;
  if (!switches)
    schedule = &b.Add<ModeSchedule>(
        "schedule", {.first = std::visit([](const auto& o) { return ModeOf(o); }, controller),
                     .changes = scenario.schedule,
                     .period = period});

  with_arm([&](auto& from) {
    b.Connect(from.measured_position, link_motion.position);
    b.Connect(from.measured_velocity, link_motion.velocity);
    if (switches) b.Connect(from.measured_current, control->measured_current);
  });
  b.Connect(is_there ? link_motion.dynamics : arm->motion, tool.motion);
  // Always, or now and then.
  const bool commands_positions =
      switches || (control && compliance->command == ArmCommand::Position);
  with_commanded([&](auto& by) {
    if (commands_positions)
      b.Connect(control->position, by.position_command);  // else it holds its start
  });
  Delay<bool>* held = nullptr;
  if (commands_positions && safety) {
    held = &b.Add<Delay<bool>>("held", {.period = period});
    b.Connect(safety->has_arm, held->u);
    b.Connect(held->y, control->held);
  }
  const Output<ControlMode>& mode = switches ? control->arm_mode : schedule->mode;
  if (safety)
    b.Connect(mode, safety->mode);
  else
    with_arm([&](auto& by) { b.Connect(mode, by.mode); });
  if (drill) {
    b.Connect(drill->spoilt_position, safety->position_command);
    b.Connect(drill->spoilt_torque, safety->torque_command);
    b.Connect(drill->spoilt_current, safety->current_command);
    b.Connect(drill->spoilt_estimate, safety->external_torque);
    b.Connect(timer->timing, drill->timing);
  }
  if (safety) {
    with_arm([&](auto& of_arm) {
      b.Connect(of_arm.measured_position, safety->measured_position);
      b.Connect(of_arm.measured_velocity, safety->measured_velocity);
      b.Connect(of_arm.measured_torque, safety->measured_torque);
      b.Connect(of_arm.status, safety->status);
      if constexpr (requires { of_arm.temperature; })
        b.Connect(of_arm.temperature, safety->temperature);
      b.Connect(drill ? drill->spoilt_timing : timer->timing, safety->timing);
      b.Connect(watcher->word, safety->word);
      b.Connect(safety->report, watcher->report);
      b.Connect(safety->arm_mode, of_arm.mode);
      b.Connect(safety->arm_position, of_arm.position_command);
      b.Connect(safety->arm_current, of_arm.current_command);
    });
    command_torque(safety->arm_torque);
  }

  const std::vector<AnyInputs*> watching = internal::AddWatchers(b, scenario, period, sink);
  const auto record = [&](const auto&... values) {
    for (AnyInputs* in : watching) (b.Connect(values, *in), ...);
  };
  if (environment)
    for (const internal::Value* value : environment->recorded) record(*value);
  with_arm([&](auto& from) {
    record(from.measured_position, from.measured_velocity, from.measured_torque,
           from.measured_current, from.wrench, from.wrench_valid, from.status);
  });
  if (arm) record(arm->position, arm->velocity, arm->joint_torque, arm->energy);
  if (hardware) record(hardware->temperature, hardware->wrench_status, hardware->report);
  record(tool.position, tool.pose, tool.twist);
  if (true_torque) record(true_torque->torque);
  if (schedule) record(schedule->mode);
  if (safety)
    record(safety->report, safety->arm_mode, safety->arm_position, safety->arm_torque,
           safety->arm_current, timer->timing, watcher->word);
  if (held) record(held->y);
  if (drill)
    record(drill->spoilt_position, drill->spoilt_torque, drill->spoilt_current,
           drill->spoilt_estimate, drill->spoilt_timing);
  for (const internal::Value* value : recorded) record(*value);
}

}  // namespace pliant
