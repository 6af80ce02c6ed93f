#include "pliant/controllers/friction_excitation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kStep = 1e-3;
/// Of a step, so that Euler's method bears friction that steep.
constexpr int kParts = 10;
constexpr double kSmooth = 1e-3;

PerJoint Sizes(double large, double small) {
  return JointTorque{large, large, large, large, small, small, small};
}

FrictionExcitation::Options Options(const FrictionTest& test = {}) {
  return {.model = Gen3(),
          .start = JointPosition(PerJoint::Zero(7)),
          .torque_per_ampere = Sizes(11, 7.6),
          .coulomb = Sizes(3, 1.25),
          .viscous = Sizes(2.416, 1.1),
          .test = test,
          .period = 1ms};
}

/// A short test of some joints.
FrictionTest Short(std::vector<std::string> joints) {
  return {.joints = std::move(joints),
          .speeds = 3,
          .settle_s = 0.3,
          .dwell_s = 0.1,
          .break_aways = 1,
          .ramp_s = 0.5};
}

/// A Gen3 with rotors and friction c tanh(v/v₀) + d v, v₀ = 1e-3 rad/s, by Euler's semi-implicit
/// method, in the place of a station.
class Rig {
 public:
  explicit Rig(const FrictionExcitation::Options& o)
      : t{o}, model{o.model}, q{o.start}, v{JointVelocity(PerJoint::Zero(7))}, d_(o.model) {
    t.Set(t->dynamics, d_);
  }

  FrictionReport Tick() {
    ComputeDynamics(model, q, v, d_);
    RobotDynamics seen = d_;
    seen.M.diagonal() += B;
    t.Set(t->position, q_seen());
    t.Set(t->velocity, v);
    t.Set(t->torque, JointTorque(PerJoint::Zero(7)));
    t.Set(t->dynamics, seen);
    t.Tick();
    const PerJoint driven = t.Get(t->current).cwiseProduct(Sizes(11, 7.6)) + push;
    for (int k = 0; k < kParts && !stuck; ++k) {
      PerJoint friction(7);
      for (int j = 0; j < 7; ++j) friction(j) = c(j) * std::tanh(v(j) / kSmooth) + d(j) * v(j);
      v += kStep / kParts *
           ForwardDynamics(d_, JointTorque(driven - friction), JointTorque(PerJoint::Zero(7)), B);
      q += kStep / kParts * v;
    }
    fastest = fastest.cwiseMax(v);
    slowest = slowest.cwiseMin(v);
    return t.Get(t->report);
  }

  /// Until the test is over, or for so long.
  FrictionReport Run(double most_s) {
    FrictionReport report;
    for (int k = 0; k < most_s / kStep; ++k) {
      report = Tick();
      if (report.phase == FrictionPhase::Done || report.phase == FrictionPhase::Stopped) break;
    }
    return report;
  }

  JointPosition q_seen() const {
    JointPosition seen = q;
    if (wraps)
      for (int j = 0; j < 7; j += 2) seen(j) = std::remainder(q(j), 2 * std::numbers::pi);
    return seen;
  }

  BlockTester<FrictionExcitation> t;
  RobotModel model;
  JointPosition q;
  JointVelocity v;
  PerJoint B = Sizes(0.4, 0.22), c = Sizes(3, 1.25), d = Sizes(2.416, 1.1);
  PerJoint push = PerJoint::Zero(7), fastest = PerJoint::Zero(7), slowest = PerJoint::Zero(7);
  bool stuck = false, wraps = false;

 private:
  RobotDynamics d_;
};

// Of every joint: what is asked for, both ways, and never the limit.
TEST(FrictionExcitation, CoversTheSpeedsBothWaysAndComesBack) {
  FrictionTest test = Short({});
  test.speed = 0.7;
  const FrictionExcitation::Options o = Options(test);
  Rig rig(o);
  rig.wraps = true;  // as angles of joints without limits may
  int joint = -1;
  double held_off = 0, elapsed = 0;
  FrictionReport report;
  for (; report.phase != FrictionPhase::Done && elapsed < 300; elapsed += kStep) {
    report = rig.Tick();
    ASSERT_NE(report.phase, FrictionPhase::Stopped) << int(report.stop) << report.stopped_by;
    EXPECT_GE(report.joint, joint) << "one joint after the other";
    joint = report.joint;
    if (report.phase == FrictionPhase::Return) continue;
    for (int j = 0; j < 7; ++j)
      if (j != joint)
        held_off = std::max(held_off, std::abs(std::remainder(rig.q(j), 2 * std::numbers::pi)));
  }
  EXPECT_EQ(report.phase, FrictionPhase::Done);
  EXPECT_LT(elapsed, FrictionExcitation::LengthOf(o)) << "the length that was foretold";
  EXPECT_LT(held_off, 0.01);
  for (int j = 0; j < 7; ++j) {
    const double limit = o.model.joint(j).velocity, top = 0.7 * limit;
    // A level counts as the last from 95 % on.
    EXPECT_GT(rig.fastest(j), 0.95 * top) << j;
    EXPECT_LT(rig.slowest(j), -0.95 * top) << j;
    EXPECT_LT(std::max(rig.fastest(j), -rig.slowest(j)), limit) << j;
    EXPECT_NEAR(std::remainder(rig.q(j), 2 * std::numbers::pi), 0, 0.01) << j;
  }
  for (int k = 0; k < 1000; ++k) rig.Tick();
  EXPECT_LT(rig.v.cwiseAbs().maxCoeff(), 1e-3) << "held afterwards";
}

