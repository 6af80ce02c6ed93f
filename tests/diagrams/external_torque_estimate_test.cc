#include "pliant/diagrams/external_torque_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/diagrams/scenario.h"
#include "pliant/systems/block_tester.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

/// An ideal Gen3 with a wrist sensor, held, and pushed for a second at a link: how far its estimate
/// is from the true torque at the end of the plateau, and how large that is [N·m].
struct Pushed {
  Pushed(TorqueEstimate estimate, const std::string& link) {
    ComplianceControl::Options control;
    control.tool = "FT_sensor_wrench";
    control.estimate = estimate;
    Push::Options push;
    push.link = link;
    push.force = {5, 12, -15};
    push.start_s = 0.1;
    push.duration_s = 1.2;
    Scenario scenario;
    scenario.robot = "gen3_bota";
    scenario.station = StationOptions{.ideal = true, .engine = SimbodyPlant::Engine::Recursive};
    scenario.controller = control;
    scenario.environment = {push};
    scenario.duration_s = 2;
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram);
    sim.AdvanceTo(1.1);
    const PerJoint truth = sim.Get(scene.true_torque->torque);
    error = (sim.Get(scene.control->external_torque) - truth).norm();
    size = truth.norm();
  }
  double error, size;
};

TEST(ExternalTorqueEstimate, FindsAPushAtTheWrist) {
  for (const auto estimate :
       {TorqueEstimate::True, TorqueEstimate::Observer, TorqueEstimate::SuperTwisting,
        TorqueEstimate::Fusion, TorqueEstimate::SuperTwistingFusion, TorqueEstimate::Sensor}) {
    const Pushed run(estimate, "FT_sensor_wrench");
    EXPECT_GT(run.size, 5);
    // What still moves under a steady push, and e^{−50·0.8} of the observer's lag, are far below.
    EXPECT_LT(run.error, 0.01 * run.size) << static_cast<int>(estimate);
  }
}

TEST(ExternalTorqueEstimate, FindsAPushBeforeTheSensorUnlessTheSensorIsAlone) {
  for (const auto estimate : {TorqueEstimate::Observer, TorqueEstimate::SuperTwisting,
                              TorqueEstimate::Fusion, TorqueEstimate::SuperTwistingFusion}) {
    const Pushed run(estimate, "forearm_link");
    EXPECT_LT(run.error, 0.01 * run.size) << static_cast<int>(estimate);
  }
  for (const auto estimate : {TorqueEstimate::Sensor, TorqueEstimate::Zero}) {
    const Pushed run(estimate, "forearm_link");
    EXPECT_NEAR(run.error, run.size, 0.05 * run.size) << static_cast<int>(estimate);
  }
}

/// Estimates of a Gen3 at rest, with any torques and any contact, while the sensor comes and goes.
TEST(ExternalTorqueEstimate, IsTheObserversWhileTheWrenchIsNotValid) {
  const RobotModel model = RobotModel::FromUrdf(kGen3BotaFile);
  RobotDynamics d(model);
  const JointPosition q{0, 0.26, 3.14, -2.27, 0, 0.96, 1.57};
  ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
  for (const auto estimate : {TorqueEstimate::Observer, TorqueEstimate::Fusion,
                              TorqueEstimate::SuperTwistingFusion, TorqueEstimate::Sensor}) {
    BlockTester<ExternalTorqueEstimate> t({.model = model,
                                           .period = 1ms,
                                           .estimate = estimate,
                                           .wrist = WristTool{.frame = "FT_sensor_wrench"}});
    RandomStates random(model, 19);
    t.Set(t->dynamics, d);
    for (int k = 0; k < 60; ++k) {
      const bool valid = k / 20 != 1;
      const Wrench contact = random.Uniform(20).head<6>();
      t.Set(t->torque, random.tau());
      t.Set(t->wrench, valid ? contact : Wrench(Vector6::Constant(std::nan(""))));
      t.Set(t->wrench_valid, valid);
      t.Tick();
      const JointTorque& found = t.Get(t->external_torque);
      ASSERT_TRUE(found.allFinite());
      if (valid) {
        ASSERT_EQ(t.Get(t->contact), contact);
        continue;
      }
      ASSERT_EQ(t.Get(t->contact), Wrench());
      if (estimate == TorqueEstimate::Sensor) {
        ASSERT_EQ(found, JointTorque::Zero(model.joints())) << k;
      } else {
        ASSERT_EQ(found, t.Get(t->residual)) << k;
      }
    }
  }
}

}  // namespace
}  // namespace pliant
