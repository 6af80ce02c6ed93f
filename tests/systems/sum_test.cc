#include "pliant/systems/sum.h"

#include <gtest/gtest.h>

#include <utility>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Sum, AddsAndSubtracts) {
  BlockTester<Sum<JointTorque>> t({.space = kJoints});
  t.Join(t->plus, {1, 10});
  t.Join(t->plus, {2, 20});
  t.Join(t->minus, {5, 5});
  EXPECT_EQ(t.Get(t->y), (JointTorque{-2, 25}));
}

TEST(Sum, OfNothingIsZero) {
  BlockTester<Sum<JointTorque>> t({.space = kJoints});
  EXPECT_EQ(t.Get(t->y), (JointTorque{0, 0}));
  BlockTester<Sum<double>> number({});
  EXPECT_EQ(number.Get(number->y), 0);
}

TEST(Sum, HoldsTheLaws) {
  BlockTester<Sum<double>> t({});
  t.Join(t->plus, 1);
  t.Join(t->minus, 2);
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
