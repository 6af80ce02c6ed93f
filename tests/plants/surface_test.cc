#include "pliant/plants/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/energy_balance.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kMass = 2;
constexpr double kRadius = 0.05;

/// The ground, and a ball of 2 kg that does not turn: its centre is the gantry's tip.
Surface::Options Ground(const RobotModel& m) {
  return {.model = m, .link = "tip", .radius = kRadius, .stiffness = 1e4};
}

/// The height of the centre at which a ball of 2 kg rests on the ground.
double RestingHeight(const Surface::Options& o) { return kRadius - kMass * kGravity / o.stiffness; }

TEST(Surface, CarriesATipThatRestsOnIt) {
  const RobotModel m = Gantry(kMass);
  Surface::Options o = Ground(m);
  o.damping = 1;
  Scene s({.model = m, .position = {0, 0, 0.1}, .damping = PerJoint::Constant(3, 30)});
  auto& ground = s.AddContact<Surface>("ground", o);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  EXPECT_NEAR(sim.Get(ground.penetration), -0.05, 1e-16);
  EXPECT_FALSE(sim.Get(ground.touching));
  sim.AdvanceTo(5);
  EXPECT_TRUE(sim.Get(ground.touching));
  EXPECT_GT(sim.Get(ground.touches), 0);
  // exp(−5 s · 7 s⁻¹) has died out; 1e-12 of tolerance, times k for forces.
  EXPECT_NEAR(sim.Get(ground.penetration), kMass * kGravity / o.stiffness, 1e-10);
  EXPECT_NEAR(sim.Get(ground.normal_force), kMass * kGravity, 1e-6);
  EXPECT_LT((sim.Get(ground.contact).force - Vector3d(0, 0, kMass * kGravity)).norm(), 1e-6);
  EXPECT_EQ(sim.Get(ground.contact).point, Vector3d(0, 0, -kRadius));
}

/// e v₁ by the law of Hunt and Crossley for a mass that hits with v₁.
double Rebound(double c, double v1) {
  const auto f = [&](double v) { return std::log1p(c * v) - c * v; };
  double lo = 0, hi = std::min(v1, 1 / c);
  while (hi - lo > 1e-15) {
    const double middle = 0.5 * (lo + hi);
    (f(-middle) > f(v1) ? lo : hi) = middle;
  }
  return lo;
}

TEST(Surface, ThrowsABallBackByTheLawOfHuntAndCrossley) {
  const RobotModel m = Gantry(kMass).WithGravity({0, 0, 0});
  for (const double c : {0.01, 0.2, 1.0, 10.0})
    for (const double v1 : {0.3, 2.0}) {
      Surface::Options o = Ground(m);
      o.damping = c;
      o.normal = {1, 2, 2};
      const Vector3d n = Vector3d(1, 2, 2) / 3;
      Scene s({.model = m,
               .position = JointPosition((kRadius + 0.1 * v1) * n),
               .velocity = JointVelocity(-v1 * n)});
      auto& wall = s.AddContact<Surface>("wall", o);
      const Diagram diagram = s.b.Build();
      Simulator sim(diagram, kAccurately);
      sim.AdvanceTo(0.1 - 2e-9);
      EXPECT_EQ(sim.Get(wall.touches), 0);
      sim.AdvanceTo(0.1 + 2e-9);
      EXPECT_EQ(sim.Get(wall.touches), 1) << "located to a nanosecond";
      sim.AdvanceTo(1.5);
      ASSERT_FALSE(sim.Get(wall.touching));
      const double v2 = n.dot(sim.Get(s.plant.velocity));
      EXPECT_NEAR(v2, Rebound(c, v1), 1e-8) << c << ' ' << v1;  // tolerance 1e-11, kinks at p = 0
      if (c * v1 < 0.01) {
        EXPECT_NEAR(v2 / v1, 1 - 2 * c * v1 / 3, c * v1 * c * v1);
      }
      EXPECT_LT((sim.Get(s.plant.velocity) - v2 * n).norm(), 1e-12) << "no friction";
    }
}

