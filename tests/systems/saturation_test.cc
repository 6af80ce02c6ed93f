#include "pliant/systems/saturation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Saturation, KeepsEachElementWithinItsBounds) {
  BlockTester<Saturation<JointTorque>> t({.space = kJoints, .lower = {-1, -2}, .upper = {1, 4}});
  t.Set(t->u, {0.5, 3});
  EXPECT_EQ(t.Get(t->y), (JointTorque{0.5, 3}));
  EXPECT_EQ(t.Get(t->saturated), PerJoint::Zero(2));
  t.Set(t->u, {1.5, -3});
  EXPECT_EQ(t.Get(t->y), (JointTorque{1, -2}));
  EXPECT_EQ(t.Get(t->saturated)(0), 1);
  EXPECT_EQ(t.Get(t->saturated)(1), -1);
}

TEST(Saturation, IsNotSaturatedAtABound) {
  BlockTester<Saturation<double>> t({.lower = -1, .upper = 1});
  t.Set(t->u, 1);
  EXPECT_EQ(t.Get(t->saturated), 0);
}

TEST(Saturation, FollowsBoundsSetWhileRunningAndUpperHoldsWhereTheyCross) {
  BlockTester<Saturation<double>> t({.lower = -1, .upper = 1});
  t.Set(t->u, 5);
  t.Set(t->upper, 3);
  EXPECT_EQ(t.Get(t->y), 3);
  t.Set(t->upper, -2);
  t.Set(t->u, -7);
  EXPECT_EQ(t.Get(t->y), -2);
}

TEST(Saturation, LetsNanThrough) {
  BlockTester<Saturation<double>> t({.lower = -1, .upper = 1});
  t.Set(t->u, std::nan(""));
  EXPECT_TRUE(std::isnan(t.Get(t->y)));
}

TEST(Saturation, RefusesBoundsThatCross) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Saturation<double>>({.lower = 1, .upper = -1}); }),
            "block: upper − lower must be >= 0, got -2");
}

TEST(Saturation, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<Saturation<JointTorque>>({.space = kJoints, .lower = {-1, -2}, .upper = {1, 4}}));
}

}  // namespace
}  // namespace pliant
