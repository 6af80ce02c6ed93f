#include "pliant/diagrams/compliance_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "pliant/diagrams/stations.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Outcome = ComplianceQpReport::Outcome;

ComplianceLoop::Options Options(double pose, double posture, TorqueEstimate estimate) {
  const RobotModel m = Gen3();
  const JointPosition home{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};
  ComplianceLoop::Options o{
      .model = m,
      .tool = "tool_frame",
      .arm = SimulatedGen3(
          m, {.position = home, .ideal = true, .engine = SimbodyPlant::Engine::Recursive}),
      .pose_compliance = pose,
      .posture_compliance = posture,
      .estimate = estimate,
      .damper = {.model = m}};
  o.pushes = {
      {.model = m, .link = "forearm_link", .force = {0, 20, 0}, .start_s = 0.1, .duration_s = 0.6},
      {.model = m, .link = "tool_frame", .force = {0, 0, -20}, .start_s = 0.4, .duration_s = 0.6}};
  return o;
}

/// The largest deviations of a second in which elbow and tool are pushed.
struct Moved {
  explicit Moved(const ComplianceLoop::Options& o) {
    const ComplianceLoop loop(o);
    Simulator sim(loop.diagram);
    for (int k = 0; k < 1000; ++k) {
      sim.AdvanceThroughTick();
      const RobotDynamics& d = sim.Get(loop.dynamics->dynamics);
      joints = std::max(joints, (d.q - o.arm.position).norm());
      tool = std::max(tool, sim.Get(loop.pose->error).norm());
      solved += sim.Get(loop.qp->report).outcome == Outcome::Solved;
      const JointTorque gap = sim.Get(loop.observer->residual) - sim.Get(loop.true_torque->torque);
      estimate = std::max(estimate, gap.norm());
    }
  }
  double joints = 0, tool = 0, estimate = 0;
  int solved = 0;
};

TEST(ComplianceLoop, DoesNotMoveWithoutComplianceWhenItKnowsThePush) {
  const Moved run(Options(0, 0, TorqueEstimate::True));
  // Round-off in τ, some 10⁻¹⁴ N·m, against the spring of the pose and a damped null space.
  EXPECT_LT(run.joints, 1e-11);
  EXPECT_LT(run.tool, 1e-11);
  EXPECT_EQ(run.solved, 1000);
}

TEST(ComplianceLoop, YieldsWhereItIsAskedTo) {
  const Moved stiff(Options(0, 0, TorqueEstimate::Observer));
  const Moved null_space(Options(0, 1, TorqueEstimate::Observer));
  const Moved full(Options(1, 1, TorqueEstimate::Observer));
  EXPECT_GT(null_space.joints, 5 * stiff.joints);
  EXPECT_LT(null_space.tool, 5 * stiff.tool);
  EXPECT_GT(full.tool, 5 * null_space.tool);
  for (const Moved* run : {&stiff, &null_space, &full}) EXPECT_EQ(run->solved, 1000);
}

TEST(ComplianceLoop, WithFullComplianceMovesAsWithoutAnyEstimate) {
  // EC V: Γ = I cancels the compensation of (8).
  const Moved known(Options(1, 1, TorqueEstimate::True));
  const Moved ignored(Options(0, 0, TorqueEstimate::Zero));
  EXPECT_GT(known.tool, 1e-3);
  EXPECT_NEAR(known.tool, ignored.tool, 1e-6 * known.tool);  // the integrator's tolerance
  EXPECT_NEAR(known.joints, ignored.joints, 1e-6 * known.joints);
}

TEST(ComplianceLoop, SamplesPushesAtTheControllersTicks) {
  ComplianceLoop::Options o = Options(0, 0, TorqueEstimate::True);
  o.arm.period = 4ms;
  const ComplianceLoop loop(o);
  Simulator sim(loop.diagram);
  for (int k = 0; k < 250; ++k) sim.AdvanceThroughTick();
  EXPECT_NEAR(sim.time(), 0.996, 1e-12);
  EXPECT_LT(sim.Get(loop.pose->error).norm(), 1e-11);
}

TEST(ComplianceLoop, TakesNothingFromTheHeapAndRepeatsItselfBitForBit) {
  ComplianceLoop::Options o = Options(0.5, 1, TorqueEstimate::Observer);
  o.log_rows = 1000;
  const ComplianceLoop loop(o);
  Simulator sim(loop.diagram);
  sim.AdvanceTo(0.2);
  const Context snapshot = sim.Snapshot();
  const long before = Allocations();
  sim.AdvanceTo(0.6);
  EXPECT_EQ(Allocations() - before, 0);
  const JointTorque first = sim.Get(loop.qp->torque);
  const Context end = sim.Snapshot();
  sim.Restore(snapshot);
  sim.AdvanceTo(0.6);
  EXPECT_EQ(sim.Get(loop.qp->torque), first);
  EXPECT_TRUE(sim.Snapshot() == end);
}

TEST(ComplianceLoop, RefusesAnArmThatCarriesItsOwnWeight) {
  ComplianceLoop::Options o = Options(0, 0, TorqueEstimate::Observer);
  o.arm.firmware.compensated = o.model;
  EXPECT_EQ(ErrorOf([&] { ComplianceLoop loop(o); }),
            "the arm must not carry its own weight: the controller commands gravity; reset "
            "arm.firmware.compensated");
}

TEST(LowLevelTorqueOf, RefusesActuatorsOfAnotherArm) {
  EXPECT_EQ(ErrorOf([] { LowLevelTorqueOf({}, Gen3(), 1ms); }),
            "actuators has an element for each of the 7 joints, got 0");
}

}  // namespace
}  // namespace pliant
