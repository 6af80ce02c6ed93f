#include "pliant/systems/low_pass.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

TEST(LowPass, FollowsTheExactStepResponse) {
  DiagramBuilder b;
  auto& step = b.Add<Constant<JointVelocity>>("step", {.space = kJoints, .value = {1.0, -2.0}});
  auto& filter =
      b.Add<LowPass<JointVelocity>>("filter", {.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  b.Connect(step.y, filter.u);

  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  for (const double t : {0.01, 0.1, 1.0}) {
    sim.AdvanceTo(t);
    const double reached = 1 - std::exp(-2 * std::numbers::pi * 5 * t);
    EXPECT_NEAR(sim.Get(filter.y)(0), 1.0 * reached, 1e-12) << "t = " << t;  // round-off only
    EXPECT_NEAR(sim.Get(filter.y)(1), -2.0 * reached, 1e-12) << "t = " << t;
  }
}

TEST(LowPass, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<LowPass<double>>({.cutoff_hz = -3, .period = 1ms}); }),
            "block: cutoff_hz must be > 0, got -3");
}

TEST(LowPass, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<LowPass<JointVelocity>>({.space = kJoints, .cutoff_hz = 5, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
