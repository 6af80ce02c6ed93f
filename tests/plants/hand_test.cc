#include "pliant/plants/hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/hold.h"
#include "pliant/systems/pulse.h"
#include "pliant/systems/ramp.h"
#include "pliant/systems/sine.h"
#include "pliant/systems/step.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/energy_balance.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kMass = 2;

RobotModel Weightless() { return Gantry(kMass).WithGravity({0, 0, 0}); }

TEST(Hand, IsASpringAndADamperAlongEachAxis) {
  const RobotModel m = Weightless();
  const Vector3d k{100, 400, 50};
  const double d = 6;
  Scene s({.model = m, .position = {0, 0, 0}});
  auto& path = s.b.Add<Constant<Position>>("path", {.value = {0.1, -0.2, 0.3}});
  auto& hand =
      s.AddContact<Hand>("hand", {.model = m, .link = "tip", .stiffness = k, .damping = d});
  s.b.Connect(path.y, hand.path);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  for (const double t : {0.1, 0.5, 2.0}) {
    sim.AdvanceTo(t);
    for (int i = 0; i < 3; ++i) {
      const double sigma = d / (2 * kMass), omega = std::sqrt(k(i) / kMass - sigma * sigma);
      const double goal = Vector3d(0.1, -0.2, 0.3)(i);
      const double x = goal * (1 - std::exp(-sigma * t) *
                                       (std::cos(omega * t) + sigma / omega * std::sin(omega * t)));
      EXPECT_NEAR(sim.Get(s.plant.position)(i), x, 1e-10) << i;  // tolerance 1e-12 per step
    }
  }
}

/// A hand that leads a point along a sine, and its energy.
void ExpectBalanceOfAPathOn(const RobotModel& m, const JointPosition& posture,
                            const std::string& link, bool anchored) {
  Scene s({.model = m, .position = posture, .damping = PerJoint::Constant(m.size(), 0.3)});
  const double omega = 2 * std::numbers::pi * 0.7;
  auto& path = s.b.Add<Sine<Position>>(
      "path", {.amplitude = {0.2, 0.1, -0.1}, .offset = {0.3, 0.2, 0.6}, .frequency_hz = 0.7});
  auto& velocity = s.b.Add<Sine<LinearVelocity>>(
      "velocity", {.amplitude = {0.2 * omega, 0.1 * omega, -0.1 * omega},
                   .frequency_hz = 0.7,
                   .phase = std::numbers::pi / 2});
  auto& hand = s.AddContact<Hand>("hand", {.model = m,
                                           .link = link,
                                           .stiffness = {300, 500, 400},
                                           .damping = 20,
                                           .anchored = anchored});
  s.b.Connect(path.y, hand.path);
  s.b.Connect(velocity.y, hand.path_velocity);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  const double before = sim.Get(s.balance.total);
  double work = 0;
  for (double t = 0.01; t < 2; t += 0.01) {
    sim.AdvanceTo(t);
    work += 0.01 * std::abs(sim.Get(hand.power));
    EXPECT_GE(sim.Get(s.balance.least_dissipation), 0);
  }
  EXPECT_GT(work, 1);
  EXPECT_NEAR(sim.Get(s.balance.total), before, 1e-8);  // tolerance 1e-11, some thousand steps
}

TEST(Hand, LosesOnlyWhatItDissipates) {
  for (const bool anchored : {false, true}) {
    ExpectBalanceOfAPathOn(Weightless(), {0, 0, 0}, "tip", anchored);
    ExpectBalanceOfAPathOn(Gen3(), {0.1, 0.4, 0.2, -1.2, 0.3, 0.8, 0.1}, "tool_frame", anchored);
  }
}

