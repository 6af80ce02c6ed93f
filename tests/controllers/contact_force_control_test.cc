#include "pliant/controllers/contact_force_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/contact_rig.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;
using Status = ContactForceStatus;

constexpr double kNever = std::numeric_limits<double>::infinity();

TaskMatrix Number(double x) { return TaskMatrix::Constant(1, 1, x); }

/// CF's gains, and an M_d.
ContactForceControl::Settings Gains(double m_d) {
  return {.wanted = FixedForce{{0, 0, 0}},
          .inertia = Number(m_d),
          .damping = Number(10.5),
          .force_gain = Number(4.1),
          .speed_limit = kNever,
          .way_limit = kNever};
}

/// A point that the control accelerates exactly as it wants to, told a force.
struct Point {
  explicit Point(const ContactForceControl::Settings& settings)
      : t{ContactForceControl::Options{.model = model, .period = 1ms, .settings = settings}} {}

  Vector3d Acceleration(const Vector3d& x, const Vector3d& v, const Vector3d& F) {
    ComputeDynamics(model, JointPosition(x), JointVelocity(v), d);
    t.Set(t->dynamics, d);
    t.Set(t->contact, AnchoredContact{.link = model.link_index("mass"),
                                      .force = touched ? F : Vector3d(Vector3d::Zero()),
                                      .touched = touched});
    t.Tick();
    return t.Get(t->objective).b;
  }

  bool touched = true;
  RobotModel model = Mass(1);
  RobotDynamics d{model};
  BlockTester<ContactForceControl> t;
};

TEST(ContactForceControl, WantsWhatTheFormulaSays) {
  const RobotModel m = Lwr();
  RandomStates random(m, 95);
  ContactForceControl::Settings settings = Gains(3);
  settings.wanted = FixedForce{{1, 15, -2}};
  BlockTester<ContactForceControl> t(
      ContactForceControl::Options{.model = m, .period = 1ms, .settings = settings});
  for (int k = 0; k < 100; ++k) {
    RobotDynamics d(m);
    ComputeDynamics(m, random.q(), random.v(), d);
    const AnchoredContact c{.link = m.joint(4).child,
                            .point = random.Uniform(0.2).head<3>(),
                            .force = random.Uniform(30).head<3>(),
                            .touched = true};
    t.Set(t->dynamics, d);
    t.Set(t->contact, c);
    t.Tick();
    const FrameDynamics x = PointDynamics(m, d, c.link, c.point);
    const Vector3d v = x.twist.tail<3>();
    const Vector3d wanted = (4.1 * (c.force - Vector3d(1, 15, -2)) - 10.5 * v) / 3;
    EXPECT_LT(RelativeError(t.Get(t->objective).b, wanted - x.Jdot_v.tail<3>()), 1e-12);
    EXPECT_LT(RelativeError(t.Get(t->objective).A, x.J.bottomRows<3>()), 1e-13);
  }
}

TEST(ContactForceControl, ACompatibleForceHasItsSizeInTheDirectionOfThePushAndFadesOutBelowAFloor) {
  ContactForceControl::Settings settings = Gains(3);
  settings.wanted = CompatibleForce{.force = 15, .floor = 3};
  Point point(settings);
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  for (const double size : {40.0, 15.0, 3.0, 2.999, 1.0, 1e-9, 0.0}) {
    point.Acceleration({0, 0, 0}, {0, 0, 0}, size * n);
    const double expected = size >= 3 ? 15 : 15 * size / 3;
    EXPECT_LT((point.t.Get(point.t->wanted) - expected * n).norm(), 1e-12) << size;
  }
}

/// The largest excursion of a point on a spring that pulls it to x = 0, of its last second; it
/// starts 1 cm off. The force is told through the lag of an observer, if there is one. CF's printed
/// sign is this one of all forces negated.
struct Excursion {
  double early = 0, late = 0;
};
Excursion OnASpring(double m_d, double k_e, double K_I, double sign, double duration_s) {
  Point point(Gains(m_d));
  const double h = 2e-3;
  Vector3d state(0.01, 0, -k_e * 0.01);  // x, ẋ, F̂
  const auto rate = [&](const Vector3d& s) {
    const double F = -k_e * s(0), told = K_I > 0 ? s(2) : F;
    const double a = point.Acceleration({0, s(0), 0}, {0, s(1), 0}, {0, sign * told, 0})(1);
    return Vector3d(s(1), a, K_I * (F - s(2)));
  };
  Excursion found;
  for (int k = 0; k * h < duration_s; ++k) {
    const Vector3d k1 = rate(state), k2 = rate(state + h / 2 * k1), k3 = rate(state + h / 2 * k2),
                   k4 = rate(state + h * k3);
    state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    if (k * h < 1) found.early = std::max(found.early, std::abs(state(0)));
    if (k * h > duration_s - 1) found.late = std::max(found.late, std::abs(state(0)));
  }
  return found;
}

