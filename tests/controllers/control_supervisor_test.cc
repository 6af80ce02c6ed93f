#include "pliant/controllers/control_supervisor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/controllers/current_fade.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using enum ArmControl;
const Joints kTwo{"first", "second"};

struct Arm {
  explicit Arm(ArmControl first, JointBits continuous = 0)
      : t{ControlSupervisor::Options{
            .joints = kTwo, .start = {0.1, 0.2}, .first = first, .continuous = continuous}} {
    t.Set(t->wanted, first);
    t.Set(t->reference, {0, 0});
    t.Set(t->measured_position, {0, 0});
    t.Set(t->measured_velocity, {0, 0});
  }
  ArmControl After(ArmControl wanted, int ticks = 1) {
    t.Set(t->wanted, wanted);
    for (int k = 0; k < ticks; ++k) t.Tick();
    return t.Get(t->control);
  }
  BlockTester<ControlSupervisor> t;
};

TEST(ControlSupervisor, LetsTorquesMoveAnArmThatIsWhereItIsToBe) {
  Arm arm(Position);
  EXPECT_EQ(arm.After(Position), Position);
  EXPECT_EQ(arm.t.Get(arm.t->mode), ControlMode::Position);
  EXPECT_FALSE(arm.t.Get(arm.t->follow));
  arm.t.Set(arm.t->measured_position, {0.03, 0.05});
  EXPECT_EQ(arm.After(KinovaTorque), Position);
  arm.t.Set(arm.t->measured_position, {0.03, 0.03});
  EXPECT_EQ(arm.After(KinovaTorque), KinovaTorque);
  EXPECT_EQ(arm.t.Get(arm.t->mode), ControlMode::Current);
  EXPECT_TRUE(arm.t.Get(arm.t->follow));
}

TEST(ControlSupervisor, ChangesTorqueLoopsAtOnce) {
  Arm arm(ProposedTorque);
  arm.t.Set(arm.t->measured_velocity, {1, 1});
  EXPECT_EQ(arm.After(KinovaTorque), KinovaTorque);
  EXPECT_EQ(arm.After(ProposedTorque), ProposedTorque);
}

TEST(ControlSupervisor, BrakesBeforeItHoldsPositions) {
  for (const ArmControl from : {KinovaTorque, ProposedTorque}) {
    Arm arm(from);
    arm.t.Set(arm.t->measured_velocity, {0.2, 0});
    arm.After(from, 1000);
    EXPECT_EQ(arm.t.Get(arm.t->posture), JointPosition({0.1, 0.2}));
    arm.t.Set(arm.t->measured_position, {0.5, 0.6});
    EXPECT_EQ(arm.After(Position), from);
    EXPECT_TRUE(arm.t.Get(arm.t->braking));
    arm.t.Set(arm.t->measured_position, {0.6, 0.6});
    EXPECT_EQ(arm.After(Position, 500), from);
    EXPECT_EQ(arm.t.Get(arm.t->posture), JointPosition({0.5, 0.6})) << "where braking began";
    // From 0.2 to 0.01 rad/s a filter of 5 Hz takes ln 20/(2π 5) s = 95.4 ms.
    arm.t.Set(arm.t->measured_velocity, {0, 0});
    EXPECT_EQ(arm.After(Position, 95), from);
    EXPECT_EQ(arm.After(Position, 1), Position);
    EXPECT_FALSE(arm.t.Get(arm.t->braking));
  }
}

TEST(ControlSupervisor, StopsBrakingWhereTorquesAreWantedAgain) {
  Arm arm(ProposedTorque);
  arm.t.Set(arm.t->measured_velocity, {0.2, 0});
  arm.After(ProposedTorque, 1000);
  arm.After(Position);
  EXPECT_TRUE(arm.t.Get(arm.t->braking));
  EXPECT_EQ(arm.After(KinovaTorque), KinovaTorque);
  EXPECT_FALSE(arm.t.Get(arm.t->braking));
}

TEST(ControlSupervisor, FollowsAnArmThatIsHeldAndBrakesUnderPositionControl) {
  for (const ArmControl control : {Position, KinovaTorque}) {
    Arm arm(control);
    for (const bool held : {false, true, false}) {
      arm.t.Set(arm.t->held, held);
      EXPECT_EQ(arm.After(control), control);
      EXPECT_EQ(arm.t.Get(arm.t->braking), held && control == Position);
      EXPECT_EQ(arm.t.Get(arm.t->follow), held || control != Position);
    }
  }
}

TEST(ControlSupervisor, DoesNotCountWholeTurnsOfJointsWithoutLimits) {
  Arm arm(Position, 0b01);
  arm.t.Set(arm.t->reference, {3.15, 0});
  arm.t.Set(arm.t->measured_position, {3.15 - 2 * std::numbers::pi, 0});
  EXPECT_EQ(arm.After(ProposedTorque), ProposedTorque);
  Arm limited(Position, 0b10);
  limited.t.Set(limited.t->reference, {3.15, 0});
  limited.t.Set(limited.t->measured_position, {3.15 - 2 * std::numbers::pi, 0});
  EXPECT_EQ(limited.After(ProposedTorque), Position);
}

TEST(ControlSupervisor, TakesAVelocityThatIsNoNumberForMotion) {
  Arm arm(ProposedTorque);
  arm.t.Set(arm.t->measured_velocity, {NAN, 0});
  EXPECT_EQ(arm.After(Position, 1000), ProposedTorque);
  arm.t.Set(arm.t->measured_velocity, {0, 0});
  EXPECT_EQ(arm.After(Position, 1000), Position);
}

