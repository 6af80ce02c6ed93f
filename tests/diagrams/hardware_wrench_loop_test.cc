#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "pliant/diagrams/external_torque_estimate.h"
#include "pliant/diagrams/rdt_emulator.h"
#include "pliant/plants/hardware_wrench.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/rdt_source.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

/// A Gen3 that holds itself up, and the estimate that hears of its sensor.
struct Loop {
  HardwareWrench& wrist;
  ExternalTorqueEstimate& estimate;
  Diagram diagram;
};

Loop MakeLoop(const std::string& address, int port) {
  const RobotModel model = RobotModel::FromUrdf(kGen3BotaFile);
  const JointPosition q{0, 0.26, 3.14, -2.27, 0, 0.96, 1.57};
  RobotDynamics at_rest(model);
  ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), at_rest);
  DiagramBuilder b;
  auto& position =
      b.Add<Constant<JointPosition>>("position", {.space = model.joints(), .value = q});
  auto& velocity = b.Add<Constant<JointVelocity>>(
      "velocity", {.space = model.joints(), .value = JointVelocity::Zero(model.joints())});
  auto& torque =
      b.Add<Constant<JointTorque>>("torque", {.space = model.joints(), .value = at_rest.gravity});
  auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = model});
  auto& estimate =
      b.Add<ExternalTorqueEstimate>("estimate", {.model = model,
                                                 .period = 1ms,
                                                 .estimate = TorqueEstimate::Fusion,
                                                 .wrist = WristTool{.frame = "FT_sensor_wrench"}});
  // shown: begin
  const auto sensor =
      std::make_shared<RdtSource>(RdtSource::Options{.host = address, .port = port});
  auto& wrist = b.Add<HardwareWrench>("wrist", {.source = sensor, .frame = "FT_sensor_wrench"});
  b.Connect(wrist.wrench, estimate.wrench);
  b.Connect(wrist.valid, estimate.wrench_valid);
  // shown: end
  b.Connect(position.y, dynamics.position);
  b.Connect(velocity.y, dynamics.velocity);
  b.Connect(dynamics.dynamics, estimate.dynamics);
  b.Connect(torque.y, estimate.torque);
  return {wrist, estimate, b.Build()};
}

// The sensor ticks beside the diagram. From 0.3 s on its records are lost, from 0.7 s on it
// measures nothing new, for 0.2 s each.
TEST(HardwareWrench, FeedsTheFusionAndLeavesItToTheObserverWhileItIsGone) {
  RdtEmulator sensor({.port = 0,
                      .faults = {{.kind = "lost", .start_s = 0.2995, .duration_s = 0.2},
                                 {.kind = "frozen", .start_s = 0.6995, .duration_s = 0.2}}});
  Loop loop = MakeLoop("127.0.0.1", sensor.port());
  Simulator sim(loop.diagram);
  int now = 0, back = 0;
  bool valid = false;
  const auto tick_to = [&](int k) {
    for (; now < k; ++now) {
      sensor.Tick({0, 0, 0, 0, 0, now < 100 ? -1.0 : -30.0});
      sim.AdvanceThroughTick();
      const bool was = valid;
      valid = sim.Get(loop.wrist.valid);
      if (valid && (was || now < 50)) continue;
      // None, or the first again: the observer's alone, with no rounding.
      if (now > 50 && valid) ++back;
      if (now > 50) {
        ASSERT_EQ(sim.Get(loop.estimate.external_torque), sim.Get(loop.estimate.residual)) << now;
      }
    }
  };
  const auto contact = [&] { return sim.Get(loop.estimate.contact); };

  tick_to(100);
  EXPECT_TRUE(valid);
  EXPECT_EQ(contact(), Wrench({0, 0, 0, 0, 0, -1}));
  tick_to(110);
  EXPECT_EQ(contact(), Wrench({0, 0, 0, 0, 0, -30}));
  EXPECT_GT((sim.Get(loop.estimate.external_torque) - sim.Get(loop.estimate.residual)).norm(), 1)
      << "a push that the observer does not see yet";
  // 10 ms of it pass unnoticed.
  for (const auto& [from, to] : {std::pair{300, 500}, {700, 900}}) {
    tick_to(from);
    EXPECT_TRUE(valid) << from;
    tick_to(from + 20);
    EXPECT_FALSE(valid) << from;
    EXPECT_EQ(contact(), Wrench()) << from;
    EXPECT_EQ(sim.Get(loop.wrist.wrench), Wrench({0, 0, 0, 0, 0, -30})) << "held";
    tick_to(to);
    EXPECT_FALSE(valid) << from;
    tick_to(to + 10);
    EXPECT_TRUE(valid) << from;
    EXPECT_EQ(contact(), Wrench({0, 0, 0, 0, 0, -30})) << from;
  }
  EXPECT_EQ(back, 2);
  EXPECT_EQ(sim.Get(loop.wrist.status).link, (LinkCounts{.lost = 200}));
}

}  // namespace
}  // namespace pliant
