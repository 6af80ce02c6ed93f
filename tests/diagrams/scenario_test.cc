#include "pliant/diagrams/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kIdeal = R"(robot: gen3
station: !SimulatedArm {ideal: true, engine: recursive}
controller: !Compliance {tool: tool_frame, estimate: zero}
duration_s: 1
)";

Scenario ScenarioIn(const std::string& text, const Overrides& set = {}) {
  ParameterFile file = ParameterFile::ReadText(text, "s.yaml");
  for (const auto& [path, yaml] : set) file.Set(path, yaml, "--set " + path);
  Scenario scenario;
  file.Fill(scenario);
  return scenario;
}

/// Keeps all rows.
class Rows final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    std::size_t at = 0;
    for (const RecordedValue& value : values) {
      begin_[value.path] = {at, value.elements.size()};
      at += value.elements.size();
    }
    size_ = at;
    return 0;
  }
  std::span<double> Begin(int, std::int64_t time_ns) noexcept override {
    times_ns.push_back(time_ns);
    rows.emplace_back(size_);
    return rows.back();
  }
  void Commit() noexcept override {}

  bool has(const std::string& path) const { return begin_.contains(path); }
  Eigen::VectorXd Of(const std::string& path, std::size_t row) const {
    const auto [at, size] = begin_.at(path);
    return Eigen::Map<const Eigen::VectorXd>(rows.at(row).data() + at,
                                             static_cast<Eigen::Index>(size));
  }

  std::vector<std::int64_t> times_ns;
  std::vector<std::vector<double>> rows;

 private:
  std::map<std::string, std::pair<std::size_t, std::size_t>> begin_;
  std::size_t size_ = 0;
};

std::string ErrorOfSetting(const Overrides& set) {
  return ErrorOf(
      [&] { ScenarioDiagram(ScenarioIn(kIdeal, set), std::make_shared<Rows>()).builder.Build(); });
}

std::shared_ptr<Rows> RowsOf(const Scenario& scenario) {
  const auto rows = std::make_shared<Rows>();
  ScenarioDiagram scene(scenario, rows);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  sim.AdvanceTo(scenario.duration_s);
  sim.AdvanceThroughTick();
  return rows;
}

TEST(Scenario, RefusesWhatIsNotThere) {
  EXPECT_EQ(ErrorOfSetting({}), "no error");
  EXPECT_EQ(ErrorOfSetting({{"robot", "gen4"}}),
            "there is no robot 'gen4'; did you mean 'gen3'?\n  known: gen3, gen3_bota, lwr, "
            "or a file that ends in .urdf");
  EXPECT_THAT(ErrorOfSetting({{"robot", "lwr"},
                              {"controller.tool", "link_7"},
                              {"station.ideal", "false"},
                              {"controller.modes", "{control: position}"}}),
              StartsWith("modes.control switches between currents, and robot 'lwr' takes torques"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tool", "tool_fram"}}), HasSubstr("tool_fram"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tool", "tool_fram"}}),
              HasSubstr("did you mean \"tool_frame\"?"));
  EXPECT_THAT(ErrorOfSetting({{"environment",
                               "[!Push {link: elbow, force: [1, 0, 0], start_s: 0, "
                               "duration_s: 1}]"}}),
              AllOf(StartsWith("push_1"), HasSubstr("has no link \"elbow\"")));
}

TEST(Scenario, RefusesNumbersThatDoNotFitTheArm) {
  EXPECT_THAT(ErrorOfSetting({{"station.position", "[1, 2, 3]"}}),
              HasSubstr("position has an element for each of the 7 joints, got 3"));
  EXPECT_EQ(ErrorOfSetting({{"duration_s", "0"}}),
            "--set duration_s: duration_s must be from 0.001 to 1000000 s, got 0");
  EXPECT_EQ(ErrorOfSetting({{"seed", "-1"}}),
            "--set seed: seed must be from 0 to 9.007199255e+15, got -1");
  EXPECT_THAT(ErrorOfSetting({{"log_period", "0 s"}}), StartsWith("recorder: "));
  EXPECT_THAT(ErrorOfSetting({{"schedule", "[{at_s: 1, mode: torque}, {at_s: 1, mode: torque}]"}}),
              StartsWith("schedule: each mode begins after the one before it"));
}

