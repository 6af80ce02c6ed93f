#include "pliant/systems/filtered_derivative.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(FilteredDerivative, OfARampFollowsTheExactStepResponse) {
  BlockTester<FilteredDerivative<JointPosition>> t(
      {.space = kJoints, .cutoff_hz = 10, .period = 1ms});
  for (int k = 0; k <= 100; ++k) {
    t.Set(t->u, {5 + 2e-3 * k, -3e-3 * k});
    t.Tick();
    const double reached = 1 - std::exp(-2 * std::numbers::pi * 10 * k * 1e-3);
    EXPECT_NEAR(t.Get(t->y)(0), 2 * reached, 1e-11) << k;  // differences of 5 lose 4 digits
    EXPECT_NEAR(t.Get(t->y)(1), -3 * reached, 1e-12) << k;
  }
}

TEST(FilteredDerivative, RefusesBadOptions) {
  EXPECT_EQ(
      ErrorOf([] { BlockTester<FilteredDerivative<double>>({.cutoff_hz = 0, .period = 1ms}); }),
      "block: cutoff_hz must be > 0, got 0");
}

TEST(FilteredDerivative, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<FilteredDerivative<JointPosition>>(
      {.space = kJoints, .cutoff_hz = 10, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
