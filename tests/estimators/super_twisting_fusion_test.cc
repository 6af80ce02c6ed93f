#include "pliant/estimators/super_twisting_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/estimators/super_twisting_observer.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPeriod = 1e-3;

const Joints kJoints = Joints::Numbered(2);

SuperTwistingFusion::Options Options(double L) {
  return {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = 1ms};
}

/// An arm at rest with momentum p, for observers.
RobotDynamics Moving(double p) {
  RobotDynamics d;
  d.p = PerJoint::Constant(2, p);
  d.v = PerJoint::Constant(2, p);
  d.coriolis_transposed = d.gravity = JointTorque::Zero(kJoints);
  return d;
}

template <class T>
PerJoint Tick(BlockTester<T>& t, double p, double tau) {
  t.Set(t->dynamics, Moving(p));
  t.Set(t->torque, PerJoint::Constant(2, tau));
  t.Tick();
  return t.Get(t->residual);
}

// A push that rises seventy times faster than L, seen by the sensor, and a slow one that it does
// not see.
TEST(SuperTwistingFusion, FollowsAFastPushAtTheSensorAndASlowOneElsewhere) {
  const double L = 20, w = 150, a = 10, missed = kPeriod * kPeriod / 12 * a * w * w;
  const double w_slow = 4, a_slow = (L - missed * w) / w_slow;
  BlockTester<SuperTwistingFusion> t(Options(L));
  BlockTester<SuperTwistingObserver> alone(
      {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = 1ms});
  double fused = 0, observed = 0;
  for (int k = 0; k <= 4000; ++k) {
    const double s = k * kPeriod, fast = a * std::sin(w * s), slow = a_slow * std::sin(w_slow * s);
    const double p = a / w * (1 - std::cos(w * s)) + a_slow / w_slow * (1 - std::cos(w_slow * s));
    t.Set(t->sensor_torque, PerJoint::Constant(2, fast));
    Tick(t, p, 0);
    const PerJoint found = t.Get(t->external_torque);
    // the mean of a sample for its end, and the trapezoid for the mean
    ASSERT_LE((found.array() - fast - slow).abs().maxCoeff(), 0.5 * kPeriod * L + missed + 1e-10)
        << k;
    fused = std::max(fused, std::abs(found(0) - fast - slow));
    observed = std::max(observed, std::abs(Tick(alone, p, 0)(0) - fast - slow));
  }
  EXPECT_GT(observed, 0.5 * a) << "too fast for the observer alone";
  EXPECT_LT(fused, 0.01 * a);
}

TEST(SuperTwistingFusion, WithoutASensorIsTheObserver) {
  const double L = 50;
  BlockTester<SuperTwistingFusion> t(Options(L));
  BlockTester<SuperTwistingObserver> alone(
      {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = 1ms});
  RandomStates random(Gen3(), 71);
  t.Set(t->sensor_torque, JointTorque::Zero(kJoints));
  for (int k = 0; k < 1000; ++k) {
    const double p = random.Uniform(0.01)(0), tau = random.Uniform(3)(0);
    const PerJoint expected = Tick(alone, p, tau);
    ASSERT_EQ(Tick(t, p, tau), expected) << k;
    ASSERT_EQ(t.Get(t->external_torque), expected) << k;
  }
}

// An offset of the sensor is part of what σ finds, in the time that L gives it.
TEST(SuperTwistingFusion, TakesTheSensorsOffsetOff) {
  const double L = 20, offset = 3, k3 = 1.1 * L;
  BlockTester<SuperTwistingFusion> t(Options(L));
  t.Set(t->sensor_torque, PerJoint::Constant(2, offset));
  double settled = -1;
  for (int k = 0; k <= 1000; ++k) {
    Tick(t, 0, 0);
    const double error = std::abs(t.Get(t->external_torque)(0));
    if (error > 1e-12) settled = -1;
    if (error <= 1e-12 && settled < 0) settled = k * kPeriod;
  }
  EXPECT_GE(settled, offset / k3);
  EXPECT_LE(settled, 3 * offset / k3);  // as the observer of a step
}

// Bit for bit: what nobody takes for lost is added as it always was.
TEST(SuperTwistingFusion, IsTheObserverWithAKnownTorqueWhileTheSensorIsValid) {
  const double L = 50;
  BlockTester<SuperTwistingFusion> t(Options(L));
  BlockTester<SuperTwistingObserver> alone(
      {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = 1ms});
  RandomStates random(Gen3(), 73);
  PerJoint last = PerJoint::Zero(2);
  for (int k = 0; k < 1000; ++k) {
    const double p = random.Uniform(0.01)(0), tau = random.Uniform(3)(0);
    const PerJoint tau_s = PerJoint::Constant(2, random.Uniform(5)(0));
    const PerJoint sigma = Tick(alone, p, tau + 0.5 * (tau_s(0) + last(0)));
    last = tau_s;
    t.Set(t->sensor_torque, tau_s);
    ASSERT_EQ(Tick(t, p, tau), sigma) << k;
    ASSERT_EQ(t.Get(t->external_torque), JointTorque(tau_s + sigma)) << k;
  }
}