TEST(Hand, LetsGo) {
  const RobotModel m = Weightless();
  Scene s({.model = m, .position = {0.1, 0, 0}});
  auto& path = s.b.Add<Constant<Position>>("path", {.value = {0, 0, 0}});
  auto& grip = s.b.Add<Step<double>>("grip", {.before = 1, .after = 0, .at = 100ms});
  auto& hand = s.AddContact<Hand>(
      "hand", {.model = m, .link = "tip", .stiffness = Vector3d::Constant(kMass * 25)});
  s.b.Connect(path.y, hand.path);
  s.b.Connect(grip.y, hand.grip);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.AdvanceTo(1.1);
  // ω = 5 rad/s up to 0.1 s, then at constant velocity; tolerance 1e-12 per step.
  const double v = -0.1 * 5 * std::sin(0.5);
  EXPECT_NEAR(sim.Get(s.plant.velocity)(0), v, 1e-10);
  EXPECT_NEAR(sim.Get(s.plant.position)(0), 0.1 * std::cos(0.5) + v, 1e-10);
  EXPECT_EQ(sim.Get(hand.contact).force, Vector3d(Vector3d::Zero()));
  EXPECT_EQ(sim.Get(hand.energy), 0);
}

TEST(Hand, TakesHoldOfAMovingPointWhereItIs) {
  const RobotModel m = Weightless();
  const double v0 = 0.5;
  Scene s({.model = m, .position = {0, 0, 0}, .velocity = {v0, 0, 0}});
  // Far away and under way when the hand takes hold: only the way after that counts.
  auto& path =
      s.b.Add<Ramp<Position>>("path", {.start = {7, 0, 0}, .goal = {7, 1, 0}, .duration = 4s});
  auto& rate = s.b.Add<Constant<LinearVelocity>>("rate", {.value = {0, 0.25, 0}});
  auto& grip = s.b.Add<Pulse<double>>("grip", {.high = 1, .at = 400ms, .width = 2s});
  auto& hand = s.AddContact<Hand>("hand", {.model = m,
                                           .link = "tip",
                                           .stiffness = Vector3d::Constant(kMass * 25),
                                           .damping = 0,
                                           .anchored = true});
  s.b.Connect(path.y, hand.path);
  s.b.Connect(rate.y, hand.path_velocity);
  s.b.Connect(grip.y, hand.grip);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.AdvanceTo(0.4);
  EXPECT_EQ(sim.Get(hand.contact).force, Vector3d(Vector3d::Zero()));
  sim.AdvanceTo(0.4 + 1e-9);
  EXPECT_LT(sim.Get(hand.contact).force.norm(), 1e-6) << "without a jerk";
  for (const double t : {0.1, 0.7, 1.9}) {
    sim.AdvanceTo(0.4 + t);
    const JointPosition& x = sim.Get(s.plant.position);
    EXPECT_NEAR(x(0), 0.4 * v0 + v0 / 5 * std::sin(5 * t), 1e-10);
    EXPECT_NEAR(x(1), 0.25 * (t - std::sin(5 * t) / 5), 1e-10);
  }
}

TEST(Hand, TakesHoldAgainWhereThePointIsThen) {
  const RobotModel m = Weightless();
  Scene s({.model = m, .position = {0, 0, 0}, .velocity = {0.5, 0, 0}});
  auto& grip =
      s.b.Add<Pulse<double>>("grip", {.high = 1, .at = 100ms, .width = 50ms, .period = 200ms});
  auto& hand = s.AddContact<Hand>("hand", {.model = m,
                                           .link = "tip",
                                           .stiffness = Vector3d::Constant(100),
                                           .damping = 5,
                                           .anchored = true});
  s.b.Connect(grip.y, hand.grip);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  for (const double t : {0.1, 0.3, 0.5, 0.7}) {
    sim.AdvanceTo(t);
    sim.AdvanceThroughTick();
    EXPECT_EQ(sim.Get(hand.contact).force, Vector3d(Vector3d::Zero())) << "not yet, at " << t;
    sim.AdvanceTo(t + 1e-9);
    EXPECT_NEAR(sim.Get(hand.energy), 0, 1e-14) << t;
    EXPECT_NEAR(sim.Get(hand.contact).force(0), -5 * sim.Get(s.plant.velocity)(0), 1e-6) << t;
  }
}

