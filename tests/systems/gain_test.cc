#include "pliant/systems/gain.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Gain, ScalesEachElementIntoAnotherQuantity) {
  BlockTester<Gain<JointVelocity, JointTorque>> t({.space = kJoints, .gain = -3});
  t.Set(t->u, {1, 2});
  EXPECT_EQ(t.Get(t->y), (JointTorque{-3, -6}));
}

TEST(Gain, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Gain<JointTorque>>({.space = kJoints, .gain = 2}));
  ExpectBlockLaws(BlockTester<Gain<double>>({.gain = 2}));
}

}  // namespace
}  // namespace pliant
