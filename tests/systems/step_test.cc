#include "pliant/systems/step.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/hold.h"
#include "pliant/systems/integral.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Step, StepsAtItsTime) {
  BlockTester<Step<JointTorque>> t(
      {.space = kJoints, .before = {1, 2}, .after = {3, 4}, .at = 100ms});
  EXPECT_EQ(t.Get(t->y), (JointTorque{1, 2}));
  t.AdvanceTo(0.1);  // ends before the step
  EXPECT_EQ(t.Get(t->y), (JointTorque{1, 2}));
  t.Tick();
  EXPECT_EQ(t.time(), 0.1);
  EXPECT_EQ(t.Get(t->y), (JointTorque{3, 4}));
  t.AdvanceTo(1e9);
  EXPECT_EQ(t.Get(t->y), (JointTorque{3, 4}));
}

TEST(Step, IsZeroBeforeUnlessToldOtherwise) {
  BlockTester<Step<double>> t({.after = 3, .at = 100ms});
  EXPECT_EQ(t.Get(t->y), 0);
}

TEST(Step, FollowsLevelsSetWhileRunning) {
  BlockTester<Step<double>> t({.after = 3});
  t.Tick();
  t.Set(t->after, 5);
  EXPECT_EQ(t.Get(t->y), 5);
}

TEST(Step, IsSeenByWhatSamplesAtItsInstant) {
  DiagramBuilder b;
  auto& step = b.Add<Step<double>>("step", {.after = 1, .at = 10ms});
  auto& hold = b.Add<Hold<double>>("hold", {.period = 10ms});
  b.Connect(step.y, hold.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.011);
  EXPECT_EQ(sim.Get(hold.y), 1);
}

TEST(Step, IsIntegratedExactly) {
  DiagramBuilder b;
  auto& step = b.Add<Step<double>>("step", {.before = 1, .after = -2, .at = 333ms});
  auto& integral = b.Add<Integral<double>>("integral", {});
  b.Connect(step.y, integral.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  EXPECT_NEAR(sim.Get(integral.y), 0.333 - 2 * 0.667, 1e-14);  // constant rates: round-off only
}

TEST(Step, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Step<JointTorque>>({.space = kJoints, .after = {3, 4}, .at = 300ms}));
}

}  // namespace
}  // namespace pliant
