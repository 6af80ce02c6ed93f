#include "pliant/systems/delay.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/hold.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/sum.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(Delay, ShowsWhatWasNTicksAgo) {
  for (const int n : {1, 2, 7}) {
    BlockTester<Delay<double>> t({.steps = n, .initial = -1, .period = 1ms});
    for (int k = 0; k < 20; ++k) {
      t.Set(t->u, k);
      EXPECT_EQ(t.Get(t->y), k < n ? -1 : k - n) << "before tick " << k << " of n = " << n;
      t.Tick();
    }
  }
}

TEST(Delay, BreaksAnAlgebraicLoop) {
  DiagramBuilder b;  // y_k = 1 + y_{k−1}
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& sum = b.Add<Sum<double>>("sum", {});
  auto& hold = b.Add<Hold<double>>("hold", {.period = 1ms});
  auto& delay = b.Add<Delay<double>>("delay", {.period = 1ms});
  b.Connect(one.y, sum.plus);
  b.Connect(delay.y, sum.plus);
  b.Connect(sum.y, hold.u);
  b.Connect(hold.y, delay.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.1);
  EXPECT_EQ(sim.Get(hold.y), 100);
}

TEST(Delay, DelaysValuesOfAnyType) {
  BlockTester<Delay<bool>> t({.initial = true, .period = 1ms});
  t.Set(t->u, false);
  EXPECT_TRUE(t.Get(t->y));
  t.Tick();
  EXPECT_FALSE(t.Get(t->y));
}

TEST(Delay, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Delay<double>>({.steps = 0, .period = 1ms}); }),
            "block: steps must be >= 1, got 0");
}

TEST(Delay, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<Delay<JointTorque>>({.space = {"shoulder", "elbow"}, .steps = 5, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
