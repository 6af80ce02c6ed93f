#include "pliant/diagrams/null_space_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

const std::string kText = R"(robot: lwr
station: !SimulatedArm {engine: recursive}
controller: !NullSpaceCompliance
  tool: end_effector_link
  motion: !Circle
    {radius: 0.1, angular_velocity: 0.5, radial_gain: 4, height_gain: 13}
integrator: {method: dormand_prince}
duration_s: 8
)";

Scenario ScenarioIn(const Overrides& set = {}) {
  ParameterFile file = ParameterFile::ReadText(kText, "s.yaml");
  for (const auto& [path, yaml] : set) file.Set(path, yaml, "--set " + path);
  Scenario scenario;
  file.Fill(scenario);
  return scenario;
}

std::string ErrorOfSetting(const Overrides& set) {
  return ErrorOf([&] { ScenarioDiagram(ScenarioIn(set)).builder.Build(); });
}

/// Seen from a time on.
struct Course {
  double off_path = 0, off_turn = 0, joints = 0;
  double missing = 0;         ///< of a wrench of the tool, by the torque that the motors leave out
  double least_singular = 1;  ///< of the tool's Jacobian
  bool fell = false;          ///< back, at any time
};

Course Run(const Overrides& set, double from_s = 5) {
  const Scenario scenario = ScenarioIn(set);
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  Course course;
  while (sim.time() < scenario.duration_s) {
    sim.AdvanceThroughTick();
    const NullSpaceControl& control = *scene.null_space;
    course.fell = course.fell || sim.Get(control.fallback);
    if (sim.time() < from_s) continue;
    const double singular = sim.Get(control.least_singular);
    course.off_path = std::max(course.off_path, sim.Get(control.path_error).norm());
    course.off_turn = std::max(course.off_turn, sim.Get(control.orientation_error).norm());
    course.joints = std::max(course.joints, sim.Get(scene.arm->velocity).norm());
    course.missing = std::max(course.missing, sim.Get(control.torque_error).norm() / singular);
    course.least_singular = std::min(course.least_singular, singular);
  }
  return course;
}

const Overrides kIdeal{{"station.ideal", "true"}, {"controller.orientation.damping", "[1, 1, 1]"}};

Overrides With(Overrides set, const Overrides& more) {
  set.insert(set.end(), more.begin(), more.end());
  return set;
}

// An arm without friction follows the field but for the inertia it does not know of: m v²/r of some
// 7 kg at 5 cm/s on 10 cm is 0.2 N, of 200 N·s/m and 2 1/s off by 0.4 mm; height 0.1 mm.
TEST(NullSpaceControl, DrawsTheCircleWithAnIdealArm) {
  const Course course = Run(kIdeal);
  EXPECT_LT(course.off_path, 2e-3);
  EXPECT_LT(course.off_turn, 0.02);
}

TEST(NullSpaceControl, GoesEveryWayThatIsOffered) {
  for (const auto& [motion, off] : std::vector<std::pair<std::string, double>>{
           {"!LimitCycle {radius: 0.08, harmonics: [{}, {cosine: 0.02}], angular_velocity: 0.5,"
            " radial_gain: 2, height_gain: 10}",
            4e-3},
           {"!Goal {goal: [0.05, 0.08, 0.05], gain: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], speed: 0.1}",
            8e-3},  // 0.1 m e^{−(5 − 1) s} and what it takes to get there at 0.1 m/s
           {"!Classical {position: [0.1, 0, 0], center: [0, 0, 0], normal: [0, 0, 1], speed: 0.5}",
            0.02}}) {  // D v/K late
    const Course course = Run(With(kIdeal, {{"controller.motion", motion}}));
    EXPECT_LT(course.off_path, off) << motion;
  }
}

TEST(NullSpaceControl, CommandsGravityAndBothParts) {
  const Scenario scenario = ScenarioIn();
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  for (int i = 0; i < 100; ++i) sim.AdvanceThroughTick();
  const NullSpaceControl& control = *scene.null_space;
  const RobotModel model = RobotModel::FromUrdf(UrdfOf(scenario));
  RobotDynamics d(model);
  ComputeDynamics(model, sim.Get(scene.arm->measured_position),
                  sim.Get(scene.arm->measured_velocity), d);
  const PerJoint sum = PerJoint(d.gravity) + PerJoint(sim.Get(control.tool_torque)) +
                       PerJoint(sim.Get(control.null_space_torque));
  EXPECT_LT((sim.Get(control.torque) - sum).norm(), 1e-12);
  EXPECT_GT(sim.Get(control.tool_torque).norm(), 0.1);
}

TEST(NullSpaceControl, RunsWithEveryNullSpacePart) {
  for (const std::string part :
       {"!None {}", "!Printed {}", "!Meant {}", "!Observer {}", "!Observer {tool_gain: 1}",
        "!LeastSquares {}", "!LeastSquares {at: {link: link_4}}"}) {
    const Course course = Run({{"controller.null_space", part}, {"duration_s", "6"}});
    EXPECT_LT(course.off_path, 0.02) << part;  // the paper's figures are below 1 cm
    EXPECT_LT(course.joints, 1) << part;
  }
}

TEST(NullSpaceControl, DrivesTheMotorsOfAGen3) {
  const Course course = Run({{"robot", "gen3"},
                             {"controller.tool", "tool_frame"},
                             {"controller.motion.radius", "0.05"},
                             {"controller.orientation.damping", "[1, 1, 1]"},
                             {"controller.orientation.stiffness", "[40, 40, 40]"}});
  EXPECT_LT(course.off_path, 0.02);
  EXPECT_LT(course.off_turn, 0.2);
}

TEST(NullSpaceControl, RunsOffTheHeap) {
  for (const std::string part : {"!Meant {}", "!LeastSquares {at: {link: link_4}}"}) {
    const Scenario scenario = ScenarioIn({{"controller.null_space", part}});
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    for (int i = 0; i < 10; ++i) sim.AdvanceThroughTick();
    const long before = Allocations();
    for (int i = 0; i < 100; ++i) sim.AdvanceThroughTick();
    EXPECT_EQ(Allocations() - before, 0) << part;
  }
}

TEST(NullSpaceControl, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ErrorOfSetting({}), "no error");
  EXPECT_THAT(ErrorOfSetting({{"controller.tool", "end_effector"}}),
              HasSubstr("end_effector_link"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tracking.gain", "0"}}), HasSubstr("tracking.gain"));
  EXPECT_THAT(ErrorOfSetting({{"controller.motion.radius", "0"}}), HasSubstr("radius"));
  EXPECT_THAT(ErrorOfSetting({{"controller.null_space", "!LeastSquares {at: {link: elbow}}"}}),
              HasSubstr("elbow"));
  EXPECT_THAT(
      ErrorOfSetting({{"controller.motion",
                       "!Classical {position: [0.1, 0, 0], center: [0, 0, 0], normal: [1, 0, 0],"
                       " speed: 0.5}"}}),
      HasSubstr("normal must be perpendicular"));
}

}  // namespace
}  // namespace pliant
