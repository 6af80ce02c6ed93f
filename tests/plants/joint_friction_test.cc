#include "pliant/plants/joint_friction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "pliant/systems/diagram.h"
#include "pliant/systems/integral.h"
#include "pliant/systems/ramp.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/plants/masses.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kOne{"joint"};
const FrictionParameters kGen3{.coulomb = 3,
                               .viscous = 2.416,
                               .stiction = 3,
                               .bristle_stiffness = 6000,
                               .bristle_damping = 49};
const FrictionParameters kStribeck{
    .coulomb = 2, .viscous = 1, .stiction = 3, .stribeck_velocity = 0.2, .bristle_stiffness = 4000};

BlockTester<JointFriction> Tester(FrictionLaw law, const FrictionParameters& p,
                                  const IntegratorOptions& integrator = {}) {
  return BlockTester<JointFriction>(
      JointFriction::Options{.joints = kOne, .law = law, .parameters = {p}},
      {.integrator = integrator});
}

TEST(JointFriction, EndsOnTheSteadyCurveAtConstantVelocity) {
  const IntegratorOptions accurate{
      .method = Method::kDormandPrince, .relative_tolerance = 1e-10, .absolute_tolerance = 1e-12};
  for (const FrictionLaw law : {FrictionLaw::LuGre, FrictionLaw::ElastoPlastic})
    for (const double v : {-1.5, -0.1, 0.05, 0.3, 2.0}) {
      auto t = Tester(law, kStribeck, accurate);
      t.Set(t->velocity, {v});
      t.AdvanceTo(0.05 / std::abs(v));  // 0.05 rad: 66 bristle lengths, e⁻⁶⁶ from the end
      const double g = 2 + std::exp(-v * v / 0.04);
      EXPECT_NEAR(t.Get(t->torque)(0), std::copysign(g, v) + v, 1e-8) << v;
      EXPECT_NEAR(SteadyFriction(kStribeck, v), std::copysign(g, v) + v, 1e-15);
    }
}

TEST(JointFriction, IsSmoothWithoutBristles) {
  const double v = 2e-3, tanh = std::tanh(2.0);
  auto coulomb = Tester(FrictionLaw::CoulombViscous, kStribeck);
  coulomb.Set(coulomb->velocity, {v});
  EXPECT_DOUBLE_EQ(coulomb.Get(coulomb->torque)(0), 2 * tanh + v);
  auto stribeck = Tester(FrictionLaw::Stribeck, kStribeck);
  stribeck.Set(stribeck->velocity, {-v});
  EXPECT_DOUBLE_EQ(stribeck.Get(stribeck->torque)(0), -(2 + std::exp(-1e-4)) * tanh - v);
  auto none = Tester(FrictionLaw::None, kStribeck);
  none.Set(none->velocity, {v});
  EXPECT_EQ(none.Get(none->torque)(0), 0);
}

/// A mass of 0.4 kg·m² at rest on friction, driven by a torque of time.
struct Driven {
  Masses* mass;
  JointFriction* friction;
  Diagram diagram;

  template <class Source>
  static Driven By(FrictionLaw law, const FrictionParameters& p,
                   const typename Source::Options& source) {
    DiagramBuilder b;
    auto& torque = b.Add<Source>("torque", source);
    auto& m = b.Add<Masses>("mass", {.joints = kOne, .inertia = PerJoint::Constant(1, 0.4)});
    auto& f = b.Add<JointFriction>("friction", {.joints = kOne, .law = law, .parameters = {p}});
    b.Connect(torque.y, m.torque);
    b.Connect(m.velocity, f.velocity);
    b.Connect(f.torque, m.friction);
    return {&m, &f, b.Build()};
  }
};

TEST(JointFriction, BreaksAwayAtItsStiction) {
  for (const FrictionLaw law : {FrictionLaw::LuGre, FrictionLaw::ElastoPlastic})
    for (const FrictionParameters& p : {kGen3, kStribeck}) {
      const double slope = 1.2 * p.stiction / 60;
      const Driven run = Driven::By<Ramp<JointTorque>>(
          law, p, {.space = kOne, .goal = {1.2 * p.stiction}, .duration = 60s});
      Simulator sim(run.diagram);
      double t = 0;
      while (t < 60 && std::abs(sim.Get(run.mass->velocity)(0)) < 0.01) sim.AdvanceTo(t += 0.01);
      // At 0.01 rad/s, of which the ramp alone makes 2·10⁻⁵, the bristles are within 0.2 % of
      // yielding; the rest is the mass: 0.4 kg·m² gets there in 0.4 s of the ramp.
      EXPECT_NEAR(slope * t, p.stiction, 0.02 * p.stiction);
    }
}