TEST(Scenario, NamesThePartsOfItsEnvironment) {
  const std::string push = "!Push {link: tool_frame, force: [0, 0, -9], start_s: 0, duration_s: 1}";
  const auto rows = RowsOf(ScenarioIn(
      kIdeal, {{"environment", "[" + push + ", " + push + "]"}, {"duration_s", "10 ms"}}));
  EXPECT_TRUE(rows->has("push_1.force"));
  EXPECT_TRUE(rows->has("push_2.force"));
  EXPECT_FALSE(rows->has("push_3.force"));
  ASSERT_EQ(rows->rows.size(), 11u);
  EXPECT_EQ(rows->times_ns.back(), 10'000'000);
}

TEST(Scenario, RecordsAtItsLogPeriod) {
  const auto rows = RowsOf(ScenarioIn(kIdeal, {{"duration_s", "20 ms"}, {"log_period", "200 Hz"}}));
  EXPECT_THAT(rows->times_ns,
              testing::ElementsAre(0, 5'000'000, 10'000'000, 15'000'000, 20'000'000));
}

TEST(Scenario, EndsWhereANumberOfItsLogPassesALimit) {
  const Scenario scenario =
      ScenarioIn(kIdeal, {{"duration_s", "20 ms"},
                          {"stop_when",
                           "[{number: \"tool.position[x]\", below: -9}, "
                           "{number: \"arm.measured_position[joint_4]\", below: 0}]"}});
  for (const std::shared_ptr<Rows>& rows : {std::make_shared<Rows>(), std::shared_ptr<Rows>()}) {
    ScenarioDiagram scene(scenario, rows);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram);
    sim.AdvanceTo(scenario.duration_s);
    ASSERT_TRUE(sim.ended());
    EXPECT_EQ(sim.ended()->text(),
              "stop_when_2 ended the run at t = 0 s: arm.measured_position[joint_4] is below 0");
    if (rows) {
      EXPECT_EQ(rows->rows.size(), 1u) << "the tick at which it ends has its row";
    }
  }
  EXPECT_THAT(ErrorOfSetting({{"stop_when", "[{number: \"arm.positon[joint_4]\", above: 1}]"}}),
              StartsWith("stop_when_1: there is no number 'arm.positon[joint_4]'; did you mean "
                         "'arm.position[joint_4]'"));
  EXPECT_EQ(ErrorOfSetting({{"stop_when", "[{number: tool.position}]"}}),
            "stop_when_1: above or below must be given, the limit at which the run ends");
}

// The true torque of a tick is Jᵀ F of the push at that tick, at the measured configuration.
TEST(Scenario, KnowsTheTorqueOfWhatPushes) {
  const Scenario scenario =
      ScenarioIn(kIdeal, {{"environment",
                           "[!Push {link: tool_frame, force: [5, 7, -9], start_s: 0, "
                           "duration_s: 0.1, edge_s: 0.02}]"},
                          {"duration_s", "0.1"}});
  const auto rows = RowsOf(scenario);
  const RobotModel model = RobotOf(scenario);
  const std::vector<std::string> frames{"tool_frame"};
  RobotDynamics d(model, frames);
  for (std::size_t k = 0; k < rows->rows.size(); k += 10) {
    const JointPosition q(rows->Of("arm.measured_position", k));
    ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
    const double t = 1e-3 * static_cast<double>(k);
    const double s = std::clamp(std::min(t, 0.1 - t) / 0.02, 0.0, 1.0);
    const Eigen::Vector3d F =
        0.5 * (1 - std::cos(std::numbers::pi * s)) * Eigen::Vector3d(5, 7, -9);
    const Eigen::VectorXd tau = d.frame[0].J.bottomRows<3>().transpose() * F;
    // Round-off of numbers of some 10 N·m; the edge ends where F is 0.
    EXPECT_LT((rows->Of("true_torque.torque", k) - tau).norm(), 1e-12) << k;
  }
}

