#include "pliant/plants/mass_on_rope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/energy_balance.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// A rope tied to the world, 2 m above the ground.
MassOnRope::Options Hung() {
  return {.model = Gantry(1),
          .link = "ground",
          .point = {0, 0, 2},
          .mass = 1.5,
          .length = 0.8,
          .stiffness = 2000,
          .position = {0, 0, 2}};
}

/// A mass on a rope tied to the world, that runs by itself.
struct Hanging {
  explicit Hanging(const MassOnRope::Options& o, const Simulator::Options& run = kAccurately)
      : tester(o, run) {
    RobotDynamics d(o.model);
    ComputeDynamics(o.model, JointPosition::Zero(o.model.joints()),
                    JointVelocity::Zero(o.model.joints()), d);
    tester.Set(tester->motion, d);
  }
  template <class V>
  const typename V::Signal& Get(const V& value) {
    return tester.Get(value);
  }
  MassOnRope* operator->() { return &*tester; }
  void AdvanceTo(double t) { tester.AdvanceTo(t); }

  BlockTester<MassOnRope> tester;
};

TEST(MassOnRope, FallsFreelyUntilTheRopeCatchesIt) {
  MassOnRope::Options o = Hung();
  o.position = {0.1, -0.2, 2.1};
  o.velocity = {0.3, 0.1, 0.5};
  o.damping = 20;
  o.release = 250ms;
  Hanging h(o);
  h.AdvanceTo(0.2);
  EXPECT_EQ(h.Get(h->position), Position({0.1, -0.2, 2.1})) << "held";
  EXPECT_EQ(h.Get(h->velocity), LinearVelocity({0, 0, 0}));
  const auto x = [&](double t) {
    const double s = t - 0.25;
    return Vector3d(o.position + s * o.velocity - Vector3d(0, 0, 0.5 * kGravity * s * s));
  };
  double caught = 0.25, later = 1;  // by bisection of ‖x(t) − a‖ = L
  while (later - caught > 1e-15) {
    const double middle = 0.5 * (caught + later);
    ((x(middle) - o.point).norm() < o.length ? caught : later) = middle;
  }
  h.AdvanceTo(caught - 1e-9);
  EXPECT_FALSE(h.Get(h->taut));
  EXPECT_EQ(h.Get(h->catches), 0);
  EXPECT_EQ(h.Get(h->tension), 0);
  EXPECT_LT((h.Get(h->position) - x(h.tester.time())).norm(), 1e-12);  // parabola: round-off
  h.AdvanceTo(caught + 1e-9);
  EXPECT_TRUE(h.Get(h->taut));
  EXPECT_EQ(h.Get(h->catches), 1);
  const Vector3d u = (x(caught) - o.point).normalized();
  const Vector3d v = o.velocity - Vector3d(0, 0, kGravity * (caught - 0.25));
  // The blow of the damper, and a nanosecond of what follows.
  EXPECT_NEAR(h.Get(h->tension), o.damping * u.dot(v), 1e-3);
}

TEST(MassOnRope, PullsAsEnergySaysWhenAnUndampedRopeCatchesIt) {
  MassOnRope::Options o = Hung();
  o.position = {0, 0, 1.7};
  const double m = o.mass, k = o.stiffness, h = 0.5;  // falls half a metre
  Hanging drop(o);
  const double caught = std::sqrt(2 * h / kGravity), speed = kGravity * caught;
  const double omega = std::sqrt(k / m);
  const double peak = caught + (std::numbers::pi - std::atan(speed * omega / kGravity)) / omega;
  drop.AdvanceTo(peak);
  const double mg = m * kGravity;
  // m g (h + δ) = ½ k δ². Flat in time there; tolerance 1e-11 of metres, times k.
  EXPECT_NEAR(drop.Get(drop->tension), mg + std::sqrt(mg * mg + 2 * m * kGravity * k * h), 1e-6);
  EXPECT_NEAR(drop.Get(drop->velocity)(2), 0, 1e-6);  // a nanosecond of ω² δ, tolerance
  const double slack = 2 * peak - caught;
  drop.AdvanceTo(slack - 2e-9);
  EXPECT_TRUE(drop.Get(drop->taut));
  drop.AdvanceTo(slack + 2e-9);
  EXPECT_FALSE(drop.Get(drop->taut)) << "as long after the peak as the catch was before";
  drop.AdvanceTo(slack + caught);
  EXPECT_NEAR(drop.Get(drop->position)(2), 1.7, 1e-9) << "back where it came from";
}

