#include "pliant/controllers/joint_damper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

TEST(JointDamper, BoundsAccelerationAsTheFormulasSay) {
  const RobotModel m = Lwr();
  RandomStates random(m, 41);
  const double lambda = 70, M = 3;
  BlockTester<JointDamper> t({.model = m,
                              .rate = lambda,
                              .damping_ratio = M,
                              .safety_distance = 0.02,
                              .velocity_fraction = 0.9});
  for (int k = 0; k < 1000; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    t.Set(t->dynamics, At(m, q, v));
    const AccelerationBounds bounds = t.Get(t->bounds);
    for (int i = 0; i < m.size(); ++i) {
      const Joint& j = m.joint(i);
      const double d_s = 0.02 * (j.upper - j.lower);
      // ë ≥ max(ë_p, ë_v), EC (19), (23), (24)
      const auto least = [&](double e, double edot) {
        const double position = -lambda * edot - lambda * lambda / (4 * M * M) * (e - d_s);
        const double velocity = -lambda * (edot - -0.9 * j.velocity);
        return std::max(position, velocity);
      };
      const double upper = -least(j.upper - q(i), -v(i));  // ë = −q̈ above
      const double lower = least(q(i) - j.lower, v(i));    // and q̈ below
      EXPECT_NEAR(bounds.upper(i), upper, 1e-12 * (1 + std::abs(upper)));
      EXPECT_NEAR(bounds.lower(i), lower, 1e-12 * (1 + std::abs(lower)));
    }
  }
}

TEST(JointDamper, KnowsOnlyTheVelocityLimitOfAContinuousJoint) {
  const RobotModel m = Gen3();
  BlockTester<JointDamper> t(JointDamper::Options{.model = m});
  for (const double q : {0.0, 100.0, -1e6}) {
    JointPosition far = JointPosition::Zero(m.joints());
    far(2) = q;
    JointVelocity v = JointVelocity::Zero(m.joints());
    v(2) = 1.5;
    t.Set(t->dynamics, At(m, far, v));
    EXPECT_NEAR(t.Get(t->bounds).upper(2), 100 * (2.0944 - 1.5), 1e-12);
    EXPECT_NEAR(t.Get(t->bounds).lower(2), -100 * (2.0944 + 1.5), 1e-12);
  }
}

/// Joint 2 of the Gen3 as a double integrator, commanded at 1 kHz as hard as its bounds allow.
struct Pushed {
  Pushed(double lambda, double M, double command, double seconds) {
    const RobotModel m = Gen3();
    BlockTester<JointDamper> t(
        JointDamper::Options{.model = m, .rate = lambda, .damping_ratio = M});
    const double h = 1e-3;
    JointPosition q = JointPosition::Zero(m.joints());
    JointVelocity v = JointVelocity::Zero(m.joints());
    const double d_s = 0.01 * (m.joint(1).upper - m.joint(1).lower);
    end = m.joint(1).upper - d_s;
    fastest = m.joint(1).velocity;
    for (int k = 0; k < seconds / h; ++k) {
      t.Set(t->dynamics, At(m, q, v));
      const AccelerationBounds& bounds = t.Get(t->bounds);
      const double a = std::clamp(command, bounds.lower(1), bounds.upper(1));
      // Exact for an acceleration that is held; the turning point lies within the sample.
      if (v(1) > 0 && v(1) + h * a < 0) furthest = std::max(furthest, q(1) - v(1) * v(1) / (2 * a));
      before_last = end - q(1);
      q(1) += h * v(1) + 0.5 * h * h * a;
      v(1) += h * a;
      last = end - q(1);
      furthest = std::max(furthest, q(1));
      slowest_speed = std::min(slowest_speed, v(1));
      top_speed = std::max(top_speed, v(1));
    }
  }
  double end, fastest;  // q⁺ − d_s and q̇⁺
  double furthest = 0, top_speed = 0, slowest_speed = 0, last = 0, before_last = 0;
};

TEST(JointDamper, LetsNoJointPassItsLimitsHoweverHardItIsCommanded) {
  // Held for h ≤ 1/λ the loop keeps its two real poles within (0, 1): sampling adds nothing.
  for (const double lambda : {20.0, 70.0, 100.0, 300.0, 500.0, 1000.0})
    for (const double M : {1.0, 1.5, 2.0, 3.0, 5.0})
      for (const double command : {1.0, 50.0, 1e6}) {
        const Pushed run(lambda, M, command, 5);
        EXPECT_LE(run.furthest, run.end + 1e-13) << lambda << ' ' << M << ' ' << command;
        EXPECT_LE(run.top_speed, run.fastest + 1e-13) << lambda << ' ' << M << ' ' << command;
      }
}

TEST(JointDamper, ApproachesOverdampedAtTheSlowPole) {
  const double h = 1e-3;
  for (const double M : {1.5, 2.0, 3.0}) {
    const double lambda = 100, stiffness = lambda * lambda / (4 * M * M);
    const Pushed run(lambda, M, 1e6, 2);
    EXPECT_GE(run.slowest_speed, 0) << "never turns back, M = " << M;
    EXPECT_GT(run.last, 0);
    // z² − (2 − λh − ½sh²) z + 1 − λh + ½sh² = 0: ë = −λ ė − s e, held over h
    const double b = 2 - lambda * h - 0.5 * stiffness * h * h;
    const double c = 1 - lambda * h + 0.5 * stiffness * h * h;
    const double slow = 0.5 * (b + std::sqrt(b * b - 4 * c));
    EXPECT_NEAR(run.last / run.before_last, slow, 1e-6);
  }
}

