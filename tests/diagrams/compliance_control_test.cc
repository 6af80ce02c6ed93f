#include "pliant/diagrams/compliance_control.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/diagrams/scenario.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/block_tester.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Outcome = ComplianceQpReport::Outcome;

Push::Options PushOf(const std::string& link, const Eigen::Vector3d& force, double start) {
  Push::Options push;
  push.link = link;
  push.force = force;
  push.start_s = start;
  push.duration_s = 0.6;
  return push;
}

Scenario Pushed(double pose, double posture, TorqueEstimate estimate) {
  ComplianceControl::Options control;
  control.tool = "tool_frame";
  control.pose.compliance = TaskMatrix::Constant(1, 1, pose);
  control.posture.compliance = JointMatrix::Constant(1, 1, posture);
  control.estimate = estimate;
  return {.robot = "gen3",
          .station = StationOptions{.ideal = true, .engine = SimbodyPlant::Engine::Recursive},
          .controller = control,
          .environment = {PushOf("forearm_link", {0, 20, 0}, 0.1),
                          PushOf("tool_frame", {0, 0, -20}, 0.4)},
          .duration_s = 1};
}

Scenario WithSensor(const ComplianceControl::Options& control,
                    const std::vector<EnvironmentPart>& environment, double duration_s) {
  Scenario scenario;
  scenario.robot = "gen3_bota";
  scenario.station = StationOptions{.ideal = true, .engine = SimbodyPlant::Engine::Recursive};
  scenario.controller = control;
  scenario.environment = environment;
  scenario.duration_s = duration_s;
  return scenario;
}

/// The largest deviations of a second in which elbow and tool are pushed.
struct Moved {
  explicit Moved(const Scenario& scenario) {
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram);
    const JointPosition start = StationOf(scenario).position;
    for (int k = 0; k < 1000; ++k) {
      sim.AdvanceThroughTick();
      joints = std::max(joints, (sim.Get(scene.arm->measured_position) - start).norm());
      tool = std::max(tool, sim.Get(scene.control->pose_error).norm());
      solved += sim.Get(scene.control->report).outcome == Outcome::Solved;
    }
  }
  double joints = 0, tool = 0;
  int solved = 0;
};

TEST(ComplianceControl, DoesNotMoveWithoutComplianceWhenItKnowsThePush) {
  const Moved run(Pushed(0, 0, TorqueEstimate::True));
  // Round-off in τ, some 10⁻¹⁴ N·m, against the spring of the pose and a damped null space.
  EXPECT_LT(run.joints, 1e-11);
  EXPECT_LT(run.tool, 1e-11);
  EXPECT_EQ(run.solved, 1000);
}

TEST(ComplianceControl, YieldsWhereItIsAskedTo) {
  const Moved stiff(Pushed(0, 0, TorqueEstimate::Observer));
  const Moved null_space(Pushed(0, 1, TorqueEstimate::Observer));
  const Moved full(Pushed(1, 1, TorqueEstimate::Observer));
  EXPECT_GT(null_space.joints, 5 * stiff.joints);
  EXPECT_LT(null_space.tool, 5 * stiff.tool);
  EXPECT_GT(full.tool, 5 * null_space.tool);
  for (const Moved* run : {&stiff, &null_space, &full}) EXPECT_EQ(run->solved, 1000);
}

