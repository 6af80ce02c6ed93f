#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "pliant/diagrams/scenario.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr int kSwitch = 600;  // the tick of the change

struct Case {
  bool ideal = true, pushed = false, dynamic = false;
  ComplianceMode mode = ComplianceMode::NullSpace;
};

Scenario Changing(const Case& c, ArmControl from, ArmControl to) {
  ComplianceControl::Options control;
  control.tool = "FT_sensor_wrench";
  control.estimate = TorqueEstimate::Fusion;
  control.modes = {.mode = c.mode,
                   .dynamic = c.dynamic,
                   .control = from,
                   .kinova_loop = KinovaDampedLoop{.feedforward = 1, .gain = 15, .damping = 0},
                   .changes = {{.at_s = 1e-3 * kSwitch, .control = to}}};
  Scenario scenario;
  scenario.robot = "gen3_bota";
  scenario.station = StationOptions{.ideal = c.ideal, .engine = SimbodyPlant::Engine::Recursive};
  scenario.controller = control;
  if (c.pushed) {
    Push::Options push;
    push.link = "FT_sensor_wrench";
    push.force = {0, 15, -20};
    push.start_s = 0.1;
    push.duration_s = 0.8;
    scenario.environment = {push};
  }
  scenario.duration_s = 4;
  return scenario;
}

/// What a run does from the tick before the change on.
struct Ran {
  Ran(const Scenario& scenario, int ticks) {
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    sim.AdvanceTo(1e-3 * (kSwitch - 1));
    jumps.reserve(static_cast<std::size_t>(ticks));
    tool.reserve(static_cast<std::size_t>(ticks) + 1);
    const PerJoint kappa = StationOf(scenario).actuators.torque_per_ampere();
    const auto from = *std::get<ComplianceControl::Options>(scenario.controller).modes->control;
    const long before = Allocations();
    PerJoint last;
    for (int k = -1; k < ticks; ++k) {
      sim.AdvanceThroughTick();
      const PerJoint now = kappa.cwiseProduct(sim.Get(scene.arm->measured_current));
      if (k >= 0) jumps.push_back((now - last).cwiseAbs().maxCoeff());
      last = now;
      tool.push_back(sim.Get(scene.arm->motion).frame[0].pose.position);
      if (arrived < 0 && sim.Get(scene.control->arm_control) != from) arrived = k;
    }
    allocations = Allocations() - before;
  }

  std::vector<double> jumps;          ///< of the motors' torque at each tick [N·m]
  std::vector<Eigen::Vector3d> tool;  ///< its position
  int arrived = -1;                   ///< ticks after the change was wanted; −1: not yet
  long allocations = 0;
};

/// Motors are at no tick moved by more than they are anyway under the control before or after the
/// change, and by 1 N·m: the fade goes through the 2 · 39 N·m between two loops of the largest
/// motors in 500 ticks, 0.16 N·m each; the rest is for other noise of the sensors. Ticks after the
/// change differ on a real arm, where friction compensation turns its sign, 2 · 3 N·m, and noise
/// comes through the gains, some 2 N·m.
void ExpectNoJump(const Case& c) {
  using enum ArmControl;
  std::map<ArmControl, Ran> stay;
  for (const ArmControl same : {Position, KinovaTorque, ProposedTorque})
    stay.emplace(same, Ran(Changing(c, same, same), 300));
  const auto usual_of = [&](ArmControl same) {
    return *std::ranges::max_element(stay.at(same).jumps);
  };
  for (const ArmControl from : {Position, KinovaTorque, ProposedTorque}) {
    const Ran& stays = stay.at(from);
    const double usual = usual_of(from);
    for (const ArmControl to : {Position, KinovaTorque, ProposedTorque}) {
      if (from == to) continue;
      const Ran ran(Changing(c, from, to), to == Position ? 1500 : 400);
      EXPECT_EQ(ran.allocations, 0);
      ASSERT_GE(ran.arrived, 0);
      const auto at = static_cast<std::size_t>(ran.arrived);
      EXPECT_LT(std::max(ran.jumps[at], ran.jumps[at + 1]), usual + 1);
      EXPECT_LT(*std::ranges::max_element(ran.jumps),
                c.ideal ? std::max(usual, usual_of(to)) + 1 : 8);
      if (to == Position) {
        // It brakes where it is: a tenth of the 0.19 m that the push moves it. A swing then goes
        // on, which takes it 0.1 m from its middle.
        EXPECT_LT((ran.tool.back() - ran.tool.front()).norm(), c.dynamic ? 0.12 : 0.02);
        continue;
      }
      EXPECT_EQ(ran.arrived, 0);
      // In the 0.3 s the loops' friction leaves the arm up to 18 mm apart, of 0.19 m that the push
      // moves it; a loop that did not take over would leave more.
      for (std::size_t k = 0; k < stays.tool.size(); ++k)
        ASSERT_LT((ran.tool[k] - stays.tool[k]).norm(), 0.025) << k;
    }
  }
}

constexpr std::array kCompliances{ComplianceMode::NullSpace, ComplianceMode::FullBody,
                                  ComplianceMode::Dual};