/// Where the tool's error has gone after a second with something in the environment [m]; the error
/// is how far the tool has to go back. An arm without a pose to hold would be the wrong subject:
/// the sign is what is asked for.
Eigen::Vector3d ShiftWith(const std::string& part, const std::string& contact) {
  const auto rows = RowsOf(ScenarioIn(kIdeal, {{"environment", "[" + part + "]"}}));
  EXPECT_TRUE(rows->has(contact));
  return rows->Of("control.pose_error", rows->rows.size() - 1).tail<3>();
}

Eigen::Vector3d ToolOf(const Scenario& scenario) {
  const RobotModel model = RobotOf(scenario);
  const std::vector<std::string> frames{"tool_frame"};
  RobotDynamics d(model, frames);
  ComputeDynamics(model, StationOf(scenario).position, JointVelocity::Zero(model.joints()), d);
  return d.frame[0].pose.position;
}

TEST(Scenario, HasAPushThatPushesAlongItsForce) {
  const Eigen::Vector3d shift = ShiftWith(
      "!Push {link: tool_frame, force: [0, 0, -10], start_s: 0, duration_s: 2}", "push_1.force");
  EXPECT_LT(shift.z(), -1e-3);
}

TEST(Scenario, HasAMassThatPullsDown) {
  const Eigen::Vector3d tool = ToolOf(ScenarioIn(kIdeal));
  const auto text = [](double x) { return Text(x); };
  const Eigen::Vector3d shift = ShiftWith(
      "!MassOnRope {link: tool_frame, mass: 1, length: 0.2, stiffness: 1000, damping: 20, "
      "position: [" +
          text(tool.x()) + ", " + text(tool.y()) + ", " + text(tool.z() - 0.2) + "]}",
      "mass_1.contact");
  EXPECT_LT(shift.z(), -1e-3);
}

TEST(Scenario, HasASurfaceThatPushesToItsFreeSide) {
  const Eigen::Vector3d tool = ToolOf(ScenarioIn(kIdeal));
  // The tip begins 5 mm below the plane.
  const Eigen::Vector3d shift =
      ShiftWith("!Surface {link: tool_frame, stiffness: 2000, damping: 1, origin: [0, 0, " +
                    Text(tool.z() + 0.005) + "]}",
                "surface_1.contact");
  EXPECT_GT(shift.z(), 1e-4);
}

// A hand without stiffness against a push would do nothing; one with it holds the link back.
TEST(Scenario, HasAHandThatHoldsTheLinkWhereItTookHold) {
  const std::string push =
      "!Push {link: tool_frame, force: [0, 0, -10], start_s: 0.1, duration_s: 2}";
  const Eigen::Vector3d alone = ShiftWith(push, "push_1.force");
  const Eigen::Vector3d held = ShiftWith(
      push +
          ", !Hand {link: tool_frame, stiffness: [3000, 3000, 3000], damping: 50, start_s: 0, "
          "duration_s: 5}",
      "hand_1.contact");
  EXPECT_LT(held.norm(), 0.8 * alone.norm());
  const Eigen::Vector3d gone = ShiftWith(
      push + ", !Hand {link: tool_frame, stiffness: [3000, 3000, 3000], start_s: 2, duration_s: 5}",
      "hand_1.contact");
  EXPECT_LT((gone - alone).norm(), 1e-6 * alone.norm());  // the integrator's tolerance
}