TEST(ContactForceControl, RegulatesAgainstASpringWhereTheSignThatCfPrintsRunsAway) {
  // m s² + k_d s ± k_f k_e
  for (const double k_e : {5.0, 50.0, 500.0}) {
    const Excursion mended = OnASpring(3, k_e, 0, 1, 6);
    EXPECT_LT(mended.late, 0.05 * mended.early) << k_e;
    const Excursion printed = OnASpring(3, k_e, 0, -1, 6);
    // It grows with s = (−k_d + √(k_d² + 4 m k_f k_e))/2m, of at least 1.2 1/s.
    const double s = (-10.5 + std::sqrt(10.5 * 10.5 + 4 * 3 * 4.1 * k_e)) / 6;
    EXPECT_GT(printed.late, 0.3 * 0.01 * std::exp(s * 5.9)) << k_e;
  }
}

TEST(ContactForceControl, IsStableOnSpringsUpToTheBoundThatTheLagOfTheForceLeaves) {
  for (const double m_d : {1.5, 12.0})
    for (const double K_I : {20.0, 200.0}) {
      const double bound = 10.5 * (K_I + 10.5 / m_d) / 4.1;
      const Excursion below = OnASpring(m_d, 0.75 * bound, K_I, 1, 12);
      EXPECT_LT(below.late, 0.9 * below.early) << m_d << " kg, " << K_I << " 1/s";
      const Excursion above = OnASpring(m_d, 1.3 * bound, K_I, 1, 12);
      EXPECT_GT(above.late, 1.1 * above.early) << m_d << " kg, " << K_I << " 1/s";
    }
}

TEST(ContactForceControl, BringsTheForceOfAMassToItsValueWhicheverWayItIsPushed) {
  ContactForceControl::Settings settings = Gains(3);
  settings.wanted = CompatibleForce{.force = 15, .floor = 3};
  ContactRig rig(Mass(7), settings);
  const double h = 1e-3;
  PerJoint x = PerJoint::Zero(3), v = PerJoint::Zero(3);
  const Vector3d hand(0.1, -0.05, 0.2);
  Vector3d F;
  for (int k = 0; k < 15'000; ++k) {  // a hand of 60 N/m and 10 N·s/m: ζ > 0.5
    F = 60 * (hand - x) - 10 * v;
    const JointTorque tau = rig.Torque(x, v, TouchedAt(rig.model.link_index("mass"), {0, 0, 0}, F));
    v += h * (tau + F) / 7;
    x += h * v;
  }
  EXPECT_NEAR(F.norm(), 15, 1e-6);
  EXPECT_LT(v.norm(), 1e-6);
  EXPECT_LT((x - (hand - F / 60)).norm(), 1e-6) << "where the hand wants it to be";
}

TEST(ContactForceControl, RunsAwayAlongAForceThatNobodyGives) {
  ContactForceControl::Settings settings = Gains(3);
  settings.wanted = FixedForce{{0, 15, 0}};
  Point point(settings);
  Vector3d x = Vector3d::Zero(), v = Vector3d::Zero();
  for (int k = 0; k < 4000; ++k) {
    v += 1e-3 * point.Acceleration(x, v, {5, 0, 0});
    x += 1e-3 * v;
  }
  // ẋ → K_f (F̂ − F_d)/K_d, within exp(−4 s · 3.5 1/s)
  EXPECT_NEAR(v(1), -15 * 4.1 / 10.5, 1e-4);
  EXPECT_NEAR(v(0), 5 * 4.1 / 10.5, 1e-4);
  EXPECT_EQ(point.t.Get(point.t->status), Status::Regulating);
}

