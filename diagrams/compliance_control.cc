#include "pliant/diagrams/compliance_control.h"

#include <algorithm>

#include "pliant/controllers/current_fade.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/pad_modes.h"
#include "pliant/controllers/pad_player.h"
#include "pliant/controllers/position_reference.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/controllers/torque_error.h"
#include "pliant/controllers/torque_to_current.h"
#include "pliant/diagrams/torque_actuation.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/switch.h"

namespace pliant {

namespace {

/// A task's error and its rate as what they are of a pose.
class PoseErrors final : public Block {
 public:
  PoseErrors() {
    Compute(error).From(task_error).As([](const TaskVector& e) { return PoseError(e); });
    Compute(rate).From(task_error_rate).As([](const TaskVector& e) { return Twist(e); });
  }
  Input<TaskVector> task_error{this, "task_error"};
  Input<TaskVector> task_error_rate{this, "task_error_rate"};
  Output<PoseError> error{this, "error"};
  Output<Twist> rate{this, "rate"};
};

/// The mode over time.
class ComplianceSchedule final : public Block {
 public:
  struct Options {
    SupervisedModes modes;
    Duration period;
  };

  explicit ComplianceSchedule(const Options& o)
      : mode{this, "mode", {}, o.modes.mode},
        dynamic{this, "dynamic", {}, o.modes.dynamic},
        control{this, "control", {}, o.modes.control.value_or(ArmControl::ProposedTorque)},
        now_{this, "now"} {
    const std::vector<ComplianceChange>& changes = o.modes.changes;
    modes_.push_back(
        {-kUnbounded,
         {o.modes.mode, o.modes.dynamic, o.modes.control.value_or(ArmControl::ProposedTorque)}});
    for (const ComplianceChange& change : changes) {
      const Begins& last = modes_.back();
      Require(last.at_s < change.at_s, "each mode begins after the one before it",
              Text(change.at_s) + " s behind " + Text(last.at_s) + " s");
      modes_.push_back(
          {change.at_s,
           {change.mode.value_or(last.now.mode), change.dynamic.value_or(last.now.dynamic),
            change.control.value_or(last.now.control)}});
    }
    Every(o.period).Compute(now_).From(clock).As(&ComplianceSchedule::At);
    Compute(mode).From(now_).As([](const Now& n) { return n.mode; });
    Compute(dynamic).From(now_).As([](const Now& n) { return n.dynamic; });
    Compute(control).From(now_).As([](const Now& n) { return n.control; });
  }

  Output<ComplianceMode> mode;
  Output<bool> dynamic;
  Output<ArmControl> control;

 private:
  struct Now {
    ComplianceMode mode = ComplianceMode::NullSpace;
    bool dynamic = false;
    ArmControl control = ArmControl::ProposedTorque;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("mode", mode, "");
      f("dynamic", dynamic, "");
      f("control", control, "");
    }
  };
  struct Begins {
    double at_s;
    Now now;
  };

  Now At(double t) const {
    return std::prev(std::ranges::upper_bound(modes_, t, {}, &Begins::at_s))->now;
  }

  std::vector<Begins> modes_;
  Output<Now> now_;
};

/// Whether an arm is ever to be moved through Kinova's loop.
bool WantsKinova(const SupervisedModes& modes) {
  return modes.control == ArmControl::KinovaTorque || (modes.control && modes.pad) ||
         std::ranges::any_of(modes.changes, [](const ComplianceChange& change) {
           return change.control == ArmControl::KinovaTorque;
         });
}

void RequireSwitches(const ComplianceControl::Options& o) {
  const SupervisedModes& modes = *o.modes;
  Require(!modes.pad || modes.changes.empty(),
          "modes.pad says what is wanted; expected no modes.changes beside it");
  if (!modes.control) {
    Require(std::ranges::none_of(modes.changes, &std::optional<ArmControl>::has_value,
                                 &ComplianceChange::control),
            "modes.control must be given where a change of modes has a control: what moves the arm "
            "at the start");
    return;
  }
  Require(o.command == ArmCommand::Torque,
          "modes.control says what moves the arm; expected no command beside it");
  Require(std::holds_alternative<ProposedTorqueLoop>(o.torque_loop),
          "modes.control changes between torque_loop and modes.kinova_loop, so torque_loop must be "
          "!Proposed");
  Require(!o.low_level || modes.kinova_loop || !WantsKinova(modes),
          "modes.kinova_loop must be given for the control kinova_torque: its gains are not "
          "published");
}

/// Whether an arm is moved by a given control.
class Moves final : public Block {
 public:
  struct Options {
    ArmControl control;
  };

