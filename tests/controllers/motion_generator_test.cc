#include "pliant/controllers/motion_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

const CircleGenerator::Options kCircle{.center = {-0.5, 0.1, 0.3},
                                       .radius = 0.12,
                                       .template_radius = 0.1,
                                       .angular_velocity = 0.7,
                                       .radial_gain = 2,
                                       .height_gain = 5,
                                       .height_damping = 0.2};

/// A bean-like curve in a tilted plane.
LimitCycleGenerator::Options Bean() {
  return {.center = {0.4, -0.2, 0.5},
          .axes = Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()).toRotationMatrix(),
          .radius = 0.15,
          .harmonics = {{0.02, -0.01}, {0.03, 0.015}, {0, 0.005}},
          .angular_velocity = -0.9,
          .radial_gain = 3,
          .height_gain = 4,
          .height_damping = 0.1};
}

double RadiusOfBean(double delta) {
  const LimitCycleGenerator::Options bean = Bean();
  double rho = bean.radius;
  for (int k = 1; k <= 3; ++k) {
    const Harmonic& of = bean.harmonics[static_cast<std::size_t>(k - 1)];
    rho += of.cosine * std::cos(k * delta) + of.sine * std::sin(k * delta);
  }
  return rho;
}

template <class T>
Vector3d Field(BlockTester<T>& t, const Vector3d& p, const Vector3d& v) {
  t.Set(t->position, p);
  t.Set(t->velocity, v);
  return t.Get(t->desired);
}

/// Follows ṗ = f(p, ṗ) with ṗ the solution of ṗ = a(p) − k_D ṗ_n n: Runge–Kutta of order four.
template <class T>
Vector3d Follow(BlockTester<T>& t, Vector3d p, const Vector3d& normal, double damping, double time,
                int steps) {
  const auto rate = [&](const Vector3d& x) {
    const Vector3d a = Field(t, x, Vector3d::Zero());
    return Vector3d(a - damping / (1 + damping) * normal.dot(a) * normal);
  };
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const Vector3d k1 = rate(p), k2 = rate(p + 0.5 * h * k1), k3 = rate(p + 0.5 * h * k2),
                   k4 = rate(p + h * k3);
    p += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return p;
}

struct RandomPoints {
  std::mt19937 random{11};
  Vector3d operator()(double size) {
    std::uniform_real_distribution<double> draw(-size, size);
    return {draw(random), draw(random), draw(random)};
  }
};

TEST(CircleGenerator, HasTheFieldOfThePaper) {
  BlockTester<CircleGenerator> t(kCircle);
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Vector3d p = kCircle.center + random(0.3), v = random(1);
    const Vector3d f = Field(t, p, v);
    const double x = p.x() - kCircle.center.x(), y = p.y() - kCircle.center.y();
    const double r = std::hypot(x, y);
    // In polar coordinates of the plane itself λ₁ drops out: ṙ = k_ρ (ε_d − r), r δ̇.
    EXPECT_NEAR((x * f.x() + y * f.y()) / r, 2 * (0.12 - r), 1e-14);
    EXPECT_NEAR((x * f.y() - y * f.x()) / r, 0.7 * r, 1e-14);
    EXPECT_NEAR(f.z(), 5 * (0.3 - p.z()) - 0.2 * v.z(), 1e-14);
  }
}

TEST(CircleGenerator, ApproachesItsCircleAsTheClosedFormSays) {
  BlockTester<CircleGenerator> t(kCircle);
  RandomPoints random;
  for (int i = 0; i < 10; ++i) {
    const Vector3d start = random(0.3);
    const double rho0 = start.head<2>().norm(), delta0 = std::atan2(start.y(), start.x());
    for (const double time : {0.3, 1.0}) {
      const Vector3d p =
          Follow(t, kCircle.center + start, Vector3d::UnitZ(), 0.2, time, 400) - kCircle.center;
      const double rho = 0.12 + (rho0 - 0.12) * std::exp(-2 * time), delta = delta0 + 0.7 * time;
      // Fourth order: (5 h)⁵/120 at each of 400 steps of 2.5 ms is 1e-10 of 0.3 m.
      EXPECT_NEAR(p.x(), rho * std::cos(delta), 1e-10);
      EXPECT_NEAR(p.y(), rho * std::sin(delta), 1e-10);
      EXPECT_NEAR(p.z(), start.z() * std::exp(-5 / 1.2 * time), 1e-10);
    }
  }
}

