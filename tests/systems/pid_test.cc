#include "pliant/systems/pid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

using Position = Pid<JointPosition, JointTorque>;
using Number = Pid<double, double>;

Number::Options Gains(double kp, double ki, double kd) {
  return {.kp = kp,
          .ki = ki,
          .kd = kd,
          .filter_s = 0.01,
          .tracking_time_s = 0.1,
          .lower = -100,
          .upper = 100,
          .period = 1ms};
}

TEST(Pid, WithKpAloneIsAGainForEachJoint) {
  BlockTester<Position> t({.space = kJoints,
                           .kp = PerJoint{{10.0, 20.0}},
                           .ki = PerJoint::Zero(2),
                           .kd = PerJoint::Zero(2),
                           .filter_s = 0,
                           .tracking_time_s = 0.1,
                           .lower = {-5, -5},
                           .upper = {5, 5},
                           .period = 1ms});
  t.Set(t->reference, {1, 0.1});
  t.Set(t->measured, {0.8, 0.2});
  t.Tick();
  EXPECT_NEAR(t.Get(t->u)(0), 2, 1e-14);  // round-off only
  EXPECT_NEAR(t.Get(t->u)(1), -2, 1e-14);
  t.Set(t->measured, {0, 2});
  t.Tick();
  EXPECT_EQ(t.Get(t->u), (JointTorque{5, -5}));
}

TEST(Pid, IntegratesTheErrorWithOneTickOfDelay) {
  BlockTester<Number> t(Gains(0, 4, 0));
  t.Set(t->reference, 0.5);
  t.Set(t->measured, 0);
  for (int k = 0; k < 100; ++k) {
    t.Tick();
    EXPECT_NEAR(t.Get(t->u), 4 * 0.5 * k * 1e-3, 1e-14);  // round-off only
  }
}

TEST(Pid, DampsARampByItsFilteredRate) {
  BlockTester<Number> t(Gains(0, 0, 3));
  t.Set(t->reference, 0);
  for (int k = 0; k <= 200; ++k) {
    t.Set(t->measured, 2 * k * 1e-3);
    t.Tick();
    const double filtered = 1 - std::pow(0.01 / 0.011, k);    // backward Euler, Tf = 10 h
    EXPECT_NEAR(t.Get(t->u), -3 * 2 * filtered, 1e-11) << k;  // differences of 1e-3 lose 3 digits
  }
}

TEST(Pid, GivesNoKickAtTheStartNorAtAStepOfTheReference) {
  BlockTester<Number> t(Gains(0, 0, 3));
  t.Set(t->measured, 7);
  t.Set(t->reference, 0);
  t.Tick();
  EXPECT_EQ(t.Get(t->u), 0);
  t.Set(t->reference, 10);
  t.Tick();
  EXPECT_EQ(t.Get(t->u), 0);
}

TEST(Pid, SettlesItsIntegralByBackCalculation) {
  BlockTester<Number> t(Gains(2, 4, 0));
  t.Set(t->reference, 1);
  t.Set(t->measured, 0);
  t.Set(t->upper, 1);
  t.AdvanceTo(5);  // 50 tracking times
  // İ = ki e + (u − v)/Tt = 0 at v = u + Tt ki e = 1.4, so I = v − kp e
  t.Set(t->upper, 100);
  t.Tick();
  EXPECT_NEAR(t.Get(t->u), 1.4, 1e-12);
}

TEST(Pid, KeepsTheIntegralOfAnElementWithoutKi) {
  BlockTester<Number> t(Gains(2, 0, 0));
  t.Set(t->reference, 1);
  t.Set(t->measured, 0);
  t.Set(t->upper, 1);
  t.AdvanceTo(5);
  t.Set(t->upper, 100);
  t.Tick();
  EXPECT_EQ(t.Get(t->u), 2);
}

TEST(Pid, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] {
              Number::Options o = Gains(1, 1, 1);
              o.filter_s = -1;
              BlockTester<Number> t(o);
            }),
            "block: filter_s must be >= 0, got -1");
  EXPECT_EQ(ErrorOf([] {
              Number::Options o = Gains(1, 1, 1);
              o.tracking_time_s = 1e-4;
              BlockTester<Number> t(o);
            }),
            "block: tracking_time_s must be >= the period, got 0.0001");
  EXPECT_EQ(ErrorOf([] {
              Number::Options o = Gains(1, 1, 1);
              o.upper = -101;
              BlockTester<Number> t(o);
            }),
            "block: upper − lower must be >= 0, got -1");
}

TEST(Pid, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Number>(Gains(2, 4, 3)));
  ExpectBlockLaws(BlockTester<Position>({.space = kJoints,
                                         .kp = PerJoint::Ones(2),
                                         .ki = PerJoint::Ones(2),
                                         .kd = PerJoint::Ones(2),
                                         .filter_s = 0.01,
                                         .tracking_time_s = 0.1,
                                         .lower = {-5, -5},
                                         .upper = {5, 5},
                                         .period = 1ms}));
}

}  // namespace
}  // namespace pliant
