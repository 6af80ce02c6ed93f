#include "pliant/systems/hold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Hold, KeepsASampleUntilTheNext) {
  DiagramBuilder b;
  auto& sine = b.Add<Sine<double>>("sine", {.amplitude = 1, .frequency_hz = 1});
  auto& hold = b.Add<Hold<double>>("hold", {.before = -7, .period = 100ms, .offset = 50ms});
  b.Connect(sine.y, hold.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(hold.y), -7);
  for (const double t : {0.06, 0.1, 0.15}) {  // ends before the tick at 0.15
    sim.AdvanceTo(t);
    EXPECT_DOUBLE_EQ(sim.Get(hold.y), std::sin(2 * std::numbers::pi * 0.05));
  }
  sim.AdvanceTo(0.151);
  EXPECT_DOUBLE_EQ(sim.Get(hold.y), std::sin(2 * std::numbers::pi * 0.15));
}

TEST(Hold, HoldsValuesOfAnyType) {
  BlockTester<Hold<Pose>> t({.space = "base", .period = 1ms});
  t.Set(t->u, Pose{.position = {1, 2, 3}});
  t.Tick();
  EXPECT_EQ(t.Get(t->y).position, Eigen::Vector3d(1, 2, 3));
}

TEST(Hold, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Hold<JointTorque>>({.space = kJoints, .period = 3ms}));
}

}  // namespace
}  // namespace pliant
