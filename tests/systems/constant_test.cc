#include "pliant/systems/constant.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Constant, IsItsValueAndFollowsWhatIsSetWhileRunning) {
  BlockTester<Constant<JointTorque>> t({.space = kJoints, .value = {1, 2}});
  t.AdvanceTo(1);
  EXPECT_EQ(t.Get(t->y), (JointTorque{1, 2}));
  t.Set(t->value, {3, 4});
  EXPECT_EQ(t.Get(t->y), (JointTorque{3, 4}));
}

TEST(Constant, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Constant<JointTorque>>({.space = kJoints, .value = {1, 2}}));
}

}  // namespace
}  // namespace pliant