/// Nothing ticks in an hour of these.
const Simulator::Options kLong{
    .integrator = {.method = Method::kDormandPrince, .max_steps_between_events = 100'000'000}};

/// Load of half the stiction, and a quarter of it on top that swings.
Sine<JointTorque>::Options Shaking(double frequency_hz) {
  return {.space = kOne, .amplitude = {0.75}, .offset = {1.5}, .frequency_hz = frequency_hz};
}

TEST(JointFriction, HoldsAnHourUnderALoadThatShakes) {
  const Driven run = Driven::By<Sine<JointTorque>>(FrictionLaw::ElastoPlastic, kGen3, Shaking(2));
  Simulator sim(run.diagram, kLong);
  sim.AdvanceTo(3600);
  // Bristles that only bend are springs: m q̈ + (σ₁ + d) q̇ + σ₀ q = τ, at phase 0 of the swing.
  const double omega = 4 * std::numbers::pi;
  const std::complex<double> stiffness(6000 - 0.4 * omega * omega, (49 + 2.416) * omega);
  const double bent = 1.5 / 6000 + (0.75 / stiffness).imag();
  EXPECT_NEAR(sim.Get(run.friction->deflection)(0), bent, 1e-7);  // ten local errors
  // q̇ = ż, and a Runge–Kutta method keeps q − z to round-off of a million steps.
  EXPECT_NEAR(sim.Get(run.mass->position)(0), sim.Get(run.friction->deflection)(0), 1e-12);
}

TEST(JointFriction, HoldsAnHourUnderAConstantLoad) {
  const auto crept = [](double load) {
    const Driven run = Driven::By<Ramp<JointTorque>>(
        FrictionLaw::ElastoPlastic, kGen3, {.space = kOne, .goal = {load}, .duration = 1s});
    Simulator sim(run.diagram, kLong);
    sim.AdvanceTo(60);
    const double q = sim.Get(run.mass->position)(0);
    EXPECT_LT(q, 2e-3);  // some bristle lengths of 0.5 mrad
    sim.AdvanceTo(3600);
    return std::abs(sim.Get(run.mass->position)(0) - q);
  };
  EXPECT_LT(crept(2.3), 1e-8);  // below β c: elastic, to the tolerance of the integrator
  // Between β c and c any velocity slips in part, also what the integrator lets pass for none: an
  // rms of 10⁻⁸ over three states, so up to √3 10⁻⁸ rad/s for an hour.
  EXPECT_LT(crept(2.9), 3600 * std::sqrt(3) * 1e-8);
}

TEST(JointFriction, CreepsByLuGreUnderALoadThatShakes) {
  const Driven run = Driven::By<Sine<JointTorque>>(FrictionLaw::LuGre, kGen3, Shaking(0.5));
  Simulator sim(run.diagram);
  sim.AdvanceTo(2);
  const double before = sim.Get(run.mass->position)(0);
  sim.AdvanceTo(22);
  // Quasi-static: dx = dz/(1 − z/z_ss) on the way up, dz/(1 + z/z_ss) on the way down, between a
  // quarter and three quarters of z_ss. Inertia adds (0.5 Hz/19 Hz)², viscosity less.
  const double per_cycle = 3.0 / 6000 * (std::log(0.75 / 0.25) - std::log(1.75 / 1.25));
  EXPECT_NEAR(sim.Get(run.mass->position)(0) - before, 10 * per_cycle, 0.01 * 10 * per_cycle);
}

/// Energy lost in a cycle of x = A sin(t), steady.
double LoopArea(FrictionLaw law, const FrictionParameters& p, double amplitude) {
  DiagramBuilder b;
  auto& velocity = b.Add<Sine<JointVelocity>>("velocity", {.space = kOne,
                                                           .amplitude = {amplitude},
                                                           .frequency_hz = 0.5 / std::numbers::pi,
                                                           .phase = std::numbers::pi / 2});
  auto& friction =
      b.Add<JointFriction>("friction", {.joints = kOne, .law = law, .parameters = {p}});
  auto& lost = b.Add<Integral<double>>("lost", {});
  b.Connect(velocity.y, friction.velocity);
  b.Connect(friction.dissipation, lost.u);
  const Diagram diagram = b.Build();
  Simulator sim(diagram, {.integrator = {.method = Method::kDormandPrince,
                                         .relative_tolerance = 1e-10,
                                         .absolute_tolerance = 1e-13}});
  const double turn = 2 * std::numbers::pi;
  sim.AdvanceTo(20 * turn);
  const double before = sim.Get(lost.y);
  sim.AdvanceTo(21 * turn);
  return sim.Get(lost.y) - before;
}

