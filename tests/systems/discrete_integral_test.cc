#include "pliant/systems/discrete_integral.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(DiscreteIntegral, AddsUpSamples) {
  BlockTester<DiscreteIntegral<JointPosition>> t(
      {.space = kJoints, .initial = {5, 0}, .period = 10ms});
  double sum = 0;
  for (int k = 0; k < 50; ++k) {
    t.Set(t->u, {1.0 * k, -1});
    t.Tick();
    sum += 0.01 * k;
    EXPECT_NEAR(t.Get(t->y)(0), 5 + sum, 1e-13);  // round-off only
    EXPECT_NEAR(t.Get(t->y)(1), -0.01 * (k + 1), 1e-13);
  }
}

TEST(DiscreteIntegral, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<DiscreteIntegral<JointPosition>>({.space = kJoints, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