TEST(ComplianceControl, ObservesTheLinksWithoutTheirRotors) {
  const Scenario scenario = Pushed(0, 1, TorqueEstimate::Observer);
  ScenarioDiagram scene(scenario);
  const RobotModel& model = StationOf(scenario).model;
  const double gain = std::get<ComplianceControl::Options>(scenario.controller).observer_gain;
  auto& links = scene.builder.Add<ModelDynamics>("links", {.model = model});
  auto& observer = scene.builder.Add<MomentumObserver>(
      "observer", {.joints = model.joints(), .gain = PerJoint::Constant(7, gain), .period = 1ms});
  scene.builder.Connect(scene.arm->measured_position, links.position);
  scene.builder.Connect(scene.arm->measured_velocity, links.velocity);
  scene.builder.Connect(links.dynamics, observer.dynamics);
  scene.builder.Connect(scene.arm->measured_torque, observer.torque);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  double largest = 0;
  for (int k = 0; k < 600; ++k) {
    sim.AdvanceThroughTick();
    const PerJoint expected = sim.Get(observer.residual);
    // round-off of p over h, filtered
    ASSERT_LT((sim.Get(scene.control->residual) - expected).cwiseAbs().maxCoeff(), 1e-12) << k;
    largest = std::max(largest, expected.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest, 1);  // [N·m], so there was something to see
}

TEST(ComplianceControl, WithFullComplianceMovesAsWithoutAnyEstimate) {
  // EC V: Γ = I cancels the compensation of (8).
  const Moved known(Pushed(1, 1, TorqueEstimate::True));
  const Moved ignored(Pushed(0, 0, TorqueEstimate::Zero));
  EXPECT_GT(known.tool, 1e-3);
  EXPECT_NEAR(known.tool, ignored.tool, 1e-6 * known.tool);  // the integrator's tolerance
  EXPECT_NEAR(known.joints, ignored.joints, 1e-6 * known.joints);
}

/// The tool is pushed while the arm is in a mode; at 0.6 s, from one snapshot, another is chosen.
/// A change moves the torque of its first tick by h/T = 1/500 of what it changes in all, which is
/// below 0.5 N·m for all that an arm can do within its limits, 2 · 45 N·m; and no later tick moves
/// it by more either, beside what it moves anyway.
TEST(ComplianceControl, ChangesModesWithoutAJump) {
  using enum ComplianceMode;
  struct Mode {
    ComplianceMode mode;
    bool dynamic;
  };
  const std::vector<Mode> modes{{Stiff, false},   {NullSpace, false}, {FullBody, false},
                                {Dual, false},    {Stiff, true},      {NullSpace, true},
                                {FullBody, true}, {Dual, true}};
  const auto diagram_of = [](const Mode& from, const Mode& to) {
    ComplianceControl::Options control;
    control.tool = "FT_sensor_wrench";
    control.estimate = TorqueEstimate::Fusion;
    control.modes = {
        .mode = from.mode, .dynamic = from.dynamic, .changes = {{0.6, to.mode, to.dynamic}}};
    const Scenario scenario =
        WithSensor(control, {PushOf("FT_sensor_wrench", {0, 15, -20}, 0.1)}, 1);
    return ScenarioDiagram(scenario);
  };
  for (const Mode& from : modes) {
    std::vector<JointTorque> staying;
    for (const bool stays : {true, false})
      for (const Mode& to : modes) {
        if (stays != (to.mode == from.mode && to.dynamic == from.dynamic)) continue;
        ScenarioDiagram scene = diagram_of(from, to);
        const Diagram diagram = scene.builder.Build();
        Simulator sim(diagram);
        sim.AdvanceTo(0.6);
        JointTorque last = sim.Get(scene.control->torque);
        for (int k = 0; k < 100; ++k) {
          sim.AdvanceThroughTick();
          const JointTorque now = sim.Get(scene.control->torque);
          if (stays) {
            staying.push_back(now);
          } else if (k == 0) {
            ASSERT_LT((now - staying[0]).cwiseAbs().maxCoeff(), 0.5);
          } else {
            // ramps on, no faster than 0.5 N·m a tick beside what the other run does
            const JointTorque anyway =
                staying[static_cast<std::size_t>(k)] - staying[static_cast<std::size_t>(k) - 1];
            ASSERT_LT((now - last - anyway).cwiseAbs().maxCoeff(), 0.5) << k;
          }
          last = now;
        }
      }
  }
}

TEST(ComplianceControl, YieldsWhileTheToolIsPushedHardAndStaysWhereItIsLeft) {
  ComplianceControl::Options control;
  control.tool = "FT_sensor_wrench";
  control.modes = {.mode = ComplianceMode::Dual};
  const Scenario scenario = WithSensor(
      control,
      {PushOf("FT_sensor_wrench", {0, 6, 0}, 0.1), PushOf("FT_sensor_wrench", {0, 15, 0}, 1)}, 4);
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  const auto away = [&](double t) {
    bool yielded = false;
    while (sim.time() < t) {
      sim.AdvanceThroughTick();
      yielded = yielded || sim.Get(scene.control->yields);
    }
    return yielded;
  };
  EXPECT_FALSE(away(1)) << "6 N are below the threshold";
  const Eigen::Vector3d first = sim.Get(scene.arm->motion).frame[0].pose.position;
  EXPECT_TRUE(away(2.5));
  EXPECT_FALSE(sim.Get(scene.control->yields));
  away(4);
  const Eigen::Vector3d last = sim.Get(scene.arm->motion).frame[0].pose.position;
  EXPECT_GT((last - first).norm(), 0.01) << "it went where it was pushed";
  EXPECT_LT(sim.Get(scene.control->pose_error).norm(), 1e-3) << "and stays there";
}

// A hard push that the sensor showed last, of which nothing is known any more.
TEST(ComplianceControl, LeavesAWrenchThatIsNotValidAlone) {
  ComplianceControl::Options o{.model = RobotModel::FromUrdf(kGen3BotaFile),
                               .position = {0, 0.26, 3.14, -2.27, 0, 0.96, 1.57},
                               .rotor_inertia = {},
                               .wrist = WristTool{.frame = "FT_sensor_wrench"},
                               .tool = "FT_sensor_wrench"};
  o.modes.emplace().mode = ComplianceMode::Dual;
  for (const bool valid : {true, false}) {
    BlockTester<ComplianceControl> t(o);
    t.Set(t->measured_position, o.position);
    t.Set(t->measured_velocity, JointVelocity::Zero(o.model.joints()));
    t.Set(t->measured_torque, JointTorque::Zero(o.model.joints()));
    t.Set(t->wrench, {0, 0, 0, 0, 0, 30});
    t.Set(t->wrench_valid, valid);
    bool yielded = false;
    for (int k = 0; k < 200; ++k) {
      t.Tick();
      yielded = yielded || t.Get(t->yields);
    }
    EXPECT_EQ(yielded, valid);
    EXPECT_EQ(t.Get(t->contact), valid ? Wrench({0, 0, 0, 0, 0, 30}) : Wrench());
  }
}

TEST(ComplianceControl, HoldsTheToolWhereAnArmIsThatItGetsBack) {
  ComplianceControl::Options o{.model = Gen3(),
                               .position = {0, 0.26, 3.14, -2.27, 0, 0.96, 1.57},
                               .rotor_inertia = {},
                               .tool = "tool_frame"};
  JointPosition away = o.position;
  away(1) += 0.2;
  for (const bool switches : {false, true}) {
    o.modes = {.mode = ComplianceMode::Stiff};
    if (switches)
      o.modes->control = ArmControl::Position;
    else
      o.command = ArmCommand::Position;
    BlockTester<ComplianceControl> t(o);
    t.Set(t->measured_position, o.position);
    t.Set(t->measured_velocity, JointVelocity::Zero(o.model.joints()));
    t.Set(t->measured_torque, JointTorque::Zero(o.model.joints()));
    t.Tick();
    t.Set(t->held, true);
    t.Set(t->measured_position, away);
    for (int k = 0; k < 1000; ++k) t.Tick();
    EXPECT_EQ(t.Get(t->position), away);
    EXPECT_LT(t.Get(t->pose_error).norm(), 1e-9);
    t.Set(t->held, false);
    for (int k = 0; k < 1000; ++k) t.Tick();
    EXPECT_LT(t.Get(t->pose_error).norm(), 1e-9);
    o.command = {};
  }
}

TEST(ComplianceControl, GivesWayThroughPositionsAsThroughTorques) {
  const auto moved = [](ArmCommand command) {
    Scenario scenario = Pushed(1, 1, TorqueEstimate::True);
    std::get<ComplianceControl::Options>(scenario.controller).command = command;
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram);
    sim.AdvanceTo(0.7);
    return JointPosition(sim.Get(scene.control->position) - StationOf(scenario).position);
  };
  const JointPosition torque = moved(ArmCommand::Torque), position = moved(ArmCommand::Position);
  EXPECT_GT(torque.norm(), 0.02);
  // What pushes is held over a tick here, and acts between ticks there: h over the 0.2 s of an
  // edge.
  EXPECT_LT((position - torque).norm(), 0.01 * torque.norm());
}

