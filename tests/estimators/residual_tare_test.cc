#include "pliant/estimators/residual_tare.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

ResidualTare::Options Options(double from_s, double until_s) {
  return {.joints = kJoints, .period = 10ms, .from_s = from_s, .until_s = until_s};
}

TEST(ResidualTare, TakesOffTheMeanOfItsWindow) {
  BlockTester<ResidualTare> t(Options(0.1, 0.2));
  for (int k = 0; k <= 30; ++k) {  // r rises by 1 N·m a tick: the mean of ticks 10 to 19 is 14.5
    t.Set(t->residual, {1.0 * k, -2.0});
    t.Tick();
    EXPECT_EQ(t.Get(t->ready), k >= 20);
    const PerJoint expected = k < 20 ? PerJoint::Zero(2) : PerJoint(JointTorque{k - 14.5, 0.0});
    EXPECT_LT((t.Get(t->tared) - expected).norm(), 1e-13) << k;
  }
}

TEST(ResidualTare, LeavesTheResidualAsItIsWhereThereIsNoWindow) {
  BlockTester<ResidualTare> t(Options(0.5, 0));
  t.Set(t->residual, {3.0, -1.0});
  t.Tick();
  EXPECT_TRUE(t.Get(t->ready));
  EXPECT_EQ(t.Get(t->tared), (JointTorque{3.0, -1.0}));
}

TEST(ResidualTare, TakesTheMeanOfWhatAreNumbers) {
  BlockTester<ResidualTare> t(Options(0, 0.1));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 10; ++k) {  // 0, 2, 4, 6 and 8, whose mean is 4
    t.Set(t->residual, {1.0 * k, k % 2 == 0 ? 1.0 : nan});
    t.Tick();
  }
  t.Set(t->residual, {5.0, 1.0});
  t.Tick();
  EXPECT_TRUE(t.Get(t->ready));
  EXPECT_EQ(t.Get(t->tared), (JointTorque{1.0, 0.0}));
}

TEST(ResidualTare, RefusesAWindowWithoutASample) {
  EXPECT_EQ(ErrorOf([] { ResidualTare tare(Options(0.5, 0.5)); }),
            "until_s must be 0 or a period after from_s, 0.5 s, got 0.5");
  EXPECT_EQ(ErrorOf([] { ResidualTare tare(Options(-1, 0.5)); }), "from_s must be >= 0 s, got -1");
}

TEST(ResidualTare, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<ResidualTare>(Options(0.02, 0.05)));
}

}  // namespace
}  // namespace pliant