TEST(MassOnRope, HangsAtRestWhereItStretchesTheRopeByItsWeight) {
  MassOnRope::Options o = Hung();
  o.position = {0.3, 0.2, 1.4};
  o.damping = 60;
  o.stiffness = 500;
  Hanging h(o);
  h.AdvanceTo(1);
  EXPECT_GE(h.Get(h->catches), 1);
  MassOnRope::Options still = o;
  still.position = {0, 0, 2 - o.length};  // just straight
  Hanging s(still);
  s.AdvanceTo(5);
  EXPECT_TRUE(s.Get(s->taut));
  // exp(−5 s · 17 s⁻¹) has died out; the absolute tolerance is 1e-12.
  EXPECT_NEAR(s.Get(s->position)(2), 2 - o.length - o.mass * kGravity / o.stiffness, 1e-11);
  EXPECT_NEAR(s.Get(s->tension), o.mass * kGravity, 1e-8);
  EXPECT_LT((s.Get(s->contact).force - Vector3d(0, 0, -o.mass * kGravity)).norm(), 1e-8);
}

TEST(MassOnRope, SwingsWithThePeriodOfALargePendulum) {
  MassOnRope::Options o = Hung();
  const double amplitude = 1.4, L = o.length;  // 80°
  o.stiffness = 1e6;
  o.position = {L * std::sin(amplitude), 0, 2 - L * std::cos(amplitude)};
  Hanging h(o);
  const double quarter =
      std::sqrt(L / kGravity) * std::comp_ellint_1(std::sin(amplitude / 2));  // of an inelastic one
  // The rope is between L and L + 2 T/k long, twice the static stretch, T ≤ 3 m g; a pendulum with
  // a longer rope is slower by √.
  const double slower = std::sqrt(1 + 6 * o.mass * kGravity / o.stiffness / L);
  for (const int n : {1, 5, 9}) {
    const double sign = n % 4 == 1 ? 1 : -1;
    h.AdvanceTo(n * quarter);
    EXPECT_GE(sign * h.Get(h->position)(0), -1e-9) << n;
    h.AdvanceTo(n * quarter * slower);
    EXPECT_LE(sign * h.Get(h->position)(0), 1e-9) << n;
  }
  EXPECT_LT(slower, 1.0001);
  EXPECT_EQ(h.Get(h->position)(1), 0);
}

TEST(MassOnRope, RunsRoundACone) {
  MassOnRope::Options o = Hung();
  const double alpha = 0.9;
  // T cos α = m g and T sin α = m ω² ℓ sin α with the stretched rope ℓ: exact for an elastic rope.
  const double l = o.length + o.mass * kGravity / std::cos(alpha) / o.stiffness;
  const double omega = std::sqrt(kGravity / (l * std::cos(alpha)));
  o.position = {l * std::sin(alpha), 0, 2 - l * std::cos(alpha)};
  o.velocity = {0, omega * l * std::sin(alpha), 0};
  Hanging h(o);
  for (const double turns : {0.125, 0.5, 1.0, 3.0}) {
    const double angle = 2 * std::numbers::pi * turns;
    h.AdvanceTo(angle / omega);
    const Vector3d x{l * std::sin(alpha) * std::cos(angle), l * std::sin(alpha) * std::sin(angle),
                     2 - l * std::cos(alpha)};
    EXPECT_LT((h.Get(h->position) - x).norm(), 2e-8) << turns;  // 1 ns, and tolerance 1e-11
    EXPECT_NEAR(h.Get(h->tension), o.mass * kGravity / std::cos(alpha), 1e-5) << turns;
  }
}