TEST(ContactForceControl, TheGuardHoldsAPointThatIsTooFastOrTooFarUntilItIsTouchedAgain) {
  for (const bool speed : {true, false}) {
    ContactForceControl::Settings settings = Gains(3);
    settings.wanted = FixedForce{{0, 15, 0}};
    settings.inertia = Number(5);
    (speed ? settings.speed_limit : settings.way_limit) = speed ? 0.4 : 0.2;
    const Status stopped = speed ? Status::TooFast : Status::TooFar;
    Point point(settings);
    Vector3d x = Vector3d::Zero(), v = Vector3d::Zero(), at_stop = Vector3d::Zero();
    Status last = Status::Idle;
    const auto run = [&](double seconds, const Vector3d& F) {
      for (int k = 0; k < seconds * 1000; ++k) {
        v += 1e-3 * point.Acceleration(x, v, F);
        const Status now = point.t.Get(point.t->status);
        if (now == stopped && last == Status::Regulating) at_stop = x;
        last = now;
        x += 1e-3 * v;
      }
    };
    run(3, {0, 0, 0});
    EXPECT_EQ(last, stopped);
    // K_h = 500, D_h = 80, M_d = 5: overdamped, the slower pole 8.6 1/s.
    EXPECT_LT((x - at_stop).norm(), 1e-4);
    // v²/2a, a = K_f F_d/M_d
    EXPECT_GT(at_stop.norm(), speed ? 0.0065 : 0.199);
    EXPECT_LT(at_stop.norm(), 0.25);
    EXPECT_EQ(point.t.Get(point.t->wanted).norm(), 0);

    point.touched = false;
    run(0.1, {0, 0, 0});
    EXPECT_EQ(last, Status::Holding);
    EXPECT_LT((x - at_stop).norm(), 1e-4) << "still held";
    point.touched = true;
    run(0.001, {0, 0, 0});
    EXPECT_EQ(last, Status::Regulating);
  }
}

TEST(ContactForceControl, HoldsThePointWhereItWasReleased) {
  Point point(Gains(3));
  Vector3d x(0.3, 0, 0);
  point.Acceleration(x, {0, 0, 0}, {5, 0, 0});
  EXPECT_EQ(point.t.Get(point.t->status), Status::Regulating);
  point.touched = false;
  x(0) = 0.4;
  EXPECT_LT(point.Acceleration(x, {0, 0, 0}, {0, 0, 0}).norm(), 1e-12);
  EXPECT_EQ(point.t.Get(point.t->status), Status::Holding);
  const Vector3d back = point.Acceleration(Vector3d(0.41, 0, 0), Vector3d(0.1, 0, 0), {0, 0, 0});
  EXPECT_NEAR(back(0), -(500 * 0.01 + 80 * 0.1) / 3, 1e-9);
}

TEST(ContactForceControl, IsIdleUntilAPointIsTouched) {
  const RobotModel m = Lwr();
  BlockTester<ContactForceControl> t(
      ContactForceControl::Options{.model = m, .period = 1ms, .settings = Gains(3)});
  RobotDynamics d(m);
  ComputeDynamics(m, JointPosition::Zero(m.joints()), JointVelocity::Zero(m.joints()), d);
  t.Set(t->dynamics, d);
  t.Set(t->contact, AnchoredContact{});
  t.Tick();
  EXPECT_EQ(t.Get(t->status), Status::Idle);
  EXPECT_EQ(t.Get(t->objective).weight, 0);
}

TEST(ContactForceControl, RefusesSettingsThatAreNone) {
  const auto error = [](auto change) {
    ContactForceControl::Settings settings = Gains(3);
    change(settings);
    return ErrorOf(
        [&] { ContactForceControl({.model = Lwr(), .period = 1ms, .settings = settings}); });
  };
  EXPECT_EQ(error([](auto& s) { s.speed_limit = 0; }), "speed_limit must be > 0 m/s, got 0");
  EXPECT_EQ(error([](auto& s) { s.way_limit = -1; }), "way_limit must be > 0 m, got -1");
  EXPECT_EQ(error([](auto& s) { s.wanted = FixedForce{}; }),
            "wanted.force[x] must be finite N, got nan");
  EXPECT_EQ(error([](auto& s) { s.wanted = CompatibleForce{.force = 15, .floor = 0}; }),
            "wanted: floor must be > 0 N, got 0");
  EXPECT_THAT(error([](auto& s) { s.force_gain = Number(-4); }),
              testing::HasSubstr("force_gain must be positive semi-definite"));
}

TEST(ContactForceControl, HoldsTheLaws) {
  BlockTester<ContactForceControl> t(
      ContactForceControl::Options{.model = Lwr(), .period = 1ms, .settings = Gains(3)});
  t.Set(t->dynamics, RobotDynamics(Lwr()));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