TEST(Scenario, HasAHandThatLeadsWhatItHolds) {
  const auto rows = RowsOf(ScenarioIn(
      kIdeal, {{"environment",
                "[!Hand {link: tool_frame, stiffness: [200, 100, 50], start_s: 0.2, duration_s: 3, "
                "path: [{after_s: 0.3, by: [0.1, 0, 0]}, {after_s: 0.6, by: [0.1, 0.2, -0.1]}]}]"},
               {"duration_s", "1.5"}}));
  const auto force = [&](std::size_t row) -> Eigen::Vector3d {
    return rows->Of("hand_1.contact", row).segment(4, 3);
  };
  const auto off = [&](std::size_t row, const Eigen::Vector3d& by) -> Eigen::Vector3d {
    return by - (rows->Of("tool.position", row) - rows->Of("tool.position", 200)).head<3>();
  };
  const Eigen::Vector3d k(200, 100, 50);
  // It has no damper, so its force is that of the spring at every instant, to round-off.
  EXPECT_LT((force(500) - k.cwiseProduct(off(500, {0.1, 0, 0}))).norm(), 1e-9);
  EXPECT_LT((force(1500) - k.cwiseProduct(off(1500, {0.1, 0.2, -0.1}))).norm(), 1e-9);
  EXPECT_GT(force(1500).norm(), 10);
  EXPECT_EQ(ErrorOfSetting({{"environment",
                             "[!Hand {link: tool_frame, stiffness: [1, 1, 1], start_s: 0, "
                             "duration_s: 1, path: [{after_s: 1, by: [0, 0, 0]}, "
                             "{after_s: 1, by: [0, 0, 0]}]}]"}}),
            "after_s of a hand's path must be in order of time, got 1");
}

// What the firmware carries is not commanded twice: at rest the arm stays, to what the integrator
// allows, while the controller's own torque is that of gravity.
TEST(Scenario, CommandsAnArmThatCarriesItsWeightTheRest) {
  const Scenario scenario =
      ScenarioIn(kIdeal, {{"robot", "lwr"}, {"controller.tool", "end_effector_link"}});
  const auto rows = RowsOf(scenario);
  const SimulatedArm::Options arm = StationOf(scenario);
  RobotDynamics d(arm.model);
  ComputeDynamics(arm.model, arm.position, JointVelocity::Zero(arm.model.joints()), d);
  ASSERT_GT(d.gravity.norm(), 30);
  EXPECT_LT((rows->Of("control.torque", 0) - d.gravity).norm(), 1e-9);
  EXPECT_LT((rows->Of("arm.position", rows->rows.size() - 1) - arm.position).norm(), 1e-8);
}

TEST(Scenario, HasNoiseByItsSeed) {
  const auto rows = [](const char* seed) {
    return RowsOf(ScenarioIn(kIdeal, {{"station.ideal", "false"},
                                      {"controller.estimate", "observer"},
                                      {"integrator.method", "dormand_prince"},
                                      {"duration_s", "50 ms"},
                                      {"seed", seed}}))
        ->rows;
  };
  const auto first = rows("1");
  EXPECT_EQ(first, rows("1"));
  EXPECT_NE(first, rows("2"));
}

// Of 700 numbers the mean is within four of its standard deviations, σ/√700, and so is the mean
// square, σ² √(2/700).
TEST(Scenario, StartsWhereTheScatterOfItsSeedPutsIt) {
  const Scenario scenario = ScenarioIn(kIdeal);
  EXPECT_EQ(StationOf(ScenarioIn(kIdeal, {{"seed", "2"}})).position, StationOf(scenario).position);
  const double sigma = 0.02;
  double sum = 0, squares = 0;
  for (int seed = 1; seed <= 100; ++seed) {
    const Scenario scattered =
        ScenarioIn(kIdeal, {{"position_scatter", Text(sigma)}, {"seed", std::to_string(seed)}});
    const SimulatedArm::Options arm = StationOf(scattered);
    EXPECT_EQ(arm.position, StationOf(scattered).position);
    EXPECT_EQ(arm.position, ComplianceOf(ControllerOf(scattered, arm)).position);
    const PerJoint off = arm.position - StationOf(scenario).position;
    sum += off.sum();
    squares += off.squaredNorm();
  }
  EXPECT_NEAR(sum / 700, 0, 4 * sigma / std::sqrt(700));
  EXPECT_NEAR(squares / 700, sigma * sigma, 4 * sigma * sigma * std::sqrt(2.0 / 700));
  EXPECT_EQ(ErrorOfSetting({{"position_scatter", "-1"}}),
            "--set position_scatter: position_scatter must be >= 0 rad, got -1");
}