TEST(Hand, HoldsFromTheStart) {
  const RobotModel m = Weightless();
  BlockTester<Hand> t(
      {.model = m, .link = "tip", .stiffness = Vector3d::Constant(100), .anchored = true});
  RobotDynamics d(m);
  ComputeDynamics(m, {0.1, 0.2, 0.3}, {0, 0, 0}, d);
  t.Set(t->motion, d);
  EXPECT_EQ(t.Get(t->contact).force, Vector3d(Vector3d::Zero()));
  ComputeDynamics(m, {0.1, 0.25, 0.3}, {0, 0, 0}, d);
  t.Set(t->motion, d);
  EXPECT_LT((t.Get(t->contact).force - Vector3d(0, -5, 0)).norm(), 1e-13);
  t.Set(t->path, {0, 0.05, 0});
  EXPECT_LT(t.Get(t->contact).force.norm(), 1e-13);
}

TEST(Hand, TakesHoldWithoutAJerkWhereItsPathIsSampled) {
  const RobotModel m = Weightless();
  Scene s({.model = m, .position = {0, 0, 0}});
  auto& path = s.b.Add<Constant<Position>>("path", {.value = {0.1, 0, 0}});
  auto& sampled = s.b.Add<Hold<Position>>("sampled", {.period = 1ms});
  auto& hand = s.AddContact<Hand>(
      "hand", {.model = m, .link = "tip", .stiffness = Vector3d::Constant(1000), .anchored = true});
  s.b.Connect(path.y, sampled.u);
  s.b.Connect(sampled.y, hand.path);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram);
  sim.AdvanceTo(0.01);
  EXPECT_EQ(sim.Get(hand.contact).force, Vector3d(Vector3d::Zero()));
}

TEST(Hand, GripsBetweenNotAtAllAndFully) {
  const RobotModel m = Weightless();
  BlockTester<Hand> t({.model = m, .link = "tip", .stiffness = {10, 10, 10}});
  RobotDynamics d(m);
  ComputeDynamics(m, {0, 0, 0}, {0, 0, 0}, d);
  t.Set(t->motion, d);
  t.Set(t->path, {1, 0, 0});
  for (const auto& [g, force] :
       {std::pair(-3.0, 0.0), {0.0, 0.0}, {0.3, 3.0}, {1.0, 10.0}, {9.0, 10.0}}) {
    t.Set(t->grip, g);
    EXPECT_DOUBLE_EQ(t.Get(t->contact).force(0), force);
    EXPECT_DOUBLE_EQ(t.Get(t->energy), force / 2);
  }
}

TEST(Hand, KeepsTheLaws) {
  const RobotModel m = Gen3();
  for (const bool anchored : {false, true}) {
    BlockTester<Hand> t({.model = m,
                         .link = "tool_frame",
                         .stiffness = {100, 200, 300},
                         .damping = 5,
                         .anchored = anchored});
    t.Set(t->motion, RobotDynamics(m));
    ExpectBlockLaws(std::move(t));
  }
}

TEST(Hand, RefusesWhatNoHandIs) {
  const auto error = [](auto change) {
    Hand::Options o{.model = Gen3(), .link = "tool_frame", .stiffness = {1, 2, 3}};
    change(o);
    return ErrorOf([&] { Hand hand(o); });
  };
  using O = Hand::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness(1) = -1; }), "stiffness[y] must be >= 0 N/m, got -1");
  EXPECT_EQ(error([](O& o) { o.damping = NAN; }), "damping must be >= 0 N·s/m, got nan");
  EXPECT_THAT(error([](O& o) { o.point(0) = NAN; }), testing::HasSubstr("point must be finite"));
  EXPECT_THAT(error([](O& o) { o.link = "tool_fram"; }), testing::HasSubstr("tool_frame"));
}

}  // namespace
}  // namespace pliant
