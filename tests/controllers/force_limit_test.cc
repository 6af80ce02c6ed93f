#include "pliant/controllers/force_limit.h"

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

/// A force along the world's z at the tool.
Wrench Upwards(const RobotModel& m, const RobotDynamics& d, double force) {
  const Pose X = LinkPose(m, d, m.link_index("tool_frame"));
  Wrench W;
  W << 0, 0, 0, X.rotation.transpose() * Eigen::Vector3d(0, 0, force);
  return W;
}

TEST(ForceLimit, BoundsTheMotionAlongTheForceAsTheDamperDoes) {
  const RobotModel m = Gen3();
  RandomStates random(m, 56);
  BlockTester<ForceLimit> t(
      ForceLimit::Options{.model = m, .frame = "tool_frame", .force = 15, .stiffness = 2000});
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    const FrameDynamics at = PointDynamics(m, d, m.link_index("tool_frame"), {0, 0, 0});
    t.Set(t->dynamics, d);
    const double force = 5 + 30 * std::abs(random.Uniform(1)(0));
    t.Set(t->contact, Upwards(m, d, force));
    const AccelerationRows& rows = t.Get(t->rows);
    const double e = (15 - force) / 2000, edot = at.twist(5);
    const double least = -100 * edot - 100 * 100 / 16.0 * e - at.Jdot_v(5);
    EXPECT_NEAR(rows.lower(0), least, 1e-11 * (1 + std::abs(least)));
    EXPECT_LT((rows.A.row(0) - at.J.row(5)).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_EQ(rows.upper(0), HUGE_VAL);
  }
}

TEST(ForceLimit, CountsThePartAlongADirectionOnly) {
  const RobotModel m = Gen3();
  RandomStates random(m, 58);
  ForceLimit::Options o{.model = m, .frame = "tool_frame", .force = 15, .stiffness = 2000};
  BlockTester<ForceLimit> whole(o);
  o.direction = Eigen::Vector3d(0, 0, -2);
  BlockTester<ForceLimit> part(o);
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    const Wrench normal = Upwards(m, d, 12);
    Wrench slides = normal;
    const Pose X = LinkPose(m, d, m.link_index("tool_frame"));
    slides.tail<3>() += X.rotation.transpose() * Eigen::Vector3d(4, -7, 0);
    whole.Set(whole->dynamics, d);
    whole.Set(whole->contact, normal);
    part.Set(part->dynamics, d);
    part.Set(part->contact, slides);
    const AccelerationRows &a = whole.Get(whole->rows), &b = part.Get(part->rows);
    EXPECT_NEAR(a.lower(0), b.lower(0), 1e-10 * (1 + std::abs(a.lower(0))));
    EXPECT_LT((a.A - b.A).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(ForceLimit, HasNoBoundWhereNothingTouches) {
  const RobotModel m = Gen3();
  RandomStates random(m, 57);
  BlockTester<ForceLimit> t(
      ForceLimit::Options{.model = m, .frame = "tool_frame", .force = 15, .stiffness = 2000});
  t.Set(t->dynamics, At(m, random.q(), random.v()));
  for (const double noise : {0.0, 4.9}) {
    Wrench W;
    W << 0, 0, 0, noise, 0, 0;
    t.Set(t->contact, W);
    EXPECT_EQ(t.Get(t->rows).lower(0), -HUGE_VAL);
  }
}

TEST(ForceLimit, PassesOnAContactThatIsNoNumber) {
  const RobotModel m = Gen3();
  RandomStates random(m, 59);
  BlockTester<ForceLimit> t(
      ForceLimit::Options{.model = m, .frame = "tool_frame", .force = 15, .stiffness = 2000});
  t.Set(t->dynamics, At(m, random.q(), random.v()));
  Wrench broken;
  broken(4) = std::nan("");
  t.Set(t->contact, broken);
  EXPECT_TRUE(std::isnan(t.Get(t->rows).lower(0))) << "so the QP reports it";
}

/// A point that is driven into a spring as hard as the row allows, sampled and held at 1 kHz.
TEST(ForceLimit, PressesNoHarderThanAllowedOnSpringsUpToTheSquareOfTheDampingRatio) {
  const double k = 2000, limit = 15, h = 1e-3;
  const VelocityDamper damper;
  for (const double spring : {200.0, 2000.0, 3.9 * k}) {
    double x = -0.02, v = 0, largest = 0;
    for (int i = 0; i < 100'000; ++i) {
      const double force = spring * std::max(0.0, x);
      double a = 5;  // what the task asks for, into the spring
      if (force > 0) a = std::min(a, -damper.Least((limit - force) / k, -v));
      x += h * v + 0.5 * h * h * a;
      v += h * a;
      v = std::min(v, 0.05);
      largest = std::max(largest, spring * x);
    }
    EXPECT_NEAR(spring * x, limit, 1e-6 * limit) << spring;
    // It comes in at 0.05 m/s: without overshoot where s² + λ s + λ²/(4M²) k_s/k is overdamped,
    // but for the way that speed takes it before the first sample.
    EXPECT_LT(largest, limit * (1 + 1e-9) + spring * 0.05 * h) << spring;
  }
}

TEST(ForceLimit, RefusesForcesAndStiffnessesThatAreNone) {
  const RobotModel m = Gen3();
  const auto error = [&](ForceLimit::Options o) { return ErrorOf([&] { ForceLimit limit(o); }); };
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .force = 0, .stiffness = 1}),
            "force must be > 0 N, got 0");
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .force = 9, .stiffness = 0}),
            "stiffness must be > 0 N/m, got 0");
  EXPECT_EQ(error({.model = m, .frame = "tool_frame", .force = 5, .stiffness = 1}),
            "contact_from must be below force, 5 N, got 5");
  EXPECT_EQ(error({.model = m,
                   .frame = "tool_frame",
                   .force = 9,
                   .stiffness = 1,
                   .direction = Eigen::Vector3d(0, 0, 0)}),
            "the length of direction must be > 0, got 0");
}

}  // namespace
}  // namespace pliant
