#include "pliant/systems/chirp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kEps = 1e-4;  // [s] of a central difference

/// The frequency at t from the phase of y = sin φ and y = sin(φ + π/2) is not to be had from one
/// chirp, so it is read from the distance of two zero crossings around t.
double FrequencyAt(const Chirp<double>::Options& o, double t) {
  BlockTester<Chirp<double>> chirp(o);
  double last = 0, crossing = -1;
  for (double now = t - 2 / o.end_hz;; now += kEps) {
    chirp.AdvanceTo(now);
    const double y = chirp.Get(chirp->y);
    if (last < 0 && y >= 0) {
      const double at = now - kEps * y / (y - last);
      if (crossing >= 0) return 1 / (at - crossing);
      crossing = at;
    }
    last = y;
  }
}

TEST(Chirp, StartsAsASineOfItsFirstFrequency) {
  for (const Sweep sweep : {Sweep::kLinear, Sweep::kExponential}) {
    BlockTester<Chirp<double>> t({.amplitude = 2,
                                  .offset = 1,
                                  .start_hz = 1,
                                  .end_hz = 10,
                                  .duration = 100s,
                                  .sweep = sweep});
    t.AdvanceTo(0.01);
    // the phase has gone f₀ t + ½ ḟ t², ḟ ≤ 1/s: the second term is 5e-5 cycles
    EXPECT_NEAR(t.Get(t->y), 1 + 2 * std::sin(2 * std::numbers::pi * 0.01), 2 * 2 * 3.15 * 5e-5);
  }
}

TEST(Chirp, SweepsLinearly) {
  const Chirp<double>::Options o{.amplitude = 1, .start_hz = 20, .end_hz = 40, .duration = 10s};
  // between two crossings, 1/30 s, f changes by 0.07 Hz
  EXPECT_NEAR(FrequencyAt(o, 5), 30, 0.3);
}

TEST(Chirp, SweepsExponentially) {
  const Chirp<double>::Options o{
      .amplitude = 1, .start_hz = 20, .end_hz = 80, .duration = 10s, .sweep = Sweep::kExponential};
  EXPECT_NEAR(FrequencyAt(o, 5), 40, 0.4);  // √(20 · 80); f changes by 0.14 Hz in a cycle
}

TEST(Chirp, HasTheIntegralOfItsFrequencyAsItsPhase) {
  BlockTester<Chirp<double>> linear({.amplitude = 1, .start_hz = 1, .end_hz = 3, .duration = 2s});
  linear.AdvanceTo(1.5);
  EXPECT_NEAR(linear.Get(linear->y), std::sin(2 * std::numbers::pi * (1.5 + 0.5 * 1.5 * 1.5)),
              1e-13);  // round-off only
  BlockTester<Chirp<double>> exponential(
      {.amplitude = 1, .start_hz = 1, .end_hz = 4, .duration = 2s, .sweep = Sweep::kExponential});
  exponential.AdvanceTo(1);  // ∫₀¹ 2^t dt = 1/ln 2
  EXPECT_NEAR(exponential.Get(exponential->y), std::sin(2 * std::numbers::pi / std::numbers::ln2),
              1e-13);
}

TEST(Chirp, StaysAtItsLastFrequency) {
  const Chirp<double>::Options o{.amplitude = 1, .start_hz = 10, .end_hz = 20, .duration = 1s};
  EXPECT_NEAR(FrequencyAt(o, 3), 20, 1e-3);  // linear interpolation between samples of 0.1 ms
}

TEST(Chirp, RefusesBadOptions) {
  EXPECT_EQ(
      ErrorOf([] {
        BlockTester<Chirp<double>>({.amplitude = 1, .start_hz = 0, .end_hz = 1, .duration = 1s});
      }),
      "block: start_hz must be > 0, got 0");
  EXPECT_EQ(
      ErrorOf([] {
        BlockTester<Chirp<double>>({.amplitude = 1, .start_hz = 1, .end_hz = -1, .duration = 1s});
      }),
      "block: end_hz must be > 0, got -1");
  EXPECT_EQ(
      ErrorOf([] {
        BlockTester<Chirp<double>>({.amplitude = 1, .start_hz = 1, .end_hz = 1, .duration = 0s});
      }),
      "block: duration must be > 0, got 0 s");
}

TEST(Chirp, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<Chirp<double>>({.amplitude = 1, .start_hz = 1, .end_hz = 5, .duration = 200ms}));
}

}  // namespace
}  // namespace pliant