TEST(MassOnRope, NeverPushesAndNeverMakesEnergy) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> one(-1, 1);
  int catches = 0;
  for (int run = 0; run < 12; ++run) {
    MassOnRope::Options o = Hung();
    o.damping = std::array{0.0, 1.0, 30.0, 300.0}[static_cast<std::size_t>(run % 4)];
    o.position = Vector3d(0, 0, 2) + 0.6 * Vector3d(one(random), one(random), one(random));
    o.velocity = 4 * Vector3d(one(random), one(random), one(random));
    Scene s({.model = o.model, .position = {0, 0, 0}});
    auto& rope = s.AddContact<MassOnRope>("rope", o);
    const Diagram diagram = s.b.Build();
    Simulator sim(diagram, kAccurately);
    sim.AdvanceTo(1e-9);  // thrown
    const double total = sim.Get(s.balance.total) - sim.Get(s.plant.energy);
    double last = sim.Get(rope.energy);
    for (double t = 0.01; t < 4; t += 0.01) {
      sim.AdvanceTo(t);
      EXPECT_GE(sim.Get(rope.tension), 0);
      EXPECT_GE(sim.Get(rope.dissipation), 0);
      EXPECT_LE(sim.Get(rope.energy), last + 1e-7);
      last = sim.Get(rope.energy);
    }
    // 1e-11 of 50 J in some thousand steps; the plant, tied to nothing, falls by itself.
    EXPECT_NEAR(sim.Get(s.balance.total) - sim.Get(s.plant.energy), total, 1e-6) << o.damping;
    catches += sim.Get(rope.catches);
  }
  EXPECT_GT(catches, 50);
}

TEST(MassOnRope, StartsStraightAndGoesEitherWay) {
  for (const double damping : {0.0, 10.0})
    for (const double up : {-1.0, 0.0, 1.0}) {
      MassOnRope::Options o = Hung();
      o.point = {0, 0, 1};
      o.length = 0.5;
      o.position = {0, 0, 0.5};
      o.velocity = {0, 0, up};
      o.damping = damping;
      Hanging h(o);
      h.AdvanceTo(0.01);
      EXPECT_EQ(h.Get(h->taut), up <= 0) << damping << ' ' << up;
      EXPECT_GE(h.Get(h->tension), 0);
      if (up > 0) {
        EXPECT_NEAR(h.Get(h->position)(2), 0.5 + 0.01 - 0.5 * kGravity * 1e-4, 1e-9);
        h.AdvanceTo(2 / kGravity + 1e-6);
        EXPECT_TRUE(h.Get(h->taut)) << damping;
      }
      EXPECT_EQ(h.Get(h->catches), up > 0) << damping;
    }
}

TEST(MassOnRope, KeepsTheMomentumOfTwoMasses) {
  const RobotModel m = Gantry(3).WithGravity({0, 0, 0});
  MassOnRope::Options o = Hung();
  o.model = m;
  o.link = "tip";
  o.point = {0.1, 0, 0};  // the tip does not turn: no moment arm
  o.position = {0.5, 0, 0};
  o.velocity = {1, 2, -0.5};
  o.damping = 5;
  Scene s({.model = m, .position = {0, 0, 0}});
  auto& rope = s.AddContact<MassOnRope>("rope", o);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.AdvanceTo(5);
  const Vector3d p = 3 * sim.Get(s.plant.velocity) + o.mass * sim.Get(rope.velocity);
  EXPECT_GT(sim.Get(rope.catches), 3);
  EXPECT_LT((p - o.mass * o.velocity).norm(), 1e-9);  // tolerance 1e-11, some hundred steps
  // Angular momentum about the centre of mass is that of the distance.
  const Vector3d r = sim.Get(rope.position) - sim.Get(s.plant.position) - o.point;
  const Vector3d w = sim.Get(rope.velocity) - sim.Get(s.plant.velocity);
  EXPECT_LT((r.cross(w) - Vector3d(0.4, 0, 0).cross(o.velocity)).norm(), 1e-9);
}

