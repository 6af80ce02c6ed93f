#include "pliant/diagrams/law_diagram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "pliant/plants/parameter_file.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Scenario PushedArm(const std::string& station = "{ideal: true, engine: recursive}",
                   const std::string& robot = "gen3") {
  Scenario scenario;
  ParameterFile::ReadText(
      "robot: " + robot + "\nstation: !SimulatedArm " + station +
      "\ncontroller: !Compliance {tool: " + (robot == "gen3" ? "tool_frame" : "end_effector_link") +
      "}\nduration_s: 1\n")
      .Fill(scenario);
  return scenario;
}

TorqueLaw::Function GravityOf(const RobotModel& model) {
  return [model](double, const JointPosition& q, const JointVelocity& v, const JointTorque&) {
    RobotDynamics d(model);
    ComputeDynamics(model, q, v, d);
    return d.gravity;
  };
}

TEST(LawDiagram, AsksTheLawOncePerTickWithTheTimeOfTheTick) {
  std::vector<double> times;
  LawDiagram scene(PushedArm(),
                   [&](double t, const JointPosition& q, const JointVelocity&, const JointTorque&) {
                     times.push_back(t);
                     return JointTorque(0 * q);
                   });
  const Diagram diagram = scene.builder.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0035);
  EXPECT_THAT(times, ElementsAre(0, 0.001, 0.002, 0.003));
}

TEST(LawDiagram, HoldsAnArmThatRestsByTheTorqueOfItsWeightAlone) {
  const Scenario scenario = PushedArm();
  LawDiagram scene(scenario, GravityOf(RobotOf(scenario)));
  const Diagram diagram = scene.builder.Build();
  Simulator sim{diagram};
  const JointPosition start = sim.Get(scene.arm->position);
  sim.AdvanceTo(0.5);
  EXPECT_LT((sim.Get(scene.arm->position) - start).norm(), 1e-6);  // the integrator's tolerances
}

TEST(LawDiagram, TakesTheWeightOffAgainWhereTheArmCarriesItItself) {
  const Scenario scenario = PushedArm("{engine: recursive}", "lwr");
  LawDiagram scene(scenario, GravityOf(RobotOf(scenario)));
  const Diagram diagram = scene.builder.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.01);
  const JointTorque command =
      sim.Get(scene.arm->torque_command);  // behind what is left of the weight
  EXPECT_LT(command.norm(), 0.01 * sim.Get(scene.control->torque).norm());  // sensors' noise
}

TEST(LawDiagram, LetsOutWhatTheLawThrows) {
  LawDiagram scene(PushedArm(),
                   [](double t, const JointPosition& q, const JointVelocity&, const JointTorque&) {
                     if (t > 0.0015) throw std::domain_error("mine");
                     return JointTorque(0 * q);
                   });
  const Diagram diagram = scene.builder.Build();
  Simulator sim{diagram};
  EXPECT_THROW(sim.AdvanceTo(0.01), std::domain_error);
  EXPECT_EQ(sim.time(), 0.002);
}

TEST(LawDiagram, RefusesATorqueOfAnotherSizeAndAnArmThatIsThere) {
  LawDiagram scene(PushedArm(), [](double, const JointPosition&, const JointVelocity&,
                                   const JointTorque&) { return JointTorque{1.0}; });
  const Diagram diagram = scene.builder.Build();
  Simulator sim{diagram};
  EXPECT_THAT(ErrorOf([&] { sim.AdvanceTo(0.01); }),
              HasSubstr("a law gives a torque for each of (joint_1, joint_2, joint_3, joint_4, "
                        "joint_5, joint_6, joint_7) [N·m], got 1"));
  Scenario there = PushedArm();
  there.station = Gen3Station{};
  EXPECT_THAT(ErrorOf([&] { LawDiagram(there, GravityOf(RobotOf(there))); }),
              HasSubstr("an arm that is there"));
  EXPECT_THAT(ErrorOf([&] { LawDiagram(PushedArm(), {}); }), HasSubstr("function must be given"));
}

}  // namespace
}  // namespace pliant