/// A Gen3 with motors, held for a second in an extended posture.
struct Real {
  explicit Real(const TorqueLoopChoice& loop) {
    ComplianceControl::Options control;
    control.tool = "tool_frame";
    control.torque_loop = loop;
    Scenario scenario;
    scenario.robot = "gen3";
    scenario.station = StationOptions{.position = {0, 0.58, 3.14, -1.84, 0, 0.85, 1.57},
                                      .engine = SimbodyPlant::Engine::Recursive};
    scenario.controller = control;
    scenario.duration_s = 1;
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    sim.AdvanceTo(1);
    wanted = sim.Get(scene.control->torque);
    error = sim.Get(scene.control->torque_error);
    current = sim.Get(scene.control->current);
    saturated = sim.Get(scene.control->saturated);
    off = sim.Get(scene.control->pose_error).tail<3>().norm();
    target = sim.Get(scene.control->target).position;
  }
  JointTorque wanted, error;
  MotorCurrent current;
  JointBits saturated = 0;
  double off = 0;
  Eigen::Vector3d target;
};

TEST(ComplianceControl, HoldsAnArmByAnyTorqueLoop) {
  const Real as_ever(TorqueLoopChoice{}), bare(ProposedTorqueLoop{.lag_gain = 0, .leak_gain = 0}),
      kinova(KinovaHighVelocityLoop{.feedforward = 0, .gain = 5}),
      damped(KinovaDampedLoop{.feedforward = 0, .gain = 5, .damping = 10});
  const double bias = 1;  // of the torque sensors and of stiction, some [N·m]
  EXPECT_LT(as_ever.off, 2e-3);
  EXPECT_LT(as_ever.error.norm(), 2 * bias);
  EXPECT_GT(bare.off, as_ever.off);
  // Without a feedforward 1/(1 + k) of the torque is missing, and the pose gives way for it.
  for (const Real* run : {&kinova, &damped}) {
    EXPECT_NEAR(run->error(1), run->wanted(1) / 6, 2 * bias);
    EXPECT_GT(run->off, 5 * as_ever.off);
    EXPECT_EQ(run->saturated, 0U);
  }
  EXPECT_EQ(as_ever.target, kinova.target);
}

