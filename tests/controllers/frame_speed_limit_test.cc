#include "pliant/controllers/frame_speed_limit.h"

#include <gtest/gtest.h>

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

FrameSpeedLimit::Options Limits(const RobotModel& m) {
  return {.model = m,
          .frame = "tool_frame",
          .point = {0.01, -0.02, 0.05},
          .linear = 0.5,
          .angular = 1.5};
}

TEST(FrameSpeedLimit, BoundsTheRateOfTheSpeed) {
  const RobotModel m = Gen3();
  RandomStates random(m, 53);
  BlockTester<FrameSpeedLimit> t(Limits(m));
  const int link = m.link_index("tool_frame");
  const double h = 1e-5;
  for (int k = 0; k < 200; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const auto twist = [&](double s) {
      return PointDynamics(m, At(m, q + s * v + 0.5 * s * s * a, v + s * a), link,
                           {0.01, -0.02, 0.05})
          .twist;
    };
    const Twist now = twist(0), before = twist(-h), after = twist(h);
    t.Set(t->dynamics, At(m, q, v));
    const AccelerationRows& rows = t.Get(t->rows);
    for (const int first : {0, 3}) {
      const double most = first == 0 ? 1.5 : 0.5;
      const double speed = now.segment<3>(first).norm();
      const double rate =
          (after.segment<3>(first).norm() - before.segment<3>(first).norm()) / (2 * h);
      // h² d³‖V‖/dt³ / 6; the third rate grows as the speed falls
      const double tolerance = 1e-7 * (1 + 1 / (speed * speed));
      EXPECT_NEAR(rows.upper(first) - rows.A.row(first).dot(a), 100 * (most - speed) - rate,
                  tolerance);
      EXPECT_NEAR(rows.A.row(first).dot(a) - rows.lower(first), 100 * (most + speed) + rate,
                  tolerance);
    }
  }
}

/// A tool that is accelerated by 1000 m/s² in a direction that turns, as far as its rows allow.
TEST(FrameSpeedLimit, LetsNoToolPassItsSpeed) {
  const RobotModel m = Gen3();
  BlockTester<FrameSpeedLimit> t(Limits(m));
  const int link = m.link_index("tool_frame");
  const double h = 1e-3;
  JointPosition q{0.1, 0.4, 0.3, -1.5, 0.2, 0.8, 0};
  JointVelocity v = JointVelocity::Zero(m.joints());
  double fastest = 0;
  for (int k = 0; k < 500; ++k) {
    const RobotDynamics d = At(m, q, v);
    t.Set(t->dynamics, d);
    const AccelerationRows rows = t.Get(t->rows);
    const Eigen::Matrix<double, 6, 7> A = rows.A;
    Vector6 wanted;
    wanted << 0, 0, 0, 1000 * std::cos(0.02 * k), 1000 * std::sin(0.02 * k), 0;
    const FrameDynamics at = PointDynamics(m, d, link, {0.01, -0.02, 0.05});
    // The rows are orthonormal axes times J, so each wanted component is clamped by itself.
    const Eigen::Matrix<double, 6, 7> J = at.J;
    const Eigen::Matrix<double, 6, 6> axes =
        A * J.completeOrthogonalDecomposition().pseudoInverse();
    const Vector6 asked = (axes * wanted).cwiseMax(rows.lower).cwiseMin(rows.upper);
    const JointAcceleration a = J.completeOrthogonalDecomposition().solve(axes.transpose() * asked);
    q += h * v + 0.5 * h * h * a;
    v += h * a;
    fastest = std::max(
        fastest, PointDynamics(m, At(m, q, v), link, {0.01, -0.02, 0.05}).twist.tail<3>().norm());
  }
  EXPECT_GT(fastest, 0.45);
  EXPECT_LE(fastest, 0.5 * (1 + 0.1));  // λ h = 0.1
}

TEST(FrameSpeedLimit, HasNoBoundWhereNoneIsAskedFor) {
  const RobotModel m = Gen3();
  RandomStates random(m, 54);
  BlockTester<FrameSpeedLimit> t(
      FrameSpeedLimit::Options{.model = m, .frame = "tool_frame", .linear = 1});
  t.Set(t->dynamics, At(m, random.q(), random.v()));
  const AccelerationRows& rows = t.Get(t->rows);
  EXPECT_TRUE((rows.upper.head<3>().array() == HUGE_VAL).all());
  EXPECT_TRUE(rows.upper.tail<3>().allFinite());
}

TEST(FrameSpeedLimit, StaysFiniteAtRest) {
  const RobotModel m = Gen3();
  RandomStates random(m, 55);
  BlockTester<FrameSpeedLimit> t(Limits(m));
  t.Set(t->dynamics, At(m, random.q(), JointVelocity::Zero(m.joints())));
  const AccelerationRows& rows = t.Get(t->rows);
  EXPECT_TRUE(rows.A.allFinite());
  EXPECT_NEAR(rows.upper(3), 100 * 0.5, 1e-12);
  EXPECT_NEAR(rows.lower(5), -100 * 0.5, 1e-12);
}

TEST(FrameSpeedLimit, RefusesSpeedsThatAreNone) {
  const RobotModel m = Gen3();
  const auto error = [&](FrameSpeedLimit::Options o) {
    return ErrorOf([&] { FrameSpeedLimit limit(o); });
  };
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .linear = 0}),
            "linear must be > 0 m/s, got 0");
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .angular = -1}),
            "angular must be > 0 rad/s, got -1");
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .rate = 0}), "rate must be > 0 1/s, got 0");
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .priority = 0}),
            "priority must be from 1 to 100, got 0");
}

}  // namespace
}  // namespace pliant