TEST(JointFriction, LosesTheAreaOfItsHysteresisLoop) {
  FrictionParameters dry = kGen3;
  dry.viscous = dry.bristle_damping = 0;
  const double c = dry.coulomb, bend = c / dry.bristle_stiffness;
  for (const double amplitude : {0.5 * bend, 2 * bend, 20 * bend}) {
    // LuGre without its velocity terms is Dahl's law: F → c like e^{−x/bend} after a reversal.
    const double E = std::exp(-2 * amplitude / bend), reversal = c * (1 - E) / (1 + E);
    const double area = 2 * (2 * amplitude * c - (c + reversal) * bend * (1 - E));
    EXPECT_NEAR(LoopArea(FrictionLaw::LuGre, dry, amplitude), area, 1e-6 * area);
  }
  // Elastic up to β c: no loop.
  EXPECT_NEAR(LoopArea(FrictionLaw::ElastoPlastic, dry, 0.79 * bend), 0, 1e-12);
  // Far above, half a rectangle 4 A c lacks c − F over the bristles' way: elastic from −c to β c,
  // (3 − β)(1 + β)/2 c·bend, and from there to c between (1 − β)²/2 (elastic) and 1 − β (Dahl).
  const double beta = dry.elastic_part, elastic = (3 - beta) * (1 + beta);
  const double area = LoopArea(FrictionLaw::ElastoPlastic, dry, 20 * bend);
  EXPECT_GT(area, (4 * 20 - elastic - 2 * (1 - beta)) * c * bend);
  EXPECT_LT(area, (4 * 20 - elastic - (1 - beta) * (1 - beta)) * c * bend);
}

TEST(JointFriction, OnlyTakesEnergy) {
  FrictionParameters stribeck = kStribeck;
  stribeck.bristle_damping = 1.9;  // d ≥ σ₁ (s − c)/c holds up to 2
  for (const FrictionLaw law : {FrictionLaw::CoulombViscous, FrictionLaw::Stribeck,
                                FrictionLaw::LuGre, FrictionLaw::ElastoPlastic})
    for (const FrictionParameters& p : {kGen3, stribeck}) {
      auto t = Tester(law, p);
      t.Set(t->velocity, {0});
      std::mt19937 random(3);
      std::uniform_real_distribution<double> velocity(-1, 1);
      for (int k = 1; k < 2000; ++k) {
        t.Set(t->velocity, {std::pow(velocity(random), 5)});
        t.AdvanceTo(1e-3 * k);
        EXPECT_GE(t.Get(t->dissipation), -1e-9) << k;
      }
    }
}

TEST(JointFriction, KeepsTheLawsOfBlocks) {
  for (const FrictionLaw law :
       {FrictionLaw::None, FrictionLaw::Stribeck, FrictionLaw::LuGre, FrictionLaw::ElastoPlastic})
    ExpectBlockLaws(Tester(law, kGen3), {.amplitude = 1});
}

TEST(JointFriction, RefusesWhatIsNoFriction) {
  const auto error = [](auto change) {
    FrictionParameters p = kGen3;
    change(p);
    return ErrorOf([&] { JointFriction f({.joints = kOne, .parameters = {p}}); });
  };
  using P = FrictionParameters;
  EXPECT_EQ(error([](P& p) { p.coulomb = -1; }), "joint: coulomb must be >= 0 N·m, got -1");
  EXPECT_EQ(error([](P& p) { p.bristle_stiffness = 0; }),
            "joint: bristle_stiffness must be > 0 N·m/rad, got 0");
  EXPECT_EQ(error([](P& p) { p.stiction = 2; }), "joint: stiction must be >= 3 N·m, got 2");
  EXPECT_EQ(error([](P& p) { p.coulomb = 0; }), "coulomb must be > 0 where stiction is");
  EXPECT_EQ(error([](P& p) { p.elastic_part = 1; }),
            "joint: elastic_part must be from 0 to 0.99, got 1");
  EXPECT_EQ(error([](P& p) { p.viscous = NAN; }), "joint: viscous must be >= 0 N·m·s/rad, got nan");
  EXPECT_EQ(ErrorOf([] { JointFriction f({.joints = kOne, .parameters = {}}); }),
            "parameters has an element for each of the 1 joints, got 0");
}

}  // namespace
}  // namespace pliant