TEST(CircleGenerator, LeavesItsCenterAlongX) {
  BlockTester<CircleGenerator> t(kCircle);
  EXPECT_LT((Field(t, kCircle.center, Vector3d::Zero()) - Vector3d(2 * 0.12, 0, 0)).norm(), 1e-15);
  EXPECT_LT((Vector3d(t.Get(t->nearest)) - kCircle.center - Vector3d(0.12, 0, 0)).norm(), 1e-15);
}

TEST(CircleGenerator, ShowsTheWayToThePointOfTheCircleAtTheSameAngle) {
  BlockTester<CircleGenerator> t(kCircle);
  t.Set(t->position, kCircle.center + Vector3d(0, 0.2, -0.01));
  t.Set(t->velocity, {0, 0, 0});
  EXPECT_LT((Vector3d(t.Get(t->nearest)) - kCircle.center - Vector3d(0, 0.12, 0)).norm(), 1e-15);
  EXPECT_LT((Vector3d(t.Get(t->path_error)) - Vector3d(0, 0.08, -0.01)).norm(), 1e-15);
}

TEST(LimitCycleGenerator, IsTheCircleWithoutHarmonics) {
  BlockTester<CircleGenerator> circle(kCircle);
  BlockTester<LimitCycleGenerator> cycle({.center = kCircle.center,
                                          .radius = kCircle.radius,
                                          .angular_velocity = kCircle.angular_velocity,
                                          .radial_gain = kCircle.radial_gain,
                                          .height_gain = kCircle.height_gain,
                                          .height_damping = kCircle.height_damping});
  RandomPoints random;
  for (int i = 0; i < 100; ++i) {
    const Vector3d p = kCircle.center + random(0.3), v = random(1);
    EXPECT_LT((Field(circle, p, v) - Field(cycle, p, v)).norm(), 1e-15);
    EXPECT_LT((circle.Get(circle->path_error) - cycle.Get(cycle->path_error)).norm(), 1e-15);
  }
}

TEST(LimitCycleGenerator, ApproachesItsCurveAsTheClosedFormSays) {
  const LimitCycleGenerator::Options o = Bean();
  BlockTester<LimitCycleGenerator> t(o);
  RandomPoints random;
  for (int i = 0; i < 10; ++i) {
    const Vector3d start = random(0.4);  // in the axes of the plane
    const double delta0 = std::atan2(start.y(), start.x());
    const double e0 = start.head<2>().norm() - RadiusOfBean(delta0);
    for (const double time : {0.3, 2.0}) {
      const Vector3d p =
          o.axes.transpose() *
          (Follow(t, o.center + o.axes * start, o.axes.col(2), 0.1, time, 2000) - o.center);
      const double delta = delta0 - 0.9 * time;
      const double rho = RadiusOfBean(delta) + e0 * std::exp(-3 * time);
      EXPECT_NEAR(p.x(), rho * std::cos(delta), 1e-10);  // fourth order, h ≤ 1 ms
      EXPECT_NEAR(p.y(), rho * std::sin(delta), 1e-10);
      EXPECT_NEAR(p.z(), start.z() * std::exp(-4 / 1.1 * time), 1e-10);
    }
  }
}

TEST(LimitCycleGenerator, HoldsOnTheCurve) {
  const LimitCycleGenerator::Options o = Bean();
  BlockTester<LimitCycleGenerator> t(o);
  const double h = 1e-6;
  for (double delta = -3; delta < 3; delta += 0.1) {
    const auto on_curve = [&](double angle) {
      return Vector3d(o.center + RadiusOfBean(angle) * (std::cos(angle) * o.axes.col(0) +
                                                        std::sin(angle) * o.axes.col(1)));
    };
    const Vector3d tangent = (on_curve(delta + h) - on_curve(delta - h)) / (2 * h);
    const Vector3d f = Field(t, on_curve(delta), Vector3d::Zero());
    EXPECT_LT((f - o.angular_velocity * tangent).norm(), 1e-9);  // h² and ε/h
    EXPECT_LT(t.Get(t->path_error).norm(), 1e-15);
  }
}