TEST(ControlSwitching, DoesNotJumpOnAnIdealArm) {
  for (const bool pushed : {false, true})
    for (const bool dynamic : {false, true})
      for (const auto mode : kCompliances) {
        SCOPED_TRACE(testing::Message() << pushed << dynamic << static_cast<int>(mode));
        ExpectNoJump({.ideal = true, .pushed = pushed, .dynamic = dynamic, .mode = mode});
      }
}

TEST(ControlSwitching, DoesNotJumpOnARealArmAtRest) {
  for (const auto mode : kCompliances) {
    SCOPED_TRACE(static_cast<int>(mode));
    ExpectNoJump({.ideal = false, .pushed = false, .dynamic = false, .mode = mode});
  }
}

TEST(ControlSwitching, DoesNotJumpOnARealArmThatMovesAndIsPushed) {
  for (const auto mode : kCompliances) {
    SCOPED_TRACE(static_cast<int>(mode));
    ExpectNoJump({.ideal = false, .pushed = true, .dynamic = true, .mode = mode});
  }
}

TEST(ControlSwitching, LetsNothingBuildUpInALoopThatDoesNotMoveTheArm) {
  using enum ArmControl;
  const Scenario scenario =
      Changing({.ideal = false, .pushed = true, .dynamic = true, .mode = ComplianceMode::FullBody},
               ProposedTorque, ProposedTorque);
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  const auto& slots = diagram.plan().slots;
  const auto current = std::ranges::find_if(slots, [](const internal::Slot& slot) {
    return slot.value && slot.value->path() == "control.kinova.loop.motor.current";
  });
  ASSERT_NE(current, slots.end());
  const auto& kinova = static_cast<const Output<MotorCurrent>&>(*current->value);
  Simulator sim(diagram, {.integrator = scenario.integrator});
  const PerJoint kappa = StationOf(scenario).actuators.torque_per_ampere();
  double moved = 0;
  for (int k = 0; k < kSwitch; ++k) {
    sim.AdvanceThroughTick();
    // f = 1, d = 0, and nothing comes through the lag.
    const PerJoint off = kappa.cwiseProduct(sim.Get(kinova)) - sim.Get(scene.control->torque);
    ASSERT_LT(off.cwiseAbs().maxCoeff(), 1e-12) << k;  // round-off
    moved = std::max(moved, sim.Get(scene.control->acceleration).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(moved, 1) << "rotors are moved";
}

TEST(ControlSwitching, FollowsARecordedPad) {
  using enum PadHappening;
  Scenario scenario = Changing({.ideal = true, .mode = ComplianceMode::NullSpace},
                               ArmControl::ProposedTorque, ArmControl::ProposedTorque);
  SupervisedModes& modes = *std::get<ComplianceControl::Options>(scenario.controller).modes;
  modes.changes.clear();
  modes.pad = {{{.at_s = 0.01, .what = Connect},
                {.at_s = 0.1, .what = Press, .button = PadButton::L1},
                {.at_s = 0.2, .what = Press, .button = PadButton::Circle},
                {.at_s = 0.3, .what = Disconnect}}};
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  for (const auto& [until, control] : {std::pair{0.05, ArmControl::ProposedTorque},
                                       {0.15, ArmControl::KinovaTorque},
                                       {0.25, ArmControl::Position},
                                       {0.35, ArmControl::Position}}) {
    sim.AdvanceTo(until);
    EXPECT_EQ(sim.Get(scene.control->arm_control), control) << until;
  }
}

TEST(ControlSwitching, RefusesControlsThatContradictTheRest) {
  using enum ArmControl;
  const auto error = [](const auto& change) {
    Scenario scenario =
        Changing({.ideal = false, .mode = ComplianceMode::NullSpace}, Position, KinovaTorque);
    change(scenario, std::get<ComplianceControl::Options>(scenario.controller));
    return ErrorOf([&] { ScenarioDiagram scene(scenario); });
  };
  using O = ComplianceControl::Options;
  EXPECT_EQ(error([](Scenario&, O&) {}), "no error");
  EXPECT_EQ(error([](Scenario&, O& o) { o.modes->control = {}; }),
            "control: modes.control must be given where a change of modes has "
            "a control: what moves "
            "the arm at the start");
  EXPECT_EQ(error([](Scenario&, O& o) { o.modes->kinova_loop = {}; }),
            "control: modes.kinova_loop must be given for the control "
            "kinova_torque: its gains are "
            "not published");
  EXPECT_EQ(error([](Scenario&, O& o) { o.command = ArmCommand::Position; }),
            "control: modes.control says what moves the arm; expected no "
            "command beside it");
  EXPECT_EQ(error([](Scenario&, O& o) {
              o.torque_loop = KinovaHighVelocityLoop{.feedforward = 1, .gain = 1};
            }),
            "control: modes.control changes between torque_loop and "
            "modes.kinova_loop, so "
            "torque_loop must be !Proposed");
  EXPECT_EQ(error([](Scenario&, O& o) { o.modes->pad = PadEvents{}; }),
            "control: modes.pad says what is wanted; expected no modes.changes "
            "beside it");
  EXPECT_EQ(error([](Scenario& s, O&) { s.schedule = {{.at_s = 1, .mode = ControlMode::Torque}}; }),
            "controller.modes.control says what mode the arm is in; expected "
            "no schedule beside it");
}

}  // namespace
}  // namespace pliant