  explicit Moves(const Options& o) : control_{o.control} {
    Compute(y).From(control).As(&Moves::Is);
  }

  Input<ArmControl> control{this, "control"};
  Output<bool> y{this, "y"};

 private:
  bool Is(ArmControl now) const { return now == control_; }

  const ArmControl control_;
};

/// A number for all joints, or one for each.
PerJoint ForEachJoint(const std::string& name, const JointMatrix& given, int n) {
  if (given.size() <= 1) return PerJoint::Constant(n, given.size() == 0 ? 0 : given(0, 0));
  Require(given.cols() == 1 && given.rows() == n,
          "posture." + name + " must be a number or one for each of the " + Text(n) + " joints",
          Text(given.rows()) + " x " + Text(given.cols()));
  return given.col(0);
}

Pose Behind(const Pose& start, const Pose& relative) {
  return {start.position + relative.position, relative.rotation * start.rotation};
}

/// A reference with its poses in the world.
PoseWaypoints::Options InWorld(const Pose& start, PoseWaypoints::Options o) {
  for (TimedPose& row : o.waypoints) row.pose = Behind(start, row.pose);
  return o;
}
PoseTable::Options InWorld(const Pose& start, PoseTable::Options o) {
  for (TimedPose& row : o.rows) row.pose = Behind(start, row.pose);
  return o;
}
PoseSwing::Options InWorld(const Pose& start, PoseSwing::Options o) {
  o.start = Behind(start, o.start);
  return o;
}
PoseCircle::Options InWorld(const Pose& start, PoseCircle::Options o) {
  o.start = Behind(start, o.start);
  o.center += start.position;
  return o;
}

/// The block of options: the class they are nested in.
template <class Block, class... Blocks>
struct BlockOf {
  template <class Options>
  using type = std::conditional_t<std::is_same_v<Options, typename Block::Options>, Block,
                                  typename BlockOf<Blocks...>::template type<Options>>;
};
template <class Block>
struct BlockOf<Block> {
  template <class Options>
  using type = Block;
};

JointBits ContinuousJointsOf(const RobotModel& model) {
  JointBits bits = 0;
  for (int j = 0; j < model.size(); ++j)
    if (model.joint(j).type == Joint::Type::Continuous) bits |= JointBits{1} << j;
  return bits;
}

PairNames PairsOf(const ComplianceControl::Options& o) {
  if (!o.collisions) return {};
  return CollisionGeometry(o.model, o.collisions->pairs, o.collisions->obstacles).names();
}

}  // namespace