// τ_b is measured, so levels start from the friction that is there.
TEST(FrictionExcitation, FindsTheTorqueThatBreaksAJointAway) {
  for (const double part : {0.5, 2.0}) {
    Rig rig(Options(Short({"joint_3"})));
    rig.c *= part;
    ASSERT_EQ(rig.Run(120).phase, FrictionPhase::Done);
    // The ramp of 6 N·m/s goes on while B turns by 1 mrad, t = (6 · 1e-3 · 0.4/6)^(1/3) s = 0.07 s,
    // and viscous friction is small by then. Creeping takes no more than part of that way.
    EXPECT_NEAR(rig.t.Get(rig.t->break_away_up)(2), 3 * part, 0.45);
    EXPECT_NEAR(rig.t.Get(rig.t->break_away_down)(2), 3 * part, 0.45);
    EXPECT_GT(rig.fastest(2), 0.95 * 0.8 * 2.0944);
    EXPECT_LT(rig.fastest(2), 2.0944);
  }
}

TEST(FrictionExcitation, KeepsItsSpeedsWithoutFriction) {
  // Of a joint without friction the loop has to hold all that is assumed, some 7 N·m: the default
  // bandwidth, for elastic gears, lets it go 0.02 rad/s beyond its limit, and the test stops.
  FrictionTest test = Short({"joint_1", "joint_6"});
  test.bandwidth = 25;
  Rig rig(Options(test));
  rig.c.setZero();
  rig.d.setZero();
  EXPECT_EQ(rig.Run(120).phase, FrictionPhase::Done);
  EXPECT_LT(rig.fastest(0), 2.0944);
  EXPECT_LT(-rig.slowest(0), 2.0944);
}

TEST(FrictionExcitation, TurnsJointsWithLimitsInsideTheirBounds) {
  FrictionTest test = Short({"joint_2", "joint_4"});
  test.range = 0.5;
  Rig rig(Options(test));
  double most2 = 0, most4 = 0;
  while (rig.Tick().phase != FrictionPhase::Done) {
    ASSERT_LT(rig.t.time(), 120);
    most2 = std::max(most2, std::abs(rig.q(1)));
    most4 = std::max(most4, std::abs(rig.q(3)));
  }
  // Half of ± 2.24 and ± 2.57 rad, and what the loop lags behind.
  EXPECT_LT(most2, 0.5 * 2.24 + 0.02);
  EXPECT_LT(most4, 0.5 * 2.57 + 0.02);
}

TEST(FrictionExcitation, GoesToTheStartFromWhereTheArmIs) {
  Rig rig(Options(Short({"joint_7"})));
  rig.q = JointPosition{0.3, -0.2, 0.1, 0.4, -0.5, 0.2, 3};
  FrictionReport report;
  while (report.phase == FrictionPhase::Return) {
    report = rig.Tick();
    ASSERT_LT(rig.t.time(), 20);
  }
  EXPECT_EQ(report.phase, FrictionPhase::BreakAway);
  EXPECT_LT(rig.q.cwiseAbs().maxCoeff(), 0.01);
  // Half of the largest speed of a test, and what the loop goes beyond.
  EXPECT_LT(rig.fastest.cwiseQuotient(rig.model.velocity_limit()).maxCoeff(), 0.45);
}

/// Brakes to rest, stays, and says the same of it from then on.
void ExpectRest(Rig& rig, FrictionStop why, int joint) {
  const FrictionReport stopped = rig.t.Get(rig.t->report);
  EXPECT_EQ(stopped.phase, FrictionPhase::Stopped);
  EXPECT_EQ(stopped.stop, why);
  EXPECT_EQ(stopped.stopped_by, joint);
  EXPECT_FALSE(stopped.steady);
  for (int k = 0; k < 2000; ++k) EXPECT_EQ(rig.Tick(), stopped);
  const JointPosition rest = rig.q;
  for (int k = 0; k < 1000; ++k) rig.Tick();
  EXPECT_LT((rig.q - rest).cwiseAbs().maxCoeff(), 2e-3) << "held";
}

TEST(FrictionExcitation, StopsAtAVelocityLimit) {
  FrictionTest test = Short({"joint_1"});
  test.velocity_limit = 0.85;
  Rig rig(Options(test));
  while (rig.Tick().phase != FrictionPhase::Staircase) ASSERT_LT(rig.t.time(), 20);
  rig.push(0) = 30;  // more than the friction and all that the test would give
  rig.Run(60);
  EXPECT_GT(std::abs(rig.v(0)), 0.85 * 2.0944 - 0.02);
  rig.push.setZero();
  const double fast = std::abs(rig.v(0));
  ExpectRest(rig, FrictionStop::Velocity, 0);
  EXPECT_LT(rig.fastest(0), fast + 0.02) << "no faster once it brakes";
}