// A sensor that follows what acts, off by an offset, is lost for a while and comes back off by
// another: neither moves the sum by more than the observer moves it in a tick, and both outputs go
// on saying what they say.
TEST(SuperTwistingFusion, DoesNotJumpWhenTheSensorIsLostOrBack) {
  const double L = 100, h = kPeriod, a = 10, w = 5;  // a w < L
  BlockTester<SuperTwistingFusion> t(Options(L));
  double last = 0;
  for (int k = 0; k <= 3000; ++k) {
    const double s = k * h, acts = a * std::sin(w * s), p = a / w * (1 - std::cos(w * s));
    const bool valid = k < 1000 || k >= 2000;
    t.Set(t->sensor_torque, PerJoint::Constant(2, !valid     ? std::nan("")
                                                  : k < 1000 ? acts + 1
                                                             : acts - 4));
    t.Set(t->sensor_valid, valid);
    Tick(t, p, 0);
    const double found = t.Get(t->external_torque)(0), sigma = t.Get(t->residual)(0);
    if (k > 200) {
      // The observer alone tells the mean over the sample, half a sample late, and with the sensor
      // what is now, but for h²/12 a w²: one to the other is a sample and a half.
      ASSERT_NEAR(found, acts, 0.5 * h * a * w + 1e-4) << k;
      ASSERT_LE(std::abs(found - last), 1.5 * h * a * w + 1e-4) << k;
      const double rest = !valid ? acts : k < 1000 ? -1 : 4;
      ASSERT_NEAR(sigma, rest, 0.5 * h * a * w + 1e-4) << k;
    }
    if (!valid) {
      ASSERT_EQ(found, sigma) << k << ": the observer's alone";
    }
    last = found;
  }
}

// The first tick with a sensor again is, bit for bit, one without.
TEST(SuperTwistingFusion, IsTheObserversAtTheTickTheSensorIsBack) {
  RandomStates random(Gen3(), 9);
  for (const int lost : {1, 2, 10}) {
    BlockTester<SuperTwistingFusion> back(Options(50)), gone(Options(50));
    for (int k = 0; k <= 20 + lost; ++k) {
      const double p = random.Uniform(0.01)(0), tau = random.Uniform(3)(0);
      const JointTorque tau_s = random.Uniform(5).head(2);
      for (auto* t : {&back, &gone}) {
        (*t).Set((*t)->sensor_torque, tau_s);
        (*t).Set((*t)->sensor_valid, k < 20 || (t == &back && k == 20 + lost));
        Tick(*t, p, tau);
      }
      ASSERT_EQ(back.Get(back->external_torque), gone.Get(gone->external_torque)) << k;
    }
  }
}

TEST(SuperTwistingFusion, WithoutAValidSensorIsTheObserverFromTheStart) {
  const double L = 50;
  BlockTester<SuperTwistingFusion> t(Options(L));
  BlockTester<SuperTwistingObserver> alone(
      {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = 1ms});
  RandomStates random(Gen3(), 71);
  t.Set(t->sensor_torque, PerJoint::Constant(2, 30));
  t.Set(t->sensor_valid, false);
  for (int k = 0; k < 1000; ++k) {
    const double p = random.Uniform(0.01)(0), tau = random.Uniform(3)(0);
    const PerJoint expected = Tick(alone, p, tau);
    ASSERT_EQ(Tick(t, p, tau), expected) << k;
    ASSERT_EQ(t.Get(t->external_torque), expected) << k;
  }
}

TEST(SuperTwistingFusion, TakesRotorsOffTheMomentum) {
  SuperTwistingFusion::Options o = Options(100);
  o.rotor_inertia = PerJoint::Constant(2, 0.75);
  BlockTester<SuperTwistingFusion> t(o), quarter(Options(100));
  for (auto* each : {&t, &quarter}) each->Set((*each)->sensor_torque, JointTorque::Zero(kJoints));
  for (int k = 0; k < 200; ++k) {
    const double p = std::sin(0.05 * k);  // = v: M + B is 1
    const PerJoint expected = Tick(quarter, 0.25 * p, 0);
    ASSERT_LT((Tick(t, p, 0) - expected).norm(), 1e-11) << k;  // ε over h, and sums of it
  }
}

TEST(SuperTwistingFusion, RefusesRatesThatAreNone) {
  EXPECT_EQ(ErrorOf([] { SuperTwistingFusion fusion(Options(0)); }),
            "observer: rate[joint_1] must be > 0 N·m/s, got 0");
  SuperTwistingFusion::Options o = Options(1);
  o.rotor_inertia = PerJoint::Ones(3);
  EXPECT_EQ(ErrorOf([&] { SuperTwistingFusion fusion(o); }),
            "observer: rotor_inertia has an element for each of the 2 joints, got 3");
}

TEST(SuperTwistingFusion, HoldsTheLaws) {
  BlockTester<SuperTwistingFusion> t(Options(100));
  t.Set(t->dynamics, Moving(1));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
