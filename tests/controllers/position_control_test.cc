#include "pliant/controllers/position_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

PositionControl::Options Gains(const Joints& joints) {
  const PerJoint ones = PerJoint::Ones(joints.size());
  return {.joints = joints,
          .stiffness = 100 * ones,
          .damping = 20 * ones,
          .integral = 50 * ones,
          .acceleration_limit = 10 * ones,
          .torque_limit = kUnbounded * ones,
          .period = 1ms};
}

RobotDynamics At(const RobotModel& model, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(model);
  ComputeDynamics(model, q, v, d);
  return d;
}

/// A unit inertia per joint, no weight: a closed form.
RobotDynamics Free(const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d;
  d.q = q;
  d.v = v;
  d.M = JointMatrix::Identity(q.size(), q.size());
  d.gravity = d.coriolis = PerJoint::Zero(q.size());
  return d;
}

const Joints kTwo{"first", "second"};

TEST(PositionControl, KeepsItsIntegralWhereAMeasurementIsNoNumber) {
  BlockTester<PositionControl> t(Gains(kTwo));
  t.Set(t->reference, {0.05, 0});
  t.Set(t->dynamics, Free({0, 0}, {0, 0}));
  for (int k = 0; k < 10; ++k) t.Tick();
  const JointAcceleration before = t.Get(t->acceleration);
  t.Set(t->dynamics, Free({std::nan(""), 0}, {0, 0}));
  t.Tick();
  t.Set(t->dynamics, Free({0, 0}, {0, 0}));
  t.Tick();
  // One more sample of integration than before the gap: 50 · 0.05 · 1e-3 rad/s².
  EXPECT_NEAR(t.Get(t->acceleration)(0) - before(0), 2.5e-3, 1e-12);
  EXPECT_EQ(t.Get(t->acceleration)(1), 0);
}

TEST(PositionControl, AsksForTheAccelerationOfItsLawAndTheTorqueOfTheModel) {
  const RobotModel model = Gen3();
  const Joints& joints = model.joints();
  BlockTester<PositionControl> t(Gains(joints));
  JointPosition q = JointPosition::Zero(joints), r = q;
  JointVelocity v = JointVelocity::Zero(joints), r_dot = v;
  JointAcceleration a_r = JointAcceleration::Zero(joints);
  for (int j = 0; j < 7; ++j) {
    q(j) = 0.1 * j, r(j) = q(j) + 0.01 * (j - 3);
    v(j) = 0.05 * j, r_dot(j) = 0.02 * j;
    a_r(j) = 0.3 * j;
  }
  const RobotDynamics d = At(model, q, v);
  t.Set(t->reference, r);
  t.Set(t->reference_velocity, r_dot);
  t.Set(t->reference_acceleration, a_r);
  t.Set(t->dynamics, d);
  t.Tick();
  const PerJoint a = a_r + 100 * PerJoint(r - q) + 20 * PerJoint(r_dot - v);
  EXPECT_LT((t.Get(t->acceleration) - a).norm(), 1e-12);
  EXPECT_LT((t.Get(t->torque) - InverseDynamics(d, a)).norm(), 1e-12);
  EXPECT_EQ(t.Get(t->saturated), 0U);
  for (int k = 0; k < 100; ++k) t.Tick();
  // ∫ of a constant error over 100 ticks before this one, each of h
  const PerJoint I = 0.1 * 50 * PerJoint(r - q);
  EXPECT_LT((t.Get(t->acceleration) - a - I).norm(), 1e-12);
}

// A closed-form joint, q̈ = q̈_c + w with w constant: at rest the integral has taken w over.
TEST(PositionControl, LeavesNoErrorToAConstantLoad) {
  BlockTester<PositionControl> t(Gains(kTwo));
  JointPosition q{0, 0};
  JointVelocity v{0, 0};
  const JointAcceleration w{3, -2};
  const double h = 1e-3;
  t.Set(t->reference, {0.05, 0});
  for (int k = 0; k < 20000; ++k) {
    t.Set(t->dynamics, Free(q, v));
    t.Tick();
    const PerJoint a = t.Get(t->acceleration) + w;
    q += h * v + 0.5 * h * h * a;
    v += h * a;
  }
  // The slowest pole of s³ + 20 s² + 100 s + 50 is 0.55 1/s: exp(−11).
  EXPECT_LT((q - PerJoint(Eigen::Vector2d(0.05, 0))).norm(), 1e-5);
  EXPECT_LT((t.Get(t->acceleration) + w).norm(), 1e-4);
}

TEST(PositionControl, DoesNotWindUpWhileItIsCut) {
  for (const bool by_torque : {false, true}) {
    PositionControl::Options o = Gains(kTwo);
    if (by_torque) {
      o.acceleration_limit.setConstant(1e3);
      o.torque_limit.setConstant(10);  // of unit inertias: the same cut
    }
    BlockTester<PositionControl> t(o);
    t.Set(t->reference, {1, -0.01});
    t.Set(t->dynamics, Free({0, 0}, {0, 0}));
    for (int k = 0; k < 5000; ++k) t.Tick();
    EXPECT_EQ(t.Get(t->saturated), 1U);
    EXPECT_EQ(t.Get(t->torque)(0), 10);
    // Where the error has gone, nothing is left to be worked off.
    t.Set(t->dynamics, Free({1, 0}, {0, 0}));
    t.Tick();
    EXPECT_EQ(t.Get(t->acceleration)(0), 0);
    EXPECT_EQ(t.Get(t->saturated), 0U);
  }
}

TEST(PositionControl, TakesNothingFromTheHeapAndRepeatsItself) {
  const RobotModel model = Gen3();
  BlockTester<PositionControl> t(Gains(model.joints()));
  const JointPosition q = JointPosition::Zero(model.joints());
  t.Set(t->reference, JointPosition(PerJoint::Constant(7, 0.05)));
  t.Set(t->dynamics, At(model, q, JointVelocity::Zero(model.joints())));
  t.Tick();
  const Context snapshot = t.simulator().Snapshot();
  const long before = Allocations();
  for (int k = 0; k < 100; ++k) t.Tick();
  EXPECT_EQ(Allocations() - before, 0);
  const Context end = t.simulator().Snapshot();
  t.simulator().Restore(snapshot);
  for (int k = 0; k < 100; ++k) t.Tick();
  EXPECT_TRUE(t.simulator().Snapshot() == end);
}

TEST(PositionControl, RefusesGainsAndLimitsThatAreNone) {
  const auto error = [](auto change) {
    PositionControl::Options o = Gains(kTwo);
    change(o);
    return ErrorOf([&] { PositionControl control(o); });
  };
  using O = PositionControl::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness(0) = -1; }), "stiffness[first] must be >= 0 1/s², got -1");
  EXPECT_EQ(error([](O& o) { o.damping(1) = -1; }), "damping[second] must be >= 0 1/s, got -1");
  EXPECT_EQ(error([](O& o) { o.integral(1) = NAN; }),
            "integral[second] must be >= 0 1/s³, got nan");
  EXPECT_EQ(error([](O& o) { o.acceleration_limit(0) = 0; }),
            "acceleration_limit[first] must be > 0 rad/s², got 0");
  EXPECT_EQ(error([](O& o) { o.torque_limit = PerJoint::Ones(3); }),
            "torque_limit has an element for each of the 2 joints, got 3");
}

}  // namespace
}  // namespace pliant
