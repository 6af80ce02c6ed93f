#include "pliant/systems/leaky_integrator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(LeakyIntegrator, FollowsTheExactStepResponse) {
  BlockTester<LeakyIntegrator<JointTorque>> t({.space = kJoints,
                                               .gain = PerJoint{{10.0, 5.0}},
                                               .time_constant_s = 2,
                                               .limit = {100, 100},
                                               .period = 1ms});
  t.Set(t->u, {0.3, -0.2});
  for (const double time : {0.1, 1.0, 5.0}) {
    t.AdvanceTo(time);
    const double reached = 1 - std::exp(-time / 2);
    EXPECT_NEAR(t.Get(t->y)(0), 3 * reached, 1e-12);  // round-off of 5000 ticks
    EXPECT_NEAR(t.Get(t->y)(1), -1 * reached, 1e-12);
  }
}

TEST(LeakyIntegrator, IsTheTwoStepFormWithTheClampedValueFedBack) {
  const double a = std::exp(-1e-3 / 0.1), g = 10, limit = 4.75;
  BlockTester<LeakyIntegrator<double>> t(
      {.gain = g, .time_constant_s = 0.1, .limit = limit, .period = 1ms});
  double l = 0;
  for (int k = 0; k < 500; ++k) {
    const double e = std::sin(0.02 * k);
    t.Set(t->u, e);
    t.Tick();
    const double s = a * l / g + (1 - a) * e;
    l = std::clamp(g * s, -limit, limit);
    EXPECT_NEAR(t.Get(t->y), l, 1e-13);  // round-off only
  }
}

TEST(LeakyIntegrator, LeavesItsLimitWithoutWindingUp) {
  BlockTester<LeakyIntegrator<double>> t(
      {.gain = 10, .time_constant_s = 2, .limit = 4.75, .period = 1ms});
  t.Set(t->u, 5);
  t.AdvanceTo(10);
  EXPECT_EQ(t.Get(t->y), 4.75);
  t.Set(t->u, -5);
  t.Tick();
  const double a = std::exp(-1e-3 / 2);
  EXPECT_NEAR(t.Get(t->y), a * 4.75 - (1 - a) * 50, 1e-13);  // round-off only
}

TEST(LeakyIntegrator, FollowsALimitSetWhileRunning) {
  BlockTester<LeakyIntegrator<double>> t(
      {.gain = 10, .time_constant_s = 0.01, .limit = 4.75, .period = 1ms});
  t.Set(t->u, 5);
  t.Set(t->limit, 1);
  t.AdvanceTo(1);
  EXPECT_EQ(t.Get(t->y), 1);
}

TEST(LeakyIntegrator, RefusesBadOptions) {
  using Block = LeakyIntegrator<double>;
  EXPECT_EQ(ErrorOf([] {
              BlockTester<Block>({.gain = 1, .time_constant_s = 0, .limit = 1, .period = 1ms});
            }),
            "block: time_constant_s must be > 0, got 0");
  EXPECT_EQ(ErrorOf([] {
              BlockTester<Block>({.gain = 1, .time_constant_s = 1, .limit = -1, .period = 1ms});
            }),
            "block: every limit must be >= 0, got -1");
}

TEST(LeakyIntegrator, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<LeakyIntegrator<JointTorque>>({.space = kJoints,
                                                             .gain = PerJoint::Ones(2),
                                                             .time_constant_s = 2,
                                                             .limit = {1, 1},
                                                             .period = 1ms}));
}

}  // namespace
}  // namespace pliant