TEST(ControlSupervisor, TakesNothingFromTheHeapAndRepeatsItself) {
  Arm arm(ProposedTorque);
  arm.t.Set(arm.t->measured_velocity, {0.2, 0});
  arm.After(ProposedTorque);
  const Context start = arm.t.simulator().Snapshot();
  const long before = Allocations();
  for (int k = 0; k < 100; ++k) arm.t.Tick();
  EXPECT_EQ(Allocations() - before, 0);
  const Context end = arm.t.simulator().Snapshot();
  arm.t.simulator().Restore(start);
  for (int k = 0; k < 100; ++k) arm.t.Tick();
  EXPECT_TRUE(arm.t.simulator().Snapshot() == end);
}

TEST(ControlSupervisor, RefusesSettingsThatAreNone) {
  const auto error = [](ControlSupervisor::Settings s) {
    return ErrorOf([&] {
      ControlSupervisor block({.joints = kTwo, .start = {0, 0}, .settings = s});
    });
  };
  EXPECT_EQ(error({.tracked_within = 0}), "tracked_within must be > 0 rad, got 0");
  EXPECT_EQ(error({.rest_speed = -1}), "rest_speed must be > 0 rad/s, got -1");
  EXPECT_EQ(error({.filter_hz = 0}), "filter_hz must be > 0 Hz, got 0");
  EXPECT_EQ(ErrorOf([] { ControlSupervisor block({.joints = kTwo, .start = {0}}); }),
            "start has an element for each of the 2 joints, got 1");
}

TEST(CurrentFade, KeepsTheCurrentAtAChangeAndMovesItByAPartATick) {
  const double part = 1e-3 / 0.5;
  BlockTester<CurrentFade> t(CurrentFade::Options{.joints = kTwo, .period = 1ms});
  t.Set(t->control, Position);
  t.Set(t->kinova, {1, 0});
  t.Set(t->proposed, {-3, 2});
  t.Set(t->measured_current, {4, 4});
  t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({4, 4}));
  MotorCurrent last = t.Get(t->current);
  double most = 0;
  for (const ArmControl control : {ProposedTorque, KinovaTorque, ProposedTorque}) {
    t.Set(t->control, control);
    t.Tick();
    EXPECT_LT((t.Get(t->current) - PerJoint(last)).norm(), 1e-15);
    most = std::max(most, last.norm() + 5);
    for (int k = 0; k < 200; ++k) {
      last = t.Get(t->current);
      t.Tick();
      ASSERT_LT((t.Get(t->current) - PerJoint(last)).norm(), part * most);
    }
    last = t.Get(t->current);
  }
  for (int k = 0; k < 500; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({-3, 2}));
}

TEST(CurrentFade, ReportsTheCutsOfTheLoopThatMovesTheArm) {
  BlockTester<CurrentFade> t(CurrentFade::Options{.joints = kTwo, .period = 1ms});
  for (const auto* in : {&t->kinova, &t->proposed, &t->measured_current}) t.Set(*in, {0, 0});
  t.Set(t->kinova_saturated, 1);
  t.Set(t->proposed_saturated, 2);
  for (const auto& [control, cut] :
       {std::pair{Position, 0U}, {KinovaTorque, 1U}, {ProposedTorque, 2U}}) {
    t.Set(t->control, control);
    EXPECT_EQ(t.Get(t->saturated), cut);
  }
}

TEST(CurrentFade, LosesNoJointToASampleThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BlockTester<CurrentFade> t(CurrentFade::Options{.joints = kTwo, .period = 1ms});
  t.Set(t->control, Position);
  t.Set(t->kinova, {0, 0});
  t.Set(t->proposed, {-3, 2});
  t.Set(t->measured_current, {nan, 4});
  t.Tick();
  t.Set(t->control, ProposedTorque);
  t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({-3, 4})) << "the first without a fade";
  t.Set(t->kinova, {nan, 1});
  t.Set(t->control, KinovaTorque);
  t.Tick();
  EXPECT_EQ(t.Get(t->current)(1), 4);
  t.Set(t->kinova, {1, 1});
  t.Tick();
  EXPECT_EQ(t.Get(t->current)(0), 1);
  for (int k = 0; k < 500; ++k) t.Tick();
  t.Set(t->kinova, {1, nan});
  t.Tick();
  t.Set(t->kinova, {1, 2});
  t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({1, 2}));
}

TEST(CurrentFade, CutsTheSumAtTheLimitsAndSaysSo) {
  BlockTester<CurrentFade> t(
      CurrentFade::Options{.joints = kTwo, .current_limit = {5, 5}, .period = 1ms});
  t.Set(t->control, ProposedTorque);
  t.Set(t->measured_current, {0, 0});
  t.Set(t->proposed, {-5, 0});
  t.Set(t->kinova, {0, 0});
  t.Tick();
  t.Set(t->control, KinovaTorque);
  t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({-5, 0}));
  EXPECT_EQ(t.Get(t->saturated), 0U);
  t.Set(t->kinova, {-4, 0});  // within its own limits, and − 5 on top
  t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({-5, 0}));
  EXPECT_EQ(t.Get(t->saturated), 1U);
  for (int k = 0; k < 500; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->current), MotorCurrent({-4, 0}));
  EXPECT_EQ(t.Get(t->saturated), 0U);
}

TEST(CurrentFade, RefusesATimeThatIsNone) {
  EXPECT_EQ(ErrorOf([] {
              CurrentFade fade({.joints = kTwo, .current_limit = {5, 0}, .period = 1ms});
            }),
            "current_limit[second] must be > 0 A, got 0");
  EXPECT_EQ(ErrorOf([] { CurrentFade fade({.joints = kTwo, .change_s = 0, .period = 1ms}); }),
            "change_s must be > 0 s, got 0");
}

}  // namespace
}  // namespace pliant
