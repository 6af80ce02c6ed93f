#include "pliant/systems/table.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

const TimeTable kTable{.columns = {"a", "b", "c"},
                       .times = {1, 2, 4},
                       .cells = {0, 10, 100,  //
                                 2, 20, 200,  //
                                 6, 0, 300}};

TEST(Table, IsLinearBetweenRowsAndConstantOutside) {
  BlockTester<Table<JointPosition>> t({.space = kJoints, .table = kTable, .columns = {"b", "a"}});
  EXPECT_EQ(t.Get(t->y), (JointPosition{10, 0}));
  t.AdvanceTo(1);
  EXPECT_EQ(t.Get(t->y), (JointPosition{10, 0}));
  t.AdvanceTo(1.5);
  EXPECT_EQ(t.Get(t->y), (JointPosition{15, 1}));
  t.AdvanceTo(2);
  EXPECT_EQ(t.Get(t->y), (JointPosition{20, 2}));
  t.AdvanceTo(3);
  EXPECT_EQ(t.Get(t->y), (JointPosition{10, 4}));
  t.AdvanceTo(9);
  EXPECT_EQ(t.Get(t->y), (JointPosition{0, 6}));
}

TEST(Table, PlaysASingleColumnAsANumber) {
  BlockTester<Table<double>> t({.table = kTable, .columns = {"c"}});
  t.AdvanceTo(3);
  EXPECT_EQ(t.Get(t->y), 250);
}

TEST(Table, RefusesColumnsThatDoNotFit) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Table<JointPosition>>({.space = kJoints, .table = kTable}); }),
            "block: columns must be as many as the signal has elements, 2, got 3");
  EXPECT_EQ(ErrorOf([] { BlockTester<Table<double>>({.table = kTable, .columns = {"cc"}}); }),
            "block: the table has no column 'cc'; did you mean 'c'?");
  EXPECT_EQ(ErrorOf([] { BlockTester<Table<double>>({.table = {}, .columns = {"c"}}); }),
            "block: table must have a row");
}

TEST(Table, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Table<double>>({.table = kTable, .columns = {"c"}}));
}

}  // namespace
}  // namespace pliant
