#include "pliant/diagrams/friction_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kText = R"(robot: gen3
station: !SimulatedArm {position: [0, 0, 0, 0, 0, 0, 0], engine: recursive}
controller: !FrictionExperiment
  joints: [joint_5, joint_6]
  speeds: 2
  settle_s: 0.3
  dwell_s: 0.1
  break_aways: 1
  ramp_s: 0.5
integrator: {method: dormand_prince}
duration_s: 40
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

/// What joints did while one of them was tested, by measurements.
struct Course {
  explicit Course(const Scenario& scenario) {
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    for (; sim.time() < scenario.duration_s;) {
      sim.AdvanceThroughTick();
      report = sim.Get(scene.friction->report);
      if (report.phase == FrictionPhase::Done || report.phase == FrictionPhase::Stopped) break;
      const JointVelocity& v = sim.Get(scene.arm->measured_velocity);
      const JointPosition& q = sim.Get(scene.arm->measured_position);
      fastest = fastest.cwiseMax(v);
      slowest = slowest.cwiseMin(v);
      if (report.phase == FrictionPhase::Return) continue;
      for (int j = 0; j < 7; ++j)
        if (j != report.joint)
          held_off = std::max(held_off, std::abs(std::remainder(q(j), 2 * std::numbers::pi)));
    }
  }

  FrictionReport report;
  PerJoint fastest = PerJoint::Zero(7), slowest = PerJoint::Zero(7);
  double held_off = 0;
};

// With friction that sticks, elastic gears and noise.
TEST(FrictionExperiment, CoversTheSpeedsOfASimulatedGen3) {
  const Course course(ScenarioIn());
  ASSERT_EQ(course.report.phase, FrictionPhase::Done) << int(course.report.stop);
  for (const int j : {4, 5}) {
    EXPECT_GT(course.fastest(j), 0.95 * 0.8 * 3.049) << j;
    EXPECT_LT(course.slowest(j), -0.95 * 0.8 * 3.049) << j;
    EXPECT_LT(std::max(course.fastest(j), -course.slowest(j)), 3.049) << j;
  }
  // The loop, p = 8 1/s, lets a joint of 0.22 kg·m² give 1/(3 p² 0.22) = 24 mrad to 1 N·m. Joints
  // that stick are pushed by less than half of that beyond their friction.
  EXPECT_LT(course.held_off, 12e-3);
  for (const int j : {0, 1, 2, 3, 6})
    EXPECT_LT(std::max(course.fastest(j), -course.slowest(j)), 0.1) << j;
}

TEST(FrictionExperiment, KeepsTheLimitsOfAnArmWithoutFriction) {
  const Course course(ScenarioIn({{"station.ideal", "true"}}));
  ASSERT_EQ(course.report.phase, FrictionPhase::Done) << int(course.report.stop);
  EXPECT_LT(course.fastest.cwiseMax(-course.slowest).maxCoeff(), 3.049);
  EXPECT_LT(course.held_off, 5e-3);
}

TEST(FrictionExperiment, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ErrorOfSetting({}), "no error");
  EXPECT_THAT(ErrorOfSetting({{"duration_s", "5"}}),
              AllOf(StartsWith("duration_s must be >= "),
                    HasSubstr(" s for the joints and speeds of !FrictionExperiment, got 5")));
  EXPECT_EQ(ErrorOfSetting({{"schedule", "[{at_s: 1, mode: position}]"}}),
            "schedule must be empty: !FrictionExperiment commands currents all along");
  EXPECT_THAT(ErrorOfSetting({{"robot", "lwr"}}),
              StartsWith("!FrictionExperiment commands currents, and robot 'lwr' takes torques"));
  EXPECT_THAT(ErrorOfSetting({{"controller.joints", "[joint_9]"}}), HasSubstr("joint_9"));
}

TEST(FrictionExperiment, IsNoCompliance) {
  EXPECT_EQ(ErrorOf([] { ComplianceOf(ScenarioIn().controller); }),
            "it is about a controller of the kind !Compliance, got !FrictionExperiment");
}

TEST(FrictionOfAFile, IsThatOfTheListAndWhatTheControllerAssumes) {
  const Scenario scenario =
      ScenarioIn({{"station.friction", "[{joint: joint_2, coulomb: 4, viscous: 2, stiction: 5}]"}});
  const SimulatedArm::Options arm = StationOf(scenario);
  EXPECT_EQ(arm.actuators.joint[1].friction.coulomb, 4);
  EXPECT_EQ(arm.actuators.joint[1].friction.stiction, 5);
  EXPECT_EQ(arm.actuators.joint[0].friction.coulomb, 3) << "of the file, where the list says none";
  const auto assumed = [&](const Scenario& of) {
    return std::get<FrictionExperiment::Options>(ControllerOf(of, StationOf(of))).coulomb;
  };
  EXPECT_EQ(assumed(scenario)(1), 4);
  const Scenario other =
      ScenarioIn({{"assumed_friction", "[{joint: joint_2, coulomb: 3.5, stiction: 3.5}]"}});
  EXPECT_EQ(StationOf(other).actuators.joint[1].friction.coulomb, 3);
  EXPECT_EQ(assumed(other)(1), 3.5);
  EXPECT_EQ(assumed(other)(0), 3);
}

TEST(FrictionOfAFile, IsWhatTheTorqueLoopOfACompliantControllerAssumes) {
  const Scenario scenario =
      ScenarioIn({{"controller", "!Compliance {tool: tool_frame}"},
                  {"assumed_friction", "[{joint: joint_2, coulomb: 3.5, viscous: 2}]"}});
  const ArmController controller = ControllerOf(scenario, StationOf(scenario));
  const FrictionCompensation::Options& friction = ComplianceOf(controller).low_level->friction;
  EXPECT_EQ(friction.coulomb(1), 3.5);
  EXPECT_EQ(friction.viscous(1), 2);
  EXPECT_EQ(friction.coulomb(0), 3);
}

TEST(FrictionOfAFile, IsRefusedWhereNothingCompensatesIt) {
  const Scenario scenario = ScenarioIn({{"controller", "!Compliance {tool: tool_frame}"},
                                        {"station", "!SimulatedArm {ideal: true}"},
                                        {"assumed_friction", "[{joint: joint_2, coulomb: 3.5}]"}});
  EXPECT_EQ(ErrorOf([&] { ControllerOf(scenario, StationOf(scenario)); }),
            "assumed_friction is of the loop that makes currents of torques, and this arm takes "
            "torques; leave it out, or give a robot such as gen3 and a station that is not ideal");
}

TEST(FrictionOfAFile, RefusesJointsThatAreNotThereOrTwice) {
  EXPECT_THAT(ErrorOfSetting({{"station.friction", "[{joint: joint_8, coulomb: 4}]"}}),
              HasSubstr("joint_8"));
  EXPECT_EQ(
      ErrorOfSetting({{"assumed_friction", "[{joint: joint_1, coulomb: 4}, {joint: joint_1}]"}}),
      "friction has each joint once, got 'joint_1' twice");
}

}  // namespace
}  // namespace pliant