TEST(ComplianceControl, RefusesLoopsWithoutTheGainsThatAreNotPublished) {
  const auto error = [](const TorqueLoopChoice& loop) { return ErrorOf([&] { Real run(loop); }); };
  EXPECT_EQ(error(KinovaHighVelocityLoop{.feedforward = 0, .gain = -1}),
            "control.low_level.loop: gain must be >= 0, got -1");
  EXPECT_EQ(error(KinovaHighVelocityLoop{.gain = 1}),
            "control.low_level.loop: feedforward must be >= 0, got nan");
  EXPECT_EQ(error(KinovaDampedLoop{.feedforward = 1, .gain = 1}),
            "control.low_level.loop: damping must be >= 0 N·m·s/rad, got nan");
}

TEST(ComplianceControl, RefusesWhatItHasNoSensorFor) {
  Scenario scenario = Pushed(0, 0, TorqueEstimate::Fusion);
  EXPECT_EQ(ErrorOf([&] { ScenarioDiagram scene(scenario); }),
            "control.estimate: estimate fusion needs a wrist sensor; expected a robot that has "
            "one, such as gen3_bota, or the estimate observer");
  scenario = Pushed(0, 0, TorqueEstimate::Observer);
  ForceLimit::Options limit;
  limit.frame = "tool_frame";
  limit.force = 10;
  limit.stiffness = 1000;
  std::get<ComplianceControl::Options>(scenario.controller).force_limit = limit;
  EXPECT_EQ(ErrorOf([&] { ScenarioDiagram scene(scenario); }),
            "control: force_limit.frame must be the frame of a wrist sensor; this robot has none, "
            "got 'tool_frame'");
  scenario = Pushed(0, 0, TorqueEstimate::Observer);
  std::get<ComplianceControl::Options>(scenario.controller).modes = {
      .changes = {{1, ComplianceMode::Dual, false}, {1, ComplianceMode::Stiff, false}}};
  EXPECT_EQ(ErrorOf([&] { ScenarioDiagram scene(scenario); }),
            "control.schedule: each mode begins after the one before it, got 1 s behind 1 s");
}

TEST(ComplianceControl, RefusesOptionsThatContradictEachOther) {
  const auto error = [](const auto& change) {
    Scenario scenario = Pushed(0, 0, TorqueEstimate::Observer);
    change(std::get<ComplianceControl::Options>(scenario.controller));
    return ErrorOf([&] { ScenarioDiagram scene(scenario); });
  };
  using Options = ComplianceControl::Options;
  PoseSwing::Options swing;
  swing.frequency_hz = 1;
  PathPhase::Options scaling;
  scaling.free = 0.01;
  scaling.stop = 0.05;
  EXPECT_EQ(error([&](Options& o) { o.modes.emplace(), o.reference = swing; }),
            "control: modes, door and reference each say where the tool is to be; expected one, "
            "got 2");
  EXPECT_EQ(error([&](Options& o) { o.scaling = scaling; }),
            "control: scaling is of a reference, and there is none");
  EXPECT_EQ(error([&](Options& o) { o.reference = swing, o.pose.weight = 0; }),
            "control: modes, reference and door move the tool, so pose.weight must be > 0, got 0");
  EXPECT_EQ(error([&](Options& o) { o.pose.weight = -1; }),
            "control: pose.weight must be >= 0, got -1");
  EXPECT_EQ(error([&](Options& o) { o.posture.stiffness = JointMatrix::Ones(3, 1); }),
            "control: posture.stiffness must be a number or one for each of the 7 joints, got 3 x "
            "1");
}