TEST(Surface, BrakesASlidingTipByCoulombsLaw) {
  const RobotModel m = Gantry(kMass);
  Surface::Options o = Ground(m);
  o.friction = 0.4;
  const Vector3d v0{1.2, -1.6, 0};  // 2 m/s
  Scene s({.model = m, .position = {0, 0, RestingHeight(o)}, .velocity = JointVelocity(v0)});
  auto& ground = s.AddContact<Surface>("ground", o);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  const double start = sim.Get(s.balance.total);
  sim.AdvanceTo(0.25);
  const double v = 2 - 0.4 * kGravity * 0.25;  // about 1 m/s
  // Up to (v_s/v)²/2 = 5e-7 of what friction takes.
  EXPECT_LT((sim.Get(s.plant.velocity) - v / 2 * v0).norm(), 5e-7);
  const Vector3d friction = -0.4 * kMass * kGravity * v0 / 2;
  EXPECT_LT((sim.Get(ground.contact).force - Vector3d(0, 0, kMass * kGravity) - friction).norm(),
            1e-5);  // the same share of 8 N
  EXPECT_NEAR(sim.Get(ground.dissipation), friction.norm() * v, 1e-5);
  sim.AdvanceTo(1);
  EXPECT_LT(sim.Get(s.plant.velocity).norm(), 1e-4) << "it stopped after 0.51 s";
  EXPECT_NEAR(sim.Get(s.balance.total), start, 1e-8);
}

TEST(Surface, LetsATipCreepInsideTheConeOfFriction) {
  const RobotModel m = Gantry(kMass);
  Surface::Options o = Ground(m);
  o.friction = 0.5;
  o.damping = 5;
  o.slip_speed = 1e-2;
  const double cone = 0.5 * kMass * kGravity;
  for (const double share : {0.1, 0.5, 0.9}) {
    Scene s({.model = m, .position = {0, 0, RestingHeight(o)}});
    s.AddContact<Surface>("ground", o);
    const Diagram diagram = s.b.Build();
    Simulator sim(diagram, kAccurately);
    const double f = share * cone;
    sim.Set(s.torque.value, {0.6 * f, 0.8 * f, 0});
    sim.AdvanceTo(1);
    const double v = 1e-2 * share / std::sqrt(1 - share * share);
    // The slowest rate is μ g/v_s (1 − share²)^{3/2} = 40 s⁻¹; exp(−40) is left, and tolerance.
    EXPECT_LT((sim.Get(s.plant.velocity) - JointVelocity({0.6 * v, 0.8 * v, 0})).norm(), 1e-10);
  }
}

TEST(Surface, NeverPullsATipThatLeavesFast) {
  const RobotModel m = Gantry(kMass);
  Surface::Options o = Ground(m);
  o.damping = 2;
  o.friction = 1;
  BlockTester<Surface> t(o);
  RobotDynamics d(m);
  for (const double speed : {0.4, 0.6, 5.0}) {
    ComputeDynamics(m, {0, 0, kRadius - 0.01}, {1, 0, speed}, d);
    t.Set(t->motion, d);
    const double N = std::max(0.0, 100 * (1 - 2 * speed));
    EXPECT_NEAR(t.Get(t->normal_force), N, 1e-10);
    EXPECT_EQ(t.Get(t->contact).force.isZero(), N == 0);
    // ½ k p² falls at k p v; what the tip does not get of it is lost.
    EXPECT_NEAR(t.Get(t->dissipation), 100 * speed - N * speed + N / std::sqrt(1 + 1e-6), 1e-9);
  }
}

