#include "pliant/systems/pulse.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/integral.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(Pulse, IsHighForItsWidthOnceEveryPeriod) {
  BlockTester<Pulse<double>> t({.low = -1, .high = 2, .at = 100ms, .width = 30ms, .period = 50ms});
  for (int ms = 0; ms < 400; ++ms) {
    t.AdvanceTo((ms + 0.5) / 1e3);
    const bool is_high = ms >= 100 && (ms - 100) % 50 < 30;
    EXPECT_EQ(t.Get(t->y), is_high ? 2 : -1) << ms << " ms";
  }
}

TEST(Pulse, ComesOnceUnlessToldOtherwise) {
  BlockTester<Pulse<double>> t({.high = 2, .width = 30ms});
  t.Tick();
  EXPECT_EQ(t.Get(t->y), 2);
  t.Tick();
  EXPECT_EQ(t.time(), 0.03);
  EXPECT_EQ(t.Get(t->y), 0);
  t.AdvanceTo(1e9);
  EXPECT_EQ(t.Get(t->y), 0);
}

TEST(Pulse, IsIntegratedExactly) {
  DiagramBuilder b;
  auto& pulse = b.Add<Pulse<double>>("pulse", {.high = 2, .at = 7ms, .width = 1ms, .period = 10ms});
  auto& integral = b.Add<Integral<double>>("integral", {});
  b.Connect(pulse.y, integral.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  EXPECT_NEAR(sim.Get(integral.y), 100 * 2 * 1e-3, 1e-14);  // constant rates: round-off only
}

TEST(Pulse, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Pulse<double>>({.high = 1, .width = 0ms}); }),
            "block: width must be > 0, got 0 s");
  EXPECT_EQ(ErrorOf([] { BlockTester<Pulse<double>>({.high = 1, .width = 2ms, .period = 2ms}); }),
            "block: period must be > width, got 2 ms");
}

TEST(Pulse, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Pulse<double>>({.high = 1, .width = 2ms, .period = 3ms}));
}

}  // namespace
}  // namespace pliant