/// An arm that gives way to a push on its forearm as CF has it, by one controller or the other.
Scenario GivesWay(const ArmController& controller) {
  Scenario scenario = Pushed(0, 0, TorqueEstimate::Observer);
  scenario.controller = controller;
  scenario.environment = {PushOf("forearm_link", {0, 20, 10}, 0.3)};
  return scenario;
}

ContactSettings Springs() {
  return {.behavior = ContactImpedance::Gains{.damping = TaskMatrix::Constant(1, 1, 80),
                                              .stiffness = TaskMatrix::Constant(1, 1, 500)},
          .tare_from_s = 0.1,
          .tare_until_s = 0.2,
          .threshold = JointMatrix::Constant(1, 1, 0.1)};
}

/// The largest way of the first contact, and where it is at the end.
std::pair<double, Eigen::Vector3d> WayOf(const Scenario& scenario) {
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  const auto& slots = diagram.plan().slots;
  const auto slot = std::ranges::find_if(slots, [](const internal::Slot& s) {
    return s.value && s.value->path() == "control.tasks.place_1.anchor.error";
  });
  if (slot == slots.end()) throw Error("there is no anchor");
  const auto& error = static_cast<const Output<Position>&>(*slot->value);
  Simulator sim(diagram);
  double most = 0;
  for (int k = 0; k < 1000; ++k) {
    sim.AdvanceThroughTick();
    most = std::max(most, sim.Get(error).norm());
  }
  return {most, sim.Get(error)};
}

// Where no limit is near, the QP asks the joints for the contact's acceleration as CF's law does:
// its posture counts w₀/w = 1e-8. What it leaves free moves otherwise, and with it the natural
// inertia, so the ways are the same but for a hundredth.
TEST(ComplianceControl, GivesWayAtContactsAsCfsLawDoes) {
  ComplianceControl::Options qp;
  qp.tool = "tool_frame";
  qp.pose.weight = 0;
  qp.posture.damping = JointMatrix::Constant(1, 1, 20);
  qp.contacts = Springs();
  qp.contact_weight = 1e8;
  ContactControl::Options law;
  law.tool = "tool_frame";
  law.contact = Springs();
  const auto [qp_way, qp_end] = WayOf(GivesWay(qp));
  const auto [law_way, law_end] = WayOf(GivesWay(law));
  EXPECT_GT(law_way, 0.01);
  EXPECT_NEAR(qp_way, law_way, 0.01 * law_way);
  EXPECT_LT((qp_end - law_end).norm(), 0.01 * law_way);
}

TEST(ComplianceControl, RefusesContactsItCannotFind) {
  const auto error = [](const auto& change) {
    ComplianceControl::Options o;
    o.tool = "tool_frame";
    o.contacts = Springs();
    change(o);
    return ErrorOf([&] { ScenarioDiagram scene(GivesWay(o)); });
  };
  using Options = ComplianceControl::Options;
  EXPECT_EQ(error([](Options& o) { o.estimate = TorqueEstimate::Zero; }),
            "control: contacts are found by the residual of an observer, so estimate must be "
            "observer or super_twisting");
  EXPECT_EQ(error([](Options& o) { o.command = ArmCommand::Position; }),
            "control: contacts are of an arm that is commanded torques; expected the command "
            "torque and no modes.control");
  EXPECT_EQ(error([](Options& o) { o.contact_weight = 0; }),
            "control: contact_weight must be > 0, got 0");
}