TEST(FrictionExcitation, StopsAtATemperature) {
  Rig rig(Options(Short({"joint_1"})));
  JointTemperature hot(PerJoint::Constant(7, 59.0));
  rig.t.Set(rig.t->temperature, hot);
  for (int k = 0; k < 1000; ++k) ASSERT_NE(rig.Tick().phase, FrictionPhase::Stopped);
  hot(4) = 60.5;
  rig.t.Set(rig.t->temperature, hot);
  rig.Tick();
  ExpectRest(rig, FrictionStop::Temperature, 4);
}

TEST(FrictionExcitation, StopsWhereAHeldJointIsPushedAway) {
  Rig rig(Options(Short({"joint_1"})));
  for (int k = 0; k < 500; ++k) rig.Tick();
  // 20 N·m/s, so slow that the joint gives way before it is too fast.
  for (; rig.push(5) < 60 && rig.Tick().phase != FrictionPhase::Stopped;) rig.push(5) += 0.02;
  const FrictionReport report = rig.t.Get(rig.t->report);
  EXPECT_EQ(report.phase, FrictionPhase::Stopped);
  EXPECT_EQ(report.stop, FrictionStop::Position);
  EXPECT_EQ(report.stopped_by, 5);
}

TEST(FrictionExcitation, StopsWhereAJointDoesNotBreakAway) {
  Rig rig(Options(Short({"joint_5"})));
  rig.stuck = true;
  rig.Run(60);
  ExpectRest(rig, FrictionStop::Stuck, 4);
}

TEST(FrictionExcitation, StopsAfterItsTime) {
  FrictionTest test = Short({"joint_3"});
  test.joint_time_limit_s = 2;
  Rig of_joint(Options(test));
  of_joint.Run(60);
  EXPECT_NEAR(of_joint.t.time(), 2, 0.01);
  ExpectRest(of_joint, FrictionStop::Time, 2);
  test.joint_time_limit_s = 120;
  test.time_limit_s = 3;
  Rig of_all(Options(test));
  of_all.Run(60);
  EXPECT_NEAR(of_all.t.time(), 3, 0.01);
  ExpectRest(of_all, FrictionStop::Time, -1);
}

TEST(FrictionExcitation, StopsWhereAMeasurementIsNoNumber) {
  Rig rig(Options(Short({"joint_1"})));
  while (rig.Tick().phase != FrictionPhase::Staircase) ASSERT_LT(rig.t.time(), 20);
  for (int k = 0; k < 300; ++k) rig.Tick();
  JointVelocity v = rig.v;
  v(2) = std::nan("");
  rig.t.Set(rig.t->velocity, v);
  rig.t.Tick();
  EXPECT_TRUE(rig.t.Get(rig.t->current).allFinite());
  // What the motors carry without knowing where the arm is: its weight, when last seen, 0 here.
  EXPECT_LT(rig.t.Get(rig.t->motor_torque).cwiseAbs().maxCoeff(), 0.01);
  ExpectRest(rig, FrictionStop::NotFinite, 2);
}

TEST(FrictionExcitation, RefusesWhatItCannotDo) {
  const auto error = [](auto change) {
    FrictionExcitation::Options o = Options();
    change(o);
    return ErrorOf([&] { FrictionExcitation{o}; });
  };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& o) { o.test.joints = {"joint_8"}; }), HasSubstr("joint_8"));
  EXPECT_EQ(error([](auto& o) {
              o.test.joints = {"joint_1", "joint_1"};
            }),
            "joints names each joint once, got joint_1");
  EXPECT_EQ(error([](auto& o) { o.test.speed = 1; }), "speed must be from 0.01 to 0.95, got 1");
  EXPECT_EQ(error([](auto& o) { o.test.velocity_limit = 5; }),
            "velocity_limit must be from 0.01 to 1, got 5");
  EXPECT_EQ(error([](auto& o) { o.test.velocity_limit = o.test.speed; }),
            "velocity_limit must be > speed = 0.8, which is reached, got 0.8");
  EXPECT_EQ(error([](auto& o) { o.start(1) = 2.5; }),
            "start lies between the limits of joint_2, got 2.5");
  EXPECT_THAT(error([](auto& o) { o.coulomb(3) = 0; }), HasSubstr("coulomb"));
  EXPECT_THAT(error([](auto& o) { o.torque_per_ampere(3) = 0; }), HasSubstr("torque_per_ampere"));
}

TEST(FrictionExcitation, KeepsTheLawsOfBlocks) {
  for (const double amplitude : {1e-3, 10.0}) {
    BlockTester<FrictionExcitation> t(Options());
    t.Set(t->dynamics, RobotDynamics(Gen3()));
    ExpectBlockLaws(std::move(t), {.amplitude = amplitude, .steps = 1000});
  }
}

}  // namespace
}  // namespace pliant