TEST(MassOnRope, OnAnArmKeepsTheEnergyOfBoth) {
  for (const double damping : {0.0, 40.0}) {
    const RobotModel m = Gen3();
    Scene s({.model = m, .position = {0.1, 0.9, 0.2, -1.2, 0.3, 0.8, 0.1}});
    MassOnRope::Options o = Hung();
    o.model = m;
    o.link = "tool_frame";
    o.point = {0, 0, 0.05};
    o.length = 0.3;
    o.damping = damping;
    RobotDynamics d(m);
    ComputeDynamics(m, {0.1, 0.9, 0.2, -1.2, 0.3, 0.8, 0.1}, JointVelocity::Zero(m.joints()), d);
    o.position = MotionOf(m, d, m.link_index("tool_frame"), o.point).position + Vector3d(0.1, 0, 0);
    o.velocity = {0.5, 0.5, -4};
    auto& rope = s.AddContact<MassOnRope>("rope", o);
    const Diagram diagram = s.b.Build();
    Simulator sim(diagram, kAccurately);
    sim.AdvanceTo(1e-9);
    const double total = sim.Get(s.balance.total), alone = sim.Get(s.plant.energy);
    sim.AdvanceTo(0.6);
    EXPECT_GT(sim.Get(rope.catches), 0);
    EXPECT_GT(std::abs(sim.Get(s.plant.energy) - alone), 1);
    EXPECT_NEAR(sim.Get(s.balance.total), total, 1e-6) << damping;  // 1e-11 of 60 J, 1200 steps
  }
}

TEST(MassOnRope, SettlesWithoutZenoBehaviour) {
  // A last rebound needs a speed of about g √(m/k), so it lasts as long as the rope's own period.
  for (const double k : {100.0, 1e4, 1e6})
    for (const double zeta : {0.01, 0.1, 0.5, 1.0, 3.0}) {
      MassOnRope::Options o = Hung();
      o.stiffness = k;
      o.damping = 2 * zeta * std::sqrt(k * o.mass);
      o.position = {0, 0, 1.7};
      Hanging h(o, {.integrator = {.method = Method::kDormandPrince}});
      EXPECT_EQ(ErrorOf([&] { h.AdvanceTo(4); }), "no error") << k << ' ' << zeta;
      if (zeta >= 0.1) {
        EXPECT_TRUE(h.Get(h->taut)) << k << ' ' << zeta;
      }
    }
}

TEST(MassOnRope, GoesOnFromAFileAsItWouldHaveGoneOn) {
  MassOnRope::Options o = Hung();
  o.position = {0.2, 0.1, 1.7};
  o.damping = 3;
  const TemporaryDirectory directory;
  Hanging h(o);
  Simulator& sim = h.tester.simulator();
  h.AdvanceTo(1.2345);
  sim.Save(directory.path() / "under_way");
  h.AdvanceTo(3);
  EXPECT_GT(h.Get(h->catches), 2);
  const Context end = sim.Snapshot();
  sim.Restore(directory.path() / "under_way");
  h.AdvanceTo(3);
  EXPECT_TRUE(sim.Snapshot() == end);
}

TEST(MassOnRope, KeepsTheLaws) {
  const RobotModel m = Gen3();
  MassOnRope::Options o = Hung();
  o.model = m;
  o.link = "tool_frame";
  o.damping = 10;
  BlockTester<MassOnRope> t(o);
  t.Set(t->motion, RobotDynamics(m));
  ExpectBlockLaws(std::move(t), {.amplitude = 0.5});
}

TEST(MassOnRope, RefusesWhatIsNoRope) {
  const auto error = [](auto change) {
    MassOnRope::Options o = Hung();
    change(o);
    return ErrorOf([&] { MassOnRope rope(o); });
  };
  using O = MassOnRope::Options;
  EXPECT_EQ(error([](O& o) { o.mass = 0; }), "mass must be > 0 kg, got 0");
  EXPECT_EQ(error([](O& o) { o.length = -1; }), "length must be > 0 m, got -1");
  EXPECT_EQ(error([](O& o) { o.stiffness = 0; }), "stiffness must be > 0 N/m, got 0");
  EXPECT_EQ(error([](O& o) { o.damping = -2; }), "damping must be >= 0 N·s/m, got -2");
  EXPECT_EQ(error([](O& o) { o.release = -1s; }), "release must be >= 0 s, got -1");
  EXPECT_THAT(error([](O& o) { o.position(1) = NAN; }),
              testing::HasSubstr("position must be finite"));
  EXPECT_THAT(error([](O& o) { o.velocity(1) = NAN; }),
              testing::HasSubstr("velocity must be finite"));
  EXPECT_THAT(error([](O& o) { o.link = "tup"; }), testing::HasSubstr("tip"));
}

}  // namespace
}  // namespace pliant
