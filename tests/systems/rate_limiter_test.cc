#include "pliant/systems/rate_limiter.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(RateLimiter, RisesAndFallsNoFasterThanItsLimits) {
  BlockTester<RateLimiter<JointTorque>> t({.space = kJoints,
                                           .rise = PerJoint{{10.0, 20.0}},
                                           .fall = PerJoint{{1.0, 2.0}},
                                           .period = 1ms});
  t.Set(t->u, {1, -1});
  for (int k = 1; k <= 100; ++k) {
    t.Tick();
    EXPECT_NEAR(t.Get(t->y)(0), 10 * k * 1e-3, 1e-14);  // round-off only
    EXPECT_NEAR(t.Get(t->y)(1), -2 * k * 1e-3, 1e-14);
  }
}

TEST(RateLimiter, FollowsWhatIsSlower) {
  BlockTester<RateLimiter<double>> t({.rise = 10, .fall = 10, .initial = 3, .period = 10ms});
  t.Set(t->u, 3.05);
  t.Tick();
  EXPECT_EQ(t.Get(t->y), 3.05);
  t.Set(t->u, 3);
  t.Tick();
  EXPECT_EQ(t.Get(t->y), 3);
}

TEST(RateLimiter, RefusesBadOptions) {
  EXPECT_EQ(
      ErrorOf([] { BlockTester<RateLimiter<double>>({.rise = -1, .fall = 1, .period = 1ms}); }),
      "block: every rise must be >= 0, got -1");
  EXPECT_EQ(
      ErrorOf([] { BlockTester<RateLimiter<double>>({.rise = 1, .fall = -2, .period = 1ms}); }),
      "block: every fall must be >= 0, got -2");
}

TEST(RateLimiter, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<RateLimiter<JointTorque>>(
      {.space = kJoints, .rise = PerJoint::Ones(2), .fall = PerJoint::Ones(2), .period = 1ms}));
}

}  // namespace
}  // namespace pliant