TEST(Surface, NeverMakesEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> one(-1, 1);
  const RobotModel m = Gantry(kMass);
  int touches = 0;
  for (int run = 0; run < 8; ++run) {
    Surface::Options o = Ground(m);
    o.damping = std::array{0.0, 0.3}[static_cast<std::size_t>(run % 2)];
    o.friction = std::array{0.0, 0.7}[static_cast<std::size_t>(run / 2 % 2)];
    o.slip_speed = 1e-2;
    o.normal = {0.2 * one(random), 0.2 * one(random), 1};
    Scene s(
        {.model = m, .position = {0, 0, 0.3}, .velocity = {one(random), one(random), one(random)}});
    auto& ground = s.AddContact<Surface>("ground", o);
    const Diagram diagram = s.b.Build();
    Simulator sim(diagram, kAccurately);
    const double total = sim.Get(s.balance.total);
    double last = sim.Get(s.balance.stored);
    for (double t = 0.01; t < 3; t += 0.01) {
      sim.AdvanceTo(t);
      EXPECT_GE(sim.Get(ground.normal_force), 0);
      EXPECT_GE(sim.Get(ground.dissipation), 0);
      EXPECT_LE(sim.Get(s.balance.stored), last + 1e-7);
      last = sim.Get(s.balance.stored);
    }
    EXPECT_NEAR(sim.Get(s.balance.total), total, 1e-6) << run;  // 1e-11 of some J, 6000 steps
    touches += sim.Get(ground.touches);
  }
  EXPECT_GT(touches, 30);
}

TEST(Surface, LetsABallSettleWithoutZenoBehaviour) {
  // The last rebound needs a speed of about g √(m/k), so it lasts as long as the contact itself.
  const RobotModel m = Gantry(kMass);
  for (const double k : {1e3, 1e5, 1e7})
    for (const double c : {0.5, 5.0, 50.0}) {
      Surface::Options o = Ground(m);
      o.stiffness = k;
      o.damping = c;
      Scene s({.model = m, .position = {0, 0, 0.1}});
      auto& ground = s.AddContact<Surface>("ground", o);
      const Diagram diagram = s.b.Build();
      Simulator sim(diagram, {.integrator = {.method = Method::kDormandPrince}});
      EXPECT_EQ(ErrorOf([&] { sim.AdvanceTo(4); }), "no error") << k << ' ' << c;
      // Bounces of speed v die out with ⅓ c g, what is left of the motion with ½ c g.
      if (c >= 5) {
        EXPECT_NEAR(sim.Get(ground.normal_force), kMass * kGravity, 0.02) << k << ' ' << c;
      }
    }
}

TEST(Surface, TouchesTheDeepestPointOfATipThatIsTurned) {
  const RobotModel m = Gen3();
  RandomStates random(m, 3);
  const Surface::Options o{.model = m,
                           .link = "tool_frame",
                           .point = {0.01, 0.02, 0.03},
                           .radius = kRadius,
                           .origin = {0, 0, 2},
                           .normal = {1, -2, 5},
                           .stiffness = 1e4,
                           .friction = 0.3};
  const int tool = m.link_index("tool_frame");
  const Vector3d n = o.normal.normalized();
  BlockTester<Surface> t(o);
  RobotDynamics d(m);
  for (int i = 0; i < 100; ++i) {
    ComputeDynamics(m, random.q(), random.v(), d);
    t.Set(t->motion, d);
    const FrameDynamics center = PointDynamics(m, d, tool, o.point);
    const Vector3d deepest = center.pose.position - kRadius * n;
    const Vector3d v = center.twist.tail<3>() - kRadius * center.twist.head<3>().cross(n);
    const double p = -n.dot(deepest - o.origin);
    EXPECT_NEAR(t.Get(t->penetration), p, 1e-14);
    EXPECT_LT((MotionOf(m, d, tool, t.Get(t->contact).point).position - deepest).norm(), 1e-14);
    const Vector3d v_t = v - n.dot(v) * n;
    const Vector3d slip = 0.3 * v_t / std::sqrt(v_t.squaredNorm() + 1e-6);
    const Vector3d F = p > 0 ? Vector3d(1e4 * p * (n - slip)) : Vector3d::Zero();
    EXPECT_LT((t.Get(t->contact).force - F).norm(), 1e-9);
  }
}

