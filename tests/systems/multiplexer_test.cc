#include "pliant/systems/multiplexer.h"

#include <gtest/gtest.h>

#include "pliant/systems/demultiplexer.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};

TEST(Multiplexer, PutsNumbersOfAnyTypesInOneColumn) {
  BlockTester<Multiplexer> t({.names = Names::Numbered(5)});
  const auto& q = t.Join(t->u, JointPosition{1.0, 2.0}, kTwo);
  t.Join(t->u, 3.0);
  t.Join(t->u, JointVelocity{4.0, 5.0}, kTwo);
  EXPECT_EQ(t.Get(t->y), (NumberVector{1.0, 2.0, 3.0, 4.0, 5.0}));
  t.Set(q, {-1.0, -2.0});
  EXPECT_EQ(t.Get(t->y), (NumberVector{-1.0, -2.0, 3.0, 4.0, 5.0}));
}

TEST(Multiplexer, NeedsANameForEachNumber) {
  BlockTester<Multiplexer> t({.names = Names::Numbered(4)});
  t.Join(t->u, JointPosition{1.0, 2.0}, kTwo);
  t.Join(t->u, 3.0);
  EXPECT_EQ(ErrorOf([&] { t.simulator(); }),
            "block: names must be as many as the numbers that are wired to it, 3, got 4\n"
            "  joined_1.y: 2\n  joined_2.y: 1");
}

TEST(Multiplexer, KeepsTheLawsOfBlocks) {
  BlockTester<Multiplexer> t({.names = Names::Numbered(3)});
  t.Join(t->u, JointPosition{1.0, 2.0}, kTwo);
  t.Join(t->u, 3.0);
  ExpectBlockLaws(std::move(t));
}

TEST(Demultiplexer, TakesATypedValueOut) {
  BlockTester<Demultiplexer<JointVelocity>> velocity(
      {.names = Names::Numbered(5), .space = kTwo, .first = 2});
  velocity.Set(velocity->u, {1.0, 2.0, 3.0, 4.0, 5.0});
  EXPECT_EQ(velocity.Get(velocity->y), (JointVelocity{3.0, 4.0}));
  BlockTester<Demultiplexer<double>> last({.names = Names::Numbered(5), .first = 4});
  last.Set(last->u, {1.0, 2.0, 3.0, 4.0, 5.0});
  EXPECT_EQ(last.Get(last->y), 5);
}

TEST(Demultiplexer, RefusesWhatIsNotThere) {
  for (const int first : {-1, 4})
    EXPECT_EQ(ErrorOf([&] {
                BlockTester<Demultiplexer<JointVelocity>>(
                    {.names = Names::Numbered(5), .space = kTwo, .first = first});
              }),
              "block: first must be from 0 to 3, since y takes 2 of 5 numbers, got " + Text(first));
}

TEST(Demultiplexer, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<Demultiplexer<JointVelocity>>(
      {.names = Names::Numbered(3), .space = kTwo, .first = 1}));
}

TEST(Names, AreAtMostAsManyAsAVectorHolds) {
  EXPECT_EQ(Names::Numbered(2)[1], "x2");
  EXPECT_EQ(ErrorOf([] { Names::Numbered(kMaxNumbers + 1); }),
            "a vector has at most " + Text(kMaxNumbers) + " numbers, got " + Text(kMaxNumbers + 1));
}

}  // namespace
}  // namespace pliant
