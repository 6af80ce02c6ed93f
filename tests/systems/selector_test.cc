#include "pliant/systems/selector.h"

#include <gtest/gtest.h>

#include <utility>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Selector, ShowsOneOfMany) {
  BlockTester<Selector<JointTorque>> t({.space = kJoints});
  t.Join(t->u, {1, 10});
  t.Join(t->u, {2, 20});
  t.Join(t->u, {3, 30});
  for (int i = 0; i < 3; ++i) {
    t.Set(t->select, i);
    EXPECT_EQ(t.Get(t->y), (JointTorque{i + 1.0, 10.0 * (i + 1)}));
    EXPECT_TRUE(t.Get(t->in_range));
  }
}

TEST(Selector, ShowsTheNearerEndForANumberOutOfRange) {
  BlockTester<Selector<double>> t({});
  t.Join(t->u, 1);
  t.Join(t->u, 2);
  t.Set(t->select, -1);
  EXPECT_EQ(t.Get(t->y), 1);
  EXPECT_FALSE(t.Get(t->in_range));
  t.Set(t->select, 2);
  EXPECT_EQ(t.Get(t->y), 2);
  EXPECT_FALSE(t.Get(t->in_range));
}

TEST(Selector, OfNothingIsZero) {
  BlockTester<Selector<JointTorque>> t({.space = kJoints});
  t.Set(t->select, 0);
  EXPECT_EQ(t.Get(t->y), (JointTorque{0, 0}));
  EXPECT_FALSE(t.Get(t->in_range));
}

TEST(Selector, HoldsTheLaws) {
  BlockTester<Selector<double>> t({});
  t.Join(t->u, 1);
  t.Join(t->u, 2);
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
