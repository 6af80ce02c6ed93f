#include "pliant/systems/discrete_linear_system.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/discrete_transfer_function.h"
#include "pliant/systems/linear_system.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/random_matrices.h"

namespace pliant {
namespace {

using System = DiscreteLinearSystem<NumberVector, NumberVector>;

TEST(DiscreteLinearSystem, IsThePlainRecursion) {
  RandomMatrices random(1);
  const LinearModel m{0.3 * random.Normal(3, 3), random.Normal(3, 2), random.Normal(2, 3),
                      random.Normal(2, 2)};
  Eigen::VectorXd x = random.Normal(3, 1);
  BlockTester<System> t({.input = Names::Numbered(2, "u"),
                         .output = Names::Numbered(2, "y"),
                         .model = m,
                         .initial = x,
                         .period = 10ms});
  for (int k = 0; k < 50; ++k) {
    const Eigen::VectorXd u = random.Normal(2, 1);
    t.Set(t->u, NumberVector(u));
    t.Tick();
    EXPECT_TRUE(t.Get(t->y).isApprox(m.C * x + m.D * u, 1e-13)) << "tick " << k;  // round-off
    x = m.A * x + m.B * u;
  }
}

TEST(DiscreteLinearSystem, HoldsItsOutputBetweenTicks) {
  BlockTester<DiscreteLinearSystem<double, double>> t(
      {.model = TransferFunction({1}, {1, -1}), .period = 10ms});
  t.Set(t->u, 1);
  t.Tick();
  t.Tick();
  EXPECT_EQ(t.Get(t->y), 1);
  t.AdvanceTo(0.0199);
  EXPECT_EQ(t.Get(t->y), 1) << "the state has gone on, the output waits for its tick";
}

// Of a held input, the sampled model is the continuous one.
TEST(DiscreteLinearSystem, OfASampledModelIsTheContinuousOne) {
  const LinearModel m = TransferFunction({2, 3}, {1, 0.4, 4});
  BlockTester<LinearSystem<double, double>> c(
      {.model = m}, {.integrator = {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-13}});
  BlockTester<DiscreteLinearSystem<double, double>> d({.model = Sampled(m, 0.05), .period = 50ms});
  for (int k = 0; k < 40; ++k) {
    const double u = std::sin(0.7 * k);
    c.Set(c->u, u);
    d.Set(d->u, u);
    d.Tick();
    c.AdvanceTo(0.05 * k);
    EXPECT_NEAR(d.Get(d->y), c.Get(c->y), 1e-8) << "errors of 40 steps within the tolerance";
    c.AdvanceTo(0.05 * (k + 1));
  }
}

TEST(DiscreteLinearSystem, OfATransferFunctionIsThatBlock) {
  const std::vector<double> b{0.2, 0.1, 0.05}, a{1, -0.9, 0.3};
  BlockTester<DiscreteLinearSystem<double, double>> x(
      {.model = TransferFunction(b, a), .period = 1ms});
  BlockTester<DiscreteTransferFunction<double>> y({.b = b, .a = a, .period = 1ms});
  for (int k = 0; k < 100; ++k) {
    const double u = std::cos(0.3 * k * k);
    x.Set(x->u, u);
    y.Set(y->u, u);
    x.Tick();
    y.Tick();
    EXPECT_NEAR(x.Get(x->y), y.Get(y->y), 1e-13) << "round-off";
  }
}

TEST(DiscreteLinearSystem, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<System>({.input = Names::Numbered(1),
                                       .output = Names::Numbered(1),
                                       .model = TransferFunction({0.2, 0.1}, {1, -0.5}),
                                       .period = 1ms}));
}

}  // namespace
}  // namespace pliant
