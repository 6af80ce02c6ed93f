#include "pliant/systems/ramp.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Ramp, GoesStraightFromStartToGoal) {
  BlockTester<Ramp<JointPosition>> t(
      {.space = kJoints, .start = {1, 0}, .goal = {3, -1}, .at = 100ms, .duration = 200ms});
  for (int ms = 0; ms <= 400; ms += 25) {
    t.AdvanceTo(ms / 1e3);
    const double part = std::clamp((ms - 100) / 200.0, 0.0, 1.0);
    EXPECT_NEAR(t.Get(t->y)(0), 1 + 2 * part, 1e-14);  // round-off only
    EXPECT_NEAR(t.Get(t->y)(1), -part, 1e-14);
  }
  EXPECT_EQ(t.Get(t->y), (JointPosition{3, -1}));
}

TEST(Ramp, FollowsAGoalSetWhileRunning) {
  BlockTester<Ramp<double>> t({.goal = 2, .duration = 1s});
  t.AdvanceTo(0.5);
  t.Set(t->goal, 4);
  EXPECT_EQ(t.Get(t->y), 2);
}

TEST(Ramp, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Ramp<double>>({.goal = 1, .duration = 0ms}); }),
            "block: duration must be > 0, got 0 s");
}

TEST(Ramp, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Ramp<double>>({.goal = 1, .at = 100ms, .duration = 200ms}));
}

}  // namespace
}  // namespace pliant
