#include "pliant/systems/element.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(Element, PicksAJointByName) {
  BlockTester<Element<JointTorque>> t({.space = {"shoulder", "elbow"}, .element = "elbow"});
  t.Set(t->u, {1, 2});
  EXPECT_EQ(t.Get(t->y), 2);
}

TEST(Element, PicksAnElementOfASpatialVector) {
  BlockTester<Element<Wrench>> t({.space = "tool", .element = "fz"});
  t.Set(t->u, {1, 2, 3, 4, 5, 6});
  EXPECT_EQ(t.Get(t->y), 6);
}

TEST(Element, NamesTheNearestElement) {
  EXPECT_EQ(
      ErrorOf([] {
        BlockTester<Element<JointTorque>>({.space = {"shoulder", "elbow"}, .element = "elbw"});
      }),
      "block: there is no element 'elbw'; did you mean 'elbow'?");
  EXPECT_EQ(ErrorOf([] { BlockTester<Element<JointTorque>>({.element = "elbow"}); }),
            "block: there is no element 'elbow'");
}

TEST(Element, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Element<Wrench>>({.space = "tool", .element = "mx"}));
}

}  // namespace
}  // namespace pliant
