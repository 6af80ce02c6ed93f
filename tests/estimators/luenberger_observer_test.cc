#include "pliant/estimators/luenberger_observer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/estimators/kalman_gain.h"
#include "pliant/systems/discrete_linear_system.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Observer = LuenbergerObserver<double, double>;

const double kPeriod = 0.01;
/// A cart whose position is measured.
const LinearModel kCart{Matrix2d{{1, kPeriod}, {0, 1}}, Vector2d(kPeriod* kPeriod / 2, kPeriod),
                        Eigen::RowVector2d(1, 0)};
/// A (I − L C) has two eigenvalues ½: its error halves at each tick, up to a factor that grows as
/// k.
const Vector2d kGain(0.75, 0.25 / kPeriod);

TEST(LuenbergerObserver, ItsErrorDiesOutWithItsModes) {
  const MatrixXd F = kCart.A * (Matrix2d::Identity() - kGain * kCart.C);
  DiagramBuilder b;
  auto& plant = b.Add<DiscreteLinearSystem<double, double>>(
      "plant", {.model = kCart, .initial = Vector2d(1, -2), .period = 10ms});
  auto& push = b.Add<Sine<double>>("push", {.amplitude = 3, .frequency_hz = 0.7});
  auto& observer = b.Add<Observer>("observer", {.model = kCart, .gain = kGain, .period = 10ms});
  b.Connect(push.y, plant.u);
  b.Connect(push.y, observer.u);
  b.Connect(plant.y, observer.y);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  Vector2d error(1, -2);  // of the prediction
  const MatrixXd left = Matrix2d::Identity() - kGain * kCart.C;
  Vector2d x;
  for (int k = 0; k < 30; ++k) {
    sim.AdvanceTo(kPeriod * k);
    x = sim.Get(plant.x);
    sim.AdvanceThroughTick();
    EXPECT_LT((x - sim.Get(observer.x) - left * error).norm(), 1e-12) << "tick " << k;
    error = F * error;
  }
  // Both modes are ½: what is left at the last tick, 29, is of the order of 29 · 2⁻²⁹.
  EXPECT_LT((x - sim.Get(observer.x)).norm(), 1e-4);
}

TEST(LuenbergerObserver, WithoutAGainIsTheModel) {
  BlockTester<Observer> t(
      {.model = kCart, .gain = Vector2d::Zero(), .initial = Vector2d(1, 2), .period = 10ms});
  t.Set(t->u, 5);
  t.Set(t->y, 100);
  t.Tick();
  EXPECT_EQ(t.Get(t->innovation)(0), 99);
  t.Tick();
  Vector2d expected = kCart.A * Vector2d(1, 2);
  expected += 5 * kCart.B;
  EXPECT_TRUE(t.Get(t->x).isApprox(expected, 1e-15));
}

TEST(LuenbergerObserver, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<Observer>({.model = kCart, .gain = kGain, .period = 1ms}));
}

TEST(LuenbergerObserver, RefusesAGainThatDoesNotFit) {
  const auto error = [](const Observer::Options& o) {
    return ErrorOf([&] { BlockTester<Observer>{o}; });
  };
  EXPECT_EQ(error({.model = kCart, .gain = MatrixXd::Zero(1, 2), .period = 1ms}),
            "block: gain must be 2×1, as the states and y are, got 1×2");
  LinearModel direct = kCart;
  direct.D = MatrixXd::Ones(1, 1);
  EXPECT_EQ(error({.model = direct, .gain = kGain, .period = 1ms}),
            "block: D must be zero: an observer measures the states");
}

}  // namespace
}  // namespace pliant
