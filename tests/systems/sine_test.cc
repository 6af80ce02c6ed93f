#include "pliant/systems/sine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(Sine, HasAmplitudeOffsetFrequencyAndPhase) {
  BlockTester<Sine<JointTorque>> t(
      {.space = kJoints, .amplitude = {2, -3}, .offset = {0, 10}, .frequency_hz = 5, .phase = 0.3});
  for (const double time : {0.0, 0.013, 0.1, 1.7}) {
    t.AdvanceTo(time);
    const double sine = std::sin(2 * std::numbers::pi * 5 * time + 0.3);
    EXPECT_NEAR(t.Get(t->y)(0), 2 * sine, 1e-14);  // round-off only
    EXPECT_NEAR(t.Get(t->y)(1), 10 - 3 * sine, 1e-14);
  }
}

TEST(Sine, FollowsAnAmplitudeSetWhileRunning) {
  BlockTester<Sine<double>> t({.amplitude = 1, .frequency_hz = 1});
  t.AdvanceTo(0.25);
  t.Set(t->amplitude, 7);
  EXPECT_DOUBLE_EQ(t.Get(t->y), 7);
}

TEST(Sine, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<Sine<double>>({.amplitude = 1, .frequency_hz = -2}); }),
            "block: frequency_hz must be > 0, got -2");
}

TEST(Sine, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<Sine<double>>({.amplitude = 1, .frequency_hz = 1}));
}

}  // namespace
}  // namespace pliant