TEST(GoalGenerator, ComesNearerFromEverywhereAndNoFasterThanAsked) {
  const Vector3d goal(0.3, 0.1, 0.4);
  Matrix3d A;
  A << 2, 1.5, 0, -1.5, 1, 0.4, 0.2, 0, 3;  // not symmetric: it turns on the way
  BlockTester<GoalGenerator> t({.goal = goal, .gain = A, .speed = 0.2});
  RandomPoints random;
  for (int i = 0; i < 200; ++i) {
    const Vector3d e = random(i < 100 ? 1 : 1e-3);
    const Vector3d f = Field(t, goal + e, Vector3d::Zero());
    EXPECT_LT(e.dot(f), 0);
    EXPECT_LT(f.norm(), 0.2);
    const Vector3d u = -A * e;
    EXPECT_LT((f * std::sqrt(1 + u.squaredNorm() / 0.04) - u).norm(), 1e-14);
  }
  for (int i = 0; i < 10; ++i) {
    const Vector3d p =
        Follow(t, goal + random(0.5), Vector3d::UnitZ(), 0, 20, 2000);  // its slowest mode: 1 1/s
    EXPECT_LT((p - goal).norm(), 1e-5);
  }
  EXPECT_EQ(Field(t, goal, Vector3d::Zero()).norm(), 0);
}

TEST(MotionGenerators, PassTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<CircleGenerator>(kCircle));
  ExpectBlockLaws(BlockTester<LimitCycleGenerator>(Bean()));
  ExpectBlockLaws(BlockTester<GoalGenerator>(
      GoalGenerator::Options{.goal = {0, 0, 0}, .gain = Matrix3d::Identity(), .speed = 1}));
}

TEST(MotionGenerators, RefuseWhatMakesNoMotion) {
  using testing::HasSubstr;
  const auto circle = [](auto change) {
    CircleGenerator::Options o = kCircle;
    change(o);
    return ErrorOf([&] { CircleGenerator generator(o); });
  };
  EXPECT_THAT(circle([](auto& o) { o.radius = 0; }), HasSubstr("radius must be"));
  EXPECT_THAT(circle([](auto& o) { o.template_radius = -1; }), HasSubstr("template_radius must"));
  EXPECT_THAT(circle([](auto& o) { o.radial_gain = kToBeGiven; }), HasSubstr("radial_gain must"));
  EXPECT_THAT(circle([](auto& o) { o.center.x() = kToBeGiven; }),
              HasSubstr("center must be finite"));
  const auto cycle = [](auto change) {
    LimitCycleGenerator::Options o = Bean();
    change(o);
    return ErrorOf([&] { LimitCycleGenerator generator(o); });
  };
  EXPECT_THAT(cycle([](auto& o) { o.axes(0, 0) = 2; }), HasSubstr("axes must be a rotation"));
  EXPECT_THAT(cycle([](auto& o) {
                o.harmonics = {{0.16, 0}};
              }),
              HasSubstr("the radius must be > 0 all round"));
  EXPECT_THAT(cycle([](auto& o) { o.harmonics.resize(17); }),
              HasSubstr("harmonics must be at most 16, got 17"));
  EXPECT_THAT(cycle([](auto& o) { o.center.z() = kToBeGiven; }),
              HasSubstr("center must be finite"));
  const auto goal = [](auto change) {
    GoalGenerator::Options o{.goal = {0, 0, 0}, .speed = 1};
    change(o);
    return ErrorOf([&] { GoalGenerator generator(o); });
  };
  EXPECT_THAT(goal([](auto& o) { o.gain(0, 0) = -1; }), HasSubstr("A + Aᵀ positive definite"));
  EXPECT_THAT(goal([](auto& o) { o.goal.x() = kToBeGiven; }), HasSubstr("goal must be finite"));
  EXPECT_THAT(goal([](auto& o) { o.speed = 0; }), HasSubstr("speed must be"));
}

}  // namespace
}  // namespace pliant
