#include "pliant/controllers/torque_to_current.h"

#include <gtest/gtest.h>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"first", "second"};
const TorqueToCurrent::Options kMotors{.joints = kTwo,
                                       .torque_per_ampere = Eigen::Vector2d(10, 8),
                                       .current_limit = {2, 5},
                                       .period = 1ms};

TEST(TorqueToCurrent, CutsAtTheLimitAndSaysWhichJoints) {
  BlockTester<TorqueToCurrent> t(kMotors);
  const auto at = [&](JointTorque tau, MotorCurrent i, JointBits cut) {
    t.Set(t->torque, tau);
    EXPECT_EQ(t.Get(t->current), i);
    EXPECT_EQ(t.Get(t->saturated), cut);
  };
  at({20, -40}, {2, -5}, 0);
  at({20.5, -40}, {2, -5}, 1);
  at({-30, -40.5}, {-2, -5}, 3);
  at({0, 41}, {0, 5}, 2);
}

TEST(TorqueToCurrent, SaysAtTheNextTickToWhichSideItCut) {
  BlockTester<TorqueToCurrent> t(kMotors);
  t.Set(t->torque, {25, -41});
  EXPECT_EQ(t.Get(t->side), PerJoint(Eigen::Vector2d(0, 0)));
  t.Tick();
  EXPECT_EQ(t.Get(t->side), PerJoint(Eigen::Vector2d(1, -1)));
  t.Set(t->torque, {5, 5});
  t.Tick();
  EXPECT_EQ(t.Get(t->side), PerJoint(Eigen::Vector2d(0, 0)));
}

TEST(TorqueToCurrent, CutsNothingWithoutLimits) {
  TorqueToCurrent::Options o = kMotors;
  o.current_limit = {};
  BlockTester<TorqueToCurrent> t(o);
  t.Set(t->torque, {1e6, -8e6});
  EXPECT_EQ(t.Get(t->current), MotorCurrent({1e5, -1e6}));
  EXPECT_EQ(t.Get(t->saturated), 0U);
}

TEST(TorqueToCurrent, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<TorqueToCurrent>(kMotors), {.amplitude = 100});
}

TEST(TorqueToCurrent, RefusesLimitsThatAreNone) {
  const auto error = [](auto change) {
    TorqueToCurrent::Options o = kMotors;
    change(o);
    return ErrorOf([&] { TorqueToCurrent motors(o); });
  };
  using O = TorqueToCurrent::Options;
  EXPECT_EQ(error([](O& o) { o.torque_per_ampere(0) = 0; }),
            "torque_per_ampere[first] must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](O& o) { o.current_limit(1) = -5; }),
            "current_limit[second] must be > 0 A, got -5");
  EXPECT_EQ(error([](O& o) { o.current_limit = {1}; }),
            "current_limit has an element for each of the 2 joints, got 1");
}

}  // namespace
}  // namespace pliant
