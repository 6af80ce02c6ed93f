#include "pliant/diagrams/compliance_control.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/diagrams/scenario.h"
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
  control.pose.compliance = pose;
  control.posture.compliance = posture;
  control.estimate = estimate;
  return {.robot = "gen3",
          .station = StationOptions{.ideal = true, .engine = SimbodyPlant::Engine::Recursive},
          .controller = control,
          .environment = {PushOf("forearm_link", {0, 20, 0}, 0.1),
                          PushOf("tool_frame", {0, 0, -20}, 0.4)},
          .duration_s = 1};
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