TEST(Surface, CarriesTheToolOfAnArmThatSinksOnToIt) {
  const RobotModel m = Gen3();
  const JointPosition posture{0, 0.9, 0, 1.2, 0, 1.0, 0};
  RobotDynamics d(m);
  ComputeDynamics(m, posture, JointVelocity::Zero(m.joints()), d);
  const Vector3d tool = LinkPose(m, d, m.link_index("tool_frame")).position;
  Scene s({.model = m,
           .position = posture,
           .damping = PerJoint::Constant(7, 8),
           .rotor_inertia = PerJoint::Constant(7, 0.3)});
  auto& table = s.AddContact<Surface>("table", {.model = m,
                                                .link = "tool_frame",
                                                .radius = 0.02,
                                                .origin = tool - Vector3d(0, 0, 0.05),
                                                .stiffness = 2e4,
                                                .damping = 1,
                                                .friction = 0.5});
  JointTorque hold = d.gravity;  // but for a push down by 20 N
  hold -= PointDynamics(m, d, m.link_index("tool_frame"), Vector3d::Zero()).J.row(5) * 20.0;
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, {.integrator = {.method = Method::kDormandPrince,
                                         .relative_tolerance = 1e-9,
                                         .absolute_tolerance = 1e-10}});
  const double before = sim.Get(s.balance.stored);
  sim.Set(s.torque.value, hold);
  for (int k = 1; k <= 200; ++k) {
    sim.AdvanceTo(0.01 * k);
    EXPECT_GE(sim.Get(s.balance.least_dissipation), 0) << k;
  }
  EXPECT_TRUE(sim.Get(table.touching));
  // The push of 20 N, give or take what gravity's torques and J have changed over the 5 cm down:
  // from a quarter of it to two and a half times. p = N/k but for the damping, which has died out.
  EXPECT_GT(sim.Get(table.normal_force), 5);
  EXPECT_LT(sim.Get(table.normal_force), 50);
  EXPECT_LT(sim.Get(table.penetration), 50 / 2e4);
  const Vector3d F = sim.Get(table.contact).force;
  EXPECT_LT(F.head<2>().norm(), 0.5 * F(2));
  // The constant torques work hold · (q − q₀): all the rest is in the balance.
  const double work = hold.dot(sim.Get(s.plant.position) - posture);
  EXPECT_NEAR(sim.Get(s.balance.total) - before, work, 1e-6);  // 1e-9 of 40 J, some steps
}

TEST(Surface, KeepsTheLaws) {
  const RobotModel m = Gen3();
  Surface::Options o = Ground(m);
  o.link = "tool_frame";
  o.damping = 1;
  o.friction = 0.5;
  BlockTester<Surface> t(o);
  t.Set(t->motion, RobotDynamics(m));
  ExpectBlockLaws(std::move(t));
}

TEST(Surface, RefusesWhatIsNoSurface) {
  const auto error = [](auto change) {
    Surface::Options o = Ground(Gantry(kMass));
    change(o);
    return ErrorOf([&] { Surface surface(o); });
  };
  using O = Surface::Options;
  EXPECT_EQ(error([](O& o) { o.radius = -0.1; }), "radius must be >= 0 m, got -0.1");
  EXPECT_EQ(error([](O& o) { o.stiffness = 0; }), "stiffness must be > 0 N/m, got 0");
  EXPECT_EQ(error([](O& o) { o.damping = -1; }), "damping must be >= 0 s/m, got -1");
  EXPECT_EQ(error([](O& o) { o.friction = -0.3; }), "friction must be >= 0, got -0.3");
  EXPECT_EQ(error([](O& o) { o.slip_speed = 0; }), "slip_speed must be > 0 m/s, got 0");
  EXPECT_EQ(error([](O& o) { o.normal.setZero(); }),
            "normal must be finite and not zero, got 0 0 0");
  EXPECT_EQ(error([](O& o) { o.normal = {0, 0, 1e200}; }), "no error") << "of any length";
  EXPECT_THAT(error([](O& o) { o.origin(0) = NAN; }), testing::HasSubstr("origin must be finite"));
  EXPECT_THAT(error([](O& o) { o.point(0) = NAN; }), testing::HasSubstr("point must be finite"));
  EXPECT_THAT(error([](O& o) { o.link = "tup"; }), testing::HasSubstr("tip"));
}

}  // namespace
}  // namespace pliant
