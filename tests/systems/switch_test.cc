#include "pliant/systems/switch.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Switch, ShowsOneOfTwo) {
  BlockTester<Switch<JointTorque>> t({.space = kJoints});
  t.Set(t->on, {1, 2});
  t.Set(t->off, {3, 4});
  t.Set(t->select, true);
  EXPECT_EQ(t.Get(t->y), (JointTorque{1, 2}));
  t.Set(t->select, false);
  EXPECT_EQ(t.Get(t->y), (JointTorque{3, 4}));
}

TEST(Switch, HoldsTheLaws) { ExpectBlockLaws(BlockTester<Switch<double>>({})); }

}  // namespace
}  // namespace pliant