ComplianceControl::ComplianceControl(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      true_torque{this, "true_torque", o.model.joints(), JointTorque::Zero(o.model.joints())},
      wrench{this, "wrench", {}, Wrench()},
      wrench_valid{this, "wrench_valid", {}, true},
      held{this, "held", {}, false},
      measured_current{this, "measured_current", o.model.joints(),
                       MotorCurrent::Zero(o.model.joints())},
      contacts{this, "contacts"},
      torque{this, "torque", o.model.joints()},
      current{this, "current", o.model.joints()},
      torque_error{this, "torque_error", o.model.joints()},
      saturated{this, "saturated"},
      position{this, "position", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      external_torque{this, "external_torque", o.model.joints()},
      residual{this, "residual", o.model.joints()},
      contact{this, "contact"},
      yields{this, "yields"},
      arm_control{this, "arm_control"},
      arm_mode{this, "arm_mode"},
      braking{this, "braking"},
      distance{this, "distance", PairsOf(o)},
      door{this, "door"},
      target{this, "target"},
      pose_error{this, "pose_error"},
      pose_error_rate{this, "pose_error_rate"},
      posture_error{this, "posture_error", o.model.joints()},
      report{this, "report"} {
  const Joints& joints = o.model.joints();
  const int n = o.model.size();
  const bool open_loop = o.command == ArmCommand::Position;
  const bool switches = o.modes && o.modes->control;
  RequireInRange("", o);
  Require(o.pose.weight > 0 || !(o.modes || o.reference || o.door),
          "modes, reference and door move the tool, so pose.weight must be > 0", o.pose.weight);
  Require(!o.door || o.pose.mobility.size() == 0,
          "the door gives the pose its mobility; expected none of pose.mobility");
  RequireOneForEach(joints, "position", o.position.size());
  if (o.modes) RequireSwitches(o);
  RobotDynamics start(o.model, {o.tool});
  ComputeDynamics(o.model, o.position, JointVelocity::Zero(joints), start);

  auto& dynamics =
      Add<ModelDynamics>("dynamics", {.model = o.model, .rotor_inertia = o.rotor_inertia});
  auto& estimate = Add<ExternalTorqueEstimate>("estimate", {.model = o.model,
                                                            .rotor_inertia = o.rotor_inertia,
                                                            .period = o.period,
                                                            .estimate = o.estimate,
                                                            .gain = o.observer_gain,
                                                            .rate = o.observer_rate,
                                                            .wrist = o.wrist});
  auto& external = Add<ExternalAcceleration>("external", {.joints = joints});
  auto& pose = Add<FrameTask>("pose", {.model = o.model,
                                       .frame = o.tool,
                                       .target = start.frame[0].pose,
                                       .stiffness = TaskVector::Constant(6, o.pose.stiffness),
                                       .damping = TaskVector::Constant(6, o.pose.damping),
                                       .weight = o.pose.weight > 0 ? o.pose.weight : 1,
                                       .compliance = o.pose.compliance,
                                       .mobility = o.pose.mobility,
                                       .compliance_axes = o.pose.compliance_axes,
                                       .inertia_limit = o.door ? o.door->inertia_limit : 200});
  auto& posture =
      Add<PostureTask>("posture", {.model = o.model,
                                   .target = o.position,
                                   .stiffness = ForEachJoint("stiffness", o.posture.stiffness, n),
                                   .damping = ForEachJoint("damping", o.posture.damping, n),
                                   .weight = o.posture.weight,
                                   .compliance = o.posture.compliance});
  JointDamper::Options joint_limits = o.damper;
  joint_limits.model = o.model;
  auto& damper = Add<JointDamper>("damper", joint_limits);

  // Everything that adds rows, and how many.
  std::vector<const Output<AccelerationRows>*> rows;
  int row_count = 0;
  const auto add_limit = [&]<class Limit>(const std::string& name, typename Limit::Options options,
                                          int count, std::type_identity<Limit>) -> Limit& {
    options.model = o.model;
    auto& limit = Add<Limit>(name, options);
    Connect(dynamics.dynamics, limit.dynamics);
    rows.push_back(&limit.rows);
    row_count += count;
    return limit;
  };
  if (o.collisions)
    Connect(add_limit("collisions", *o.collisions, PairsOf(o).size(),
                      std::type_identity<CollisionDamper>{})
                .distance,
            distance);
  else
    Connect(Add<Constant<PairDistances>>("collisions", {.space = {}, .value = PairDistances()}).y,
            distance);
  for (std::size_t i = 0; i < o.workspace.size(); ++i)
    add_limit("workspace_" + std::to_string(i + 1), o.workspace[i],
              static_cast<int>(o.workspace[i].planes.size()),
              std::type_identity<WorkspacePlanes>{});
  if (o.speed_limit)
    add_limit("speed_limit", *o.speed_limit, FrameSpeedLimit::kRows,
              std::type_identity<FrameSpeedLimit>{});
  if (o.force_limit) {
    Require(o.wrist && o.wrist->frame == o.force_limit->frame,
            "force_limit.frame must be the frame of a wrist sensor" +
                (o.wrist ? ", '" + o.wrist->frame + "'" : "; this robot has none"),
            "'" + o.force_limit->frame + "'");
    Connect(estimate.contact,
            add_limit("force_limit", *o.force_limit, 1, std::type_identity<ForceLimit>{}).contact);
  }
  auto& qp = Add<ComplianceQp>("qp", {.model = o.model, .period = o.period, .rows = row_count});

  PositionReference* moved = nullptr;
  if (open_loop || switches) {
    auto& measured = Add<ModelDynamics>("measured_dynamics",
                                        {.model = o.model, .rotor_inertia = o.rotor_inertia});
    auto& reference = Add<PositionReference>(
        "reference", {.joints = joints, .start = o.position, .period = o.period});
    Connect(measured_position, measured.position);
    Connect(measured_velocity, measured.velocity);
    Connect(measured.dynamics, estimate.dynamics);
    Connect(qp.acceleration, reference.acceleration);
    Connect(reference.position, dynamics.position);
    Connect(reference.velocity, dynamics.velocity);
    Connect(reference.position, position);
    Connect(measured_position, reference.measured_position);
    Connect(measured_velocity, reference.measured_velocity);
    if (!switches && !o.reference && !o.door) Connect(held, reference.follow);
    moved = &reference;
  } else {
    Connect(measured_position, dynamics.position);
    Connect(measured_velocity, dynamics.velocity);
    Connect(dynamics.dynamics, estimate.dynamics);
    Connect(measured_position, position);
  }
  Connect(measured_torque, estimate.torque);
  Connect(true_torque, estimate.true_torque);
  Connect(wrench, estimate.wrench);
  Connect(wrench_valid, estimate.wrench_valid);
  Connect(dynamics.dynamics, external.dynamics);
  Connect(dynamics.dynamics, pose.dynamics);
  Connect(dynamics.dynamics, posture.dynamics);
  Connect(dynamics.dynamics, damper.dynamics);
  Connect(dynamics.dynamics, qp.dynamics);
  const Output<JointTorque>* known = &estimate.external_torque;
  if (o.contacts) {
    Require(o.estimate == TorqueEstimate::Observer || o.estimate == TorqueEstimate::SuperTwisting,
            "contacts are found by the residual of an observer, so estimate must be observer or "
            "super_twisting");
    Require(!open_loop && !switches,
            "contacts are of an arm that is commanded torques; expected the command torque and no "
            "modes.control");
    auto& tasks = Add<ContactTasks>("tasks", {.model = o.model,
                                              .period = o.period,
                                              .settings = *o.contacts,
                                              .weight = o.contact_weight});
    Connect(dynamics.dynamics, tasks.dynamics);
    Connect(estimate.residual, tasks.raw_residual);
    Connect(contacts, tasks.forces);
    if (tasks.image) {
      image.emplace(this, "image");
      Connect(*image, *tasks.image);
    }
    for (const Output<Objective>& objective : tasks.objectives) Connect(objective, qp.objectives);
    known = &tasks.residual;
    contact_tasks = &tasks;
  }
  Connect(*known, external_torque);
  if (o.estimate != TorqueEstimate::Zero) {
    Connect(*known, external.external_torque);
    Connect(*known, qp.external_torque);
    Connect(external.acceleration, pose.external_acceleration);
    Connect(external.acceleration, posture.external_acceleration);
  }
  if (o.pose.weight > 0) Connect(pose.objective, qp.objectives);
  Connect(posture.objective, qp.objectives);
  Connect(damper.bounds, qp.bounds);
  for (const Output<AccelerationRows>* limit : rows) Connect(*limit, qp.rows);

  // Where the tool is to be, for the pose task and for who looks on.
  const auto aim = [&](const Output<Pose>& at) {
    Connect(at, pose.target);
    Connect(at, target);
  };
  ControlSupervisor* chooses = nullptr;
  if (o.modes) {
    ComplianceSupervisor::Options modes = o.modes->supervisor;
    modes.joints = n;
    modes.period = o.period;
    auto& supervisor = Add<ComplianceSupervisor>("supervisor", modes);
    const Output<ArmControl>* wanted = nullptr;
    const ArmControl first = o.modes->control.value_or(ArmControl::ProposedTorque);
    const auto follow_wishes = [&](const auto& person) {
      Connect(person.mode, supervisor.mode);
      Connect(person.dynamic, supervisor.dynamic);
      wanted = &person.control;
    };
    if (o.modes->pad) {
      auto& pad = Add<PadPlayer>("pad", {.recording = *o.modes->pad, .period = o.period});
      auto& person = Add<PadModes>("wanted", {.mode = o.modes->mode,
                                              .dynamic = o.modes->dynamic,
                                              .control = first,
                                              .period = o.period});
      Connect(pad.state, person.pad);
      follow_wishes(person);
    } else if (o.modes->changes.empty()) {
      Connect(wanted_mode.emplace(this, "wanted_mode", Nothing(), o.modes->mode), supervisor.mode);
      Connect(wanted_dynamic.emplace(this, "wanted_dynamic", Nothing(), o.modes->dynamic),
              supervisor.dynamic);
      if (switches) wanted_control.emplace(this, "wanted_control", Nothing(), first);
    } else {
      follow_wishes(Add<ComplianceSchedule>("schedule", {.modes = *o.modes, .period = o.period}));
    }
    Connect(estimate.contact, supervisor.contact);
    Connect(pose.frame, supervisor.tool);
    aim(supervisor.target);
    Connect(supervisor.target_twist, pose.target_twist);
    Connect(supervisor.target_acceleration, pose.target_acceleration);
    Connect(supervisor.pose_stiffness, pose.stiffness);
    Connect(supervisor.pose_damping, pose.damping);
    Connect(supervisor.pose_compliance, pose.compliance);
    Connect(supervisor.posture_stiffness, posture.stiffness);
    Connect(supervisor.posture_damping, posture.damping);
    Connect(supervisor.posture_compliance, posture.compliance);
    Connect(supervisor.yields, yields);
    if (!switches) {
      Connect(held, supervisor.brakes);
    } else {
      auto& control = Add<ControlSupervisor>("control", {.joints = joints,
                                                         .start = o.position,
                                                         .first = *o.modes->control,
                                                         .settings = o.modes->switching,
                                                         .continuous = ContinuousJointsOf(o.model),
                                                         .period = o.period});
      if (wanted)
        Connect(*wanted, control.wanted);
      else
        Connect(*wanted_control, control.wanted);
      Connect(moved->open, control.reference);
      Connect(measured_position, control.measured_position);
      Connect(measured_velocity, control.measured_velocity);
      Connect(held, control.held);
      Connect(control.braking, supervisor.brakes);
      Connect(control.follow, moved->follow);
      Connect(control.posture, posture.target);
      Connect(control.control, arm_control);
      Connect(control.mode, arm_mode);
      Connect(control.braking, braking);
      chooses = &control;
    }
  } else {
    auto& never = Add<Constant<bool>>("yields", {.value = false});
    Connect(never.y, yields);
  }

  const int sources = o.modes.has_value() + o.door.has_value() + o.reference.has_value();
  Require(sources <= 1, "modes, door and reference each say where the tool is to be; expected one",
          sources);
  Require(!o.scaling || o.reference, "scaling is of a reference, and there is none");
  if (sources == 0)
    Connect(Add<Constant<Pose>>("target", {.value = start.frame[0].pose}).y, target);
  if (o.reference) {
    PoseReference& reference = std::visit(
        [&]<class Options>(const Options& options) -> PoseReference& {
          using Reference = typename BlockOf<PoseWaypoints, PoseTable, PoseSwing,
                                             PoseCircle>::template type<Options>;
          return Add<Reference>("reference_pose", InWorld(start.frame[0].pose, options));
        },
        *o.reference);
    aim(reference.pose);
    Connect(reference.twist, pose.target_twist);
    Connect(reference.acceleration, pose.target_acceleration);
    if (o.scaling) {
      PathPhase::Options options = *o.scaling;
      options.size = 6;
      options.period = o.period;
      auto& scaling = Add<PathPhase>("scaling", options);
      Connect(pose.error, scaling.error);
      Connect(scaling.phase, reference.phase);
    }
  }
  if (o.door) {
    VirtualDoor::Options options = *o.door;
    options.joints = joints;
    options.closed = start.frame[0].pose;
    options.gravity = o.model.gravity();
    auto& hinge = Add<VirtualDoor>("door", options);
    Connect(pose.frame, hinge.frame);
    Connect(dynamics.dynamics, hinge.dynamics);
    if (o.estimate != TorqueEstimate::Zero)
      Connect(external.acceleration, hinge.external_acceleration);
    aim(hinge.pose);
    Connect(hinge.twist, pose.target_twist);
    Connect(hinge.acceleration, pose.target_acceleration);
    Connect(hinge.mobility, pose.mobility);
    Connect(hinge.door, door);
  } else {
    Connect(Add<Constant<DoorMotion>>("door", {.value = DoorMotion{}}).y, door);
  }

  Connect(qp.torque, torque);
  Connect(qp.acceleration, acceleration);
  Connect(estimate.residual, residual);
  Connect(estimate.contact, contact);
  auto& errors = Add<PoseErrors>("pose_errors");
  Connect(pose.error, errors.task_error);
  Connect(pose.error_rate, errors.task_error_rate);
  Connect(errors.error, pose_error);
  Connect(errors.rate, pose_error_rate);
  Connect(posture.error, posture_error);
  Connect(qp.report, report);
  if (!chooses) {
    const ArmControl moves = open_loop ? ArmControl::Position
                             : std::holds_alternative<ProposedTorqueLoop>(o.torque_loop)
                                 ? ArmControl::ProposedTorque
                                 : ArmControl::KinovaTorque;
    const ControlMode in = open_loop     ? ControlMode::Position
                           : o.low_level ? ControlMode::Current
                                         : ControlMode::Torque;
    Connect(Add<Constant<ArmControl>>("arm_control", {.value = moves}).y, arm_control);
    Connect(Add<Constant<ControlMode>>("arm_mode", {.value = in}).y, arm_mode);
    Connect(Add<Constant<bool>>("braking", {.value = false}).y, braking);
  }
  const auto add_actuation = [&](const std::string& name,
                                 const TorqueLoopChoice& choice) -> TorqueActuation& {
    auto& actuation = Add<TorqueActuation>(name, {.joints = joints,
                                                  .rotor_inertia = o.rotor_inertia,
                                                  .motors = o.low_level,
                                                  .loop = choice});
    Connect(qp.torque, actuation.torque);
    Connect(qp.acceleration, actuation.acceleration);
    Connect(measured_velocity, actuation.measured_velocity);
    return actuation;
  };
  if (!chooses) {
    auto& actuation = add_actuation("low_level", o.torque_loop);
    Connect(measured_torque, actuation.measured_torque);
    Connect(actuation.current, current);
    Connect(actuation.torque_error, torque_error);
    Connect(actuation.saturated, saturated);
    return;
  }

  const PerJoint rotors =
      o.rotor_inertia.size() > 0 ? o.rotor_inertia : PerJoint(PerJoint::Zero(n));
  auto& miss = Add<TorqueError>("torque_error", {.joints = joints, .reflected_inertia = rotors});
  Connect(qp.torque, miss.wanted);
  Connect(qp.acceleration, miss.acceleration);
  Connect(measured_torque, miss.measured);
  Connect(miss.error, torque_error);
  auto& fade = Add<CurrentFade>(
      "fade", {.joints = joints,
               .change_s = o.modes->supervisor.change_s,
               .current_limit = o.low_level ? o.low_level->current_limit : MotorCurrent{},
               .period = o.period});
  Connect(chooses->control, fade.control);
  Connect(measured_current, fade.measured_current);
  Connect(fade.current, current);
  Connect(fade.saturated, saturated);
  // A loop that does not move the arm sees no error, so that nothing builds up in it: in place of
  // the measured torque it is told the one it takes for reached.
  const auto add_fading = [&](const std::string& name, ArmControl control,
                              const TorqueLoopChoice& choice, const auto& reached,
                              Input<MotorCurrent>& to, Input<JointBits>& cut) {
    auto& loop = add_actuation(name, choice);
    auto& moves = Add<Moves>(name + "_moves", {.control = control});
    auto& sees = Add<Switch<JointTorque>>(name + "_sees", {.space = joints});
    Connect(chooses->control, moves.control);
    Connect(moves.y, sees.select);
    Connect(measured_torque, sees.on);
    Connect(reached, sees.off);
    Connect(sees.y, loop.measured_torque);
    Connect(loop.current, to);
    Connect(loop.saturated, cut);
  };
  if (o.low_level) {
    add_fading("low_level", ArmControl::ProposedTorque, o.torque_loop, miss.link, fade.proposed,
               fade.proposed_saturated);
    add_fading(
        "kinova", ArmControl::KinovaTorque,
        o.modes->kinova_loop.value_or(KinovaDampedLoop{.feedforward = 1, .gain = 0, .damping = 0}),
        qp.torque, fade.kinova, fade.kinova_saturated);
  } else {
    auto& motors = Add<TorqueToCurrent>(
        "motors", {.joints = joints, .torque_per_ampere = PerJoint::Ones(n), .period = o.period});
    Connect(qp.torque, motors.torque);
    Connect(motors.current, fade.proposed);
    Connect(motors.current, fade.kinova);
  }
}

}  // namespace pliant
