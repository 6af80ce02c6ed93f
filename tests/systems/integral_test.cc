#include "pliant/systems/integral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Integral, OfAConstantIsALine) {
  BlockTester<Integral<JointPosition>> t({.space = kJoints, .initial = {1, 0}});
  t.Set(t->u, {2, -3});
  EXPECT_EQ(t.Get(t->y), (JointPosition{1, 0}));
  t.AdvanceTo(0.5);
  EXPECT_NEAR(t.Get(t->y)(0), 2, 1e-14);  // round-off only
  EXPECT_NEAR(t.Get(t->y)(1), -1.5, 1e-14);
}

TEST(Integral, OfASineIsACosine) {
  DiagramBuilder b;
  auto& sine = b.Add<Sine<double>>("sine", {.amplitude = 2, .frequency_hz = 1});
  auto& integral = b.Add<Integral<double>>("integral", {});
  b.Connect(sine.y, integral.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram,
                {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-10}}};
  sim.AdvanceTo(0.7);
  const double omega = 2 * std::numbers::pi;
  EXPECT_NEAR(sim.Get(integral.y), 2 / omega * (1 - std::cos(omega * 0.7)),
              1e-8);  // 100 · tolerance
}

TEST(Integral, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Integral<JointPosition>>({.space = kJoints}));
}

}  // namespace
}  // namespace pliant