// Position mode holds where the arm starts; the controller then finds it there, at rest.
TEST(Scenario, TakesOverFromPositionModeWithoutAJerk) {
  const Scenario scenario =
      ScenarioIn(kIdeal, {{"schedule", "[{at_s: 0, mode: position}, {at_s: 0.5, mode: torque}]"}});
  const auto rows = RowsOf(scenario);
  const JointPosition start = StationOf(scenario).position;
  const std::size_t modes[] = {0, 499, 500, 1000};
  for (const std::size_t k : modes)
    EXPECT_EQ(rows->Of("schedule.mode", k)(0),
              static_cast<double>(k < 500 ? ControlMode::Position : ControlMode::Torque));
  double before = 0, after = 0;
  for (std::size_t k = 0; k < rows->rows.size(); ++k) {
    double& most = k < 500 ? before : after;
    most = std::max(most, rows->Of("arm.velocity", k).cwiseAbs().maxCoeff());
  }
  // The gravity torque that the firmware starts with is that of the start: nothing moves but by
  // round-off in it, some 10⁻¹⁴ N·m, and by what the integrator allows.
  EXPECT_LT(before, 1e-8);
  EXPECT_LT(after, 1e-8);
  EXPECT_LT((rows->Of("arm.position", 1000) - start).norm(), 1e-8);
}

// The estimate of the push is a fault at 2 % of a joint's torque, and in a second of it the
// reference that gives way would go further than `tracking` from the arm that is held.
void ExpectAnArmThatWasPushedWhileItWasHeldGivenBack(const std::string& gives_way) {
  const Scenario scenario = ScenarioIn(R"(robot: gen3
station: !SimulatedArm {ideal: true, engine: recursive}
controller: !Compliance {tool: tool_frame, )" +
                                       gives_way +
                                       R"(}
environment:
  - !Push {link: forearm_link, force: [0, 60 N, 0], start_s: 0.1, duration_s: 1, edge_s: 0.05}
safety: {divergence: 0.02}
duration_s: 3
)");
  const auto panel = std::make_shared<OperatorPanel>();
  ScenarioDiagram scene(scenario, std::make_shared<Rows>(), {.panel = panel});
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  sim.AdvanceTo(1.05);
  EXPECT_EQ(sim.Get(scene.safety->report).state, SafetyState::Holding);
  EXPECT_EQ(sim.Get(scene.safety->report).cause, SafetyCause::Divergence);
  EXPECT_EQ(sim.Get(scene.control->position), sim.Get(scene.arm->measured_position));
  sim.AdvanceTo(1.5);
  panel->acknowledged = panel->acknowledged + 1;
  sim.AdvanceTo(3);
  EXPECT_EQ(sim.Get(scene.safety->report).state, SafetyState::Running)
      << WordOf(sim.Get(scene.safety->report).cause);
}

TEST(ScenarioDiagram, GivesAnArmThatWasPushedWhileItWasHeldBackUnderPositionControl) {
  ExpectAnArmThatWasPushedWhileItWasHeldGivenBack("command: position, posture: {compliance: 1}");
}

TEST(ScenarioDiagram, GivesAnArmThatWasPushedWhileItWasHeldBackInAModeThatGivesWay) {
  ExpectAnArmThatWasPushedWhileItWasHeldGivenBack("command: position, modes: {mode: full_body}");
}

TEST(ScenarioDiagram, GivesAnArmThatWasPushedWhileItWasHeldBackIfItMaySwitchToTorques) {
  ExpectAnArmThatWasPushedWhileItWasHeldGivenBack("modes: {mode: full_body, control: position}");
}

}  // namespace
}  // namespace pliant