/// A scenario with everything that a controller may have at once.
TEST(ComplianceControl, KeepsEverythingItIsToldToAtOnceWithoutHeap) {
  ComplianceControl::Options control;
  control.tool = "FT_sensor_wrench";
  control.estimate = TorqueEstimate::SuperTwistingFusion;
  control.posture.compliance = JointMatrix::Constant(1, 1, 1);
  PoseSwing::Options swing;
  swing.way = {0.1, 0, -0.2};
  swing.frequency_hz = 0.5;
  control.reference = swing;
  PathPhase::Options scaling;
  scaling.free = 0.05;
  scaling.stop = 0.1;
  control.scaling = scaling;
  control.collisions.emplace();
  FrameSpeedLimit::Options speed;
  speed.frame = "FT_sensor_wrench";
  speed.linear = 0.2;
  control.speed_limit = speed;
  WorkspacePlanes::Options workspace;
  workspace.frame = "FT_sensor_wrench";
  workspace.planes = {{.normal = {0, 0, 1}, .point = {0, 0, 0.35}}};
  control.workspace = {workspace};
  ForceLimit::Options force;
  force.frame = "FT_sensor_wrench";
  force.force = 20;
  force.stiffness = 2000;
  control.force_limit = force;
  const Scenario scenario = WithSensor(control, {PushOf("FT_sensor_wrench", {0, 10, 0}, 0.5)}, 2);
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  sim.AdvanceTo(0.2);
  const Context snapshot = sim.Snapshot();
  const long before = Allocations();
  double lowest = 1, fastest = 0;
  int given_up = 0;
  for (int k = 0; k < 1800; ++k) {
    sim.AdvanceThroughTick();
    const FrameDynamics& tool = sim.Get(scene.arm->motion).frame[0];
    lowest = std::min(lowest, tool.pose.position.z());
    fastest = std::max(fastest, tool.twist.tail<3>().norm());
    given_up += sim.Get(scene.control->report).outcome != Outcome::Solved;
  }
  EXPECT_EQ(Allocations() - before, 0);
  EXPECT_EQ(given_up, 0);
  EXPECT_GT(lowest, 0.35 - 1e-3) << "of a reference that goes 8 cm below";
  EXPECT_LT(lowest, 0.36);
  EXPECT_LT(fastest, 0.2 * 1.1);  // λ h = 0.1
  const JointTorque first = sim.Get(scene.control->torque);
  sim.Restore(snapshot);
  for (int k = 0; k < 1800; ++k) sim.AdvanceThroughTick();
  EXPECT_EQ(sim.Get(scene.control->torque), first);
}

TEST(ComplianceControl, LeavesAnArmInPositionModeWhereItStarts) {
  Scenario scenario = Pushed(0, 0, TorqueEstimate::Observer);
  scenario.schedule = {{.at_s = 0, .mode = ControlMode::Position}};
  scenario.environment = {PushOf("tool_frame", {0, 0, -30}, 0.1)};
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  double furthest = 0;
  for (int k = 0; k < 600; ++k) {
    sim.AdvanceThroughTick();
    furthest = std::max(
        furthest,
        (sim.Get(scene.arm->position) - StationOf(scenario).position).cwiseAbs().maxCoeff());
  }
  // 30 N at some 0.6 m against 4000 N·m/rad and more
  EXPECT_LT(furthest, 30 * 0.9 / 4000);
  EXPECT_GT(furthest, 1e-5);
}

TEST(ComplianceControl, TakesNothingFromTheHeapAndRepeatsItselfBitForBit) {
  ScenarioDiagram scene(Pushed(0.5, 1, TorqueEstimate::Observer));
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  sim.AdvanceTo(0.2);
  const Context snapshot = sim.Snapshot();
  const long before = Allocations();
  sim.AdvanceTo(0.6);
  EXPECT_EQ(Allocations() - before, 0);
  const JointTorque first = sim.Get(scene.control->torque);
  const Context end = sim.Snapshot();
  sim.Restore(snapshot);
  sim.AdvanceTo(0.6);
  EXPECT_EQ(sim.Get(scene.control->torque), first);
  EXPECT_TRUE(sim.Snapshot() == end);
}

TEST(ComplianceControl, RefusesAPositionOfAnotherArm) {
  ComplianceControl::Options o;
  o.model = Gen3();
  o.position = {0, 0};
  o.tool = "tool_frame";
  EXPECT_EQ(ErrorOf([&] { ComplianceControl control(o); }),
            "position has an element for each of the 7 joints, got 2");
}

TEST(LowLevelTorqueOf, RefusesActuatorsOfAnotherArm) {
  EXPECT_EQ(ErrorOf([] { LowLevelTorqueOf({}, Gen3(), 1ms); }),
            "actuators has an element for each of the 7 joints, got 0");
}

}  // namespace
}  // namespace pliant