TEST(JointDamper, AsksForTheImpossibleOnlyFarOutsideOfALimit) {
  const RobotModel m = Gen3();
  BlockTester<JointDamper> t(JointDamper::Options{.model = m});
  const double end = m.joint(1).upper - 0.01 * (m.joint(1).upper - m.joint(1).lower);
  const double far = 4 * 2 * 2 * m.joint(1).velocity / 100;  // 4M² q̇⁺/λ
  for (const double past : {0.99 * far, 1.01 * far})
    for (const double speed : {-3.0, 0.0, 3.0}) {
      JointPosition q = JointPosition::Zero(m.joints());
      JointVelocity v = JointVelocity::Zero(m.joints());
      q(1) = end + past;
      v(1) = speed;
      t.Set(t->dynamics, At(m, q, v));
      EXPECT_EQ(t.Get(t->bounds).lower(1) > t.Get(t->bounds).upper(1), past > far) << speed;
    }
}

TEST(JointDamper, BoundsClassicallyAsTheFormulasSay) {
  const RobotModel m = Gen3();
  RandomStates random(m, 42);
  const double xi0 = 0.3;
  int near = 0, kept = 0;
  for (int k = 0; k < 500; ++k) {
    BlockTester<JointDamper> t({.model = m,
                                .safety_distance = 0.01,
                                .form = JointDamper::Form::Classical,
                                .influence_distance = 0.1,
                                .speed_offset = xi0,
                                .step = 2ms});
    PerJoint upper_xi = PerJoint::Zero(m.size()), lower_xi = upper_xi;
    JointPosition q = random.q();
    for (int tick = 0; tick < 3; ++tick) {
      const JointVelocity v = random.v();
      q += 0.05 * random.v();
      t.Set(t->dynamics, At(m, q, v));
      t.Tick();
      const AccelerationBounds bounds = t.Get(t->bounds);
      for (int i = 0; i < m.size(); ++i) {
        const Joint& j = m.joint(i);
        const double d_s = 0.01 * (j.upper - j.lower), d_i = 0.1 * (j.upper - j.lower);
        // ë ≥ max(ë_p, ë_v), EC (15), (17), (18), (19), with ξ of the tick that enters d_i
        const auto least = [&](double e, double edot, double& xi) {
          const double velocity = -(edot - -j.velocity) / 2e-3;
          if (j.type == Joint::Type::Continuous || e >= d_i) {
            xi = 0;
            return velocity;
          }
          ++near;
          kept += xi > 0;
          if (xi == 0) xi = e > d_s ? std::abs(edot) * (d_i - d_s) / (e - d_s) + xi0 : xi0;
          const double edot_d = -xi * (e - d_s) / (d_i - d_s);
          return std::max(-(edot - edot_d) / 2e-3, velocity);
        };
        const double upper = -least(j.upper - q(i), -v(i), upper_xi(i));
        const double lower = least(q(i) - j.lower, v(i), lower_xi(i));
        EXPECT_NEAR(bounds.upper(i), upper, 1e-11 * (1 + std::abs(upper)));
        EXPECT_NEAR(bounds.lower(i), lower, 1e-11 * (1 + std::abs(lower)));
      }
    }
  }
  EXPECT_GT(near, 300);
  EXPECT_GT(kept, 100);
}

TEST(JointDamper, BrakesAtFirstByNoMoreThanItsOffsetInTheClassicalForm) {
  const RobotModel m = Gen3();
  BlockTester<JointDamper> t(
      JointDamper::Options{.model = m, .form = JointDamper::Form::Classical});
  JointPosition q = JointPosition::Zero(m.joints());
  JointVelocity v = JointVelocity::Zero(m.joints());
  q(3) = m.joint(3).upper - 0.0999 * (m.joint(3).upper - m.joint(3).lower);
  v(3) = 1.9;  // so ė_d = −1.9 − 0.5 (e − d_s)/(d_i − d_s): it may even go faster
  t.Set(t->dynamics, At(m, q, v));
  t.Tick();
  EXPECT_GT(t.Get(t->bounds).upper(3), 0);
}

TEST(JointDamper, RefusesOptionsThatDoNotDamp) {
  const RobotModel m = Gen3();
  const auto error = [&](JointDamper::Options o) {
    return ErrorOf([&] { JointDamper damper(o); });
  };
  EXPECT_EQ(error({.model = m, .rate = 0}), "rate must be > 0 1/s, got 0");
  EXPECT_EQ(error({.model = m, .damping_ratio = 0.9}), "damping_ratio must be >= 1, got 0.9");
  EXPECT_EQ(error({.model = m, .safety_distance = 0.5}),
            "safety_distance must be from 0 to below 0.5, got 0.5");
  EXPECT_EQ(error({.model = m, .velocity_fraction = 0}),
            "velocity_fraction must be above 0 to 1, got 0");
  EXPECT_EQ(error({.model = m,
                   .safety_distance = 0.1,
                   .form = JointDamper::Form::Classical,
                   .influence_distance = 0.1}),
            "influence_distance must be > safety_distance, 0.1, got 0.1");
  EXPECT_EQ(error({.model = m, .speed_offset = 0}), "speed_offset must be > 0 rad/s, got 0");
}

}  // namespace
}  // namespace pliant
