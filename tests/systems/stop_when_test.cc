#include "pliant/systems/stop_when.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

/// When u = t ends, watched at 1 kHz.
std::optional<Simulator::Ending> EndingOf(
    const StopWhen::Options& options, double (*f)(double) = [](double t) { return t; }) {
  static std::optional<Diagram> diagram;
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", f);
  auto& stop = b.Add<StopWhen>("stop", options);
  b.Connect(source.y, stop.in);
  diagram.emplace(b.Build());
  Simulator sim{*diagram};
  sim.AdvanceTo(1);
  return sim.ended();
}

TEST(StopWhen, EndsTheRunAtTheFirstTickBeyondItsLimit) {
  const auto above = EndingOf({.number = "source.y", .above = 0.25});
  ASSERT_TRUE(above);
  EXPECT_EQ(above->time, 0.251) << "0.25 is not above 0.25";
  EXPECT_EQ(above->block, "stop");
  EXPECT_EQ(above->reason, "source.y is above 0.25");
  const auto below = EndingOf({.number = "source.y", .below = -0.25}, [](double t) { return -t; });
  ASSERT_TRUE(below);
  EXPECT_EQ(below->time, 0.251);
  EXPECT_EQ(below->reason, "source.y is below -0.25");
  const auto both = EndingOf({.number = "source.y", .above = 0.5, .below = 0});
  ASSERT_TRUE(both);
  EXPECT_EQ(both->time, 0.501);
  EXPECT_EQ(both->reason, "source.y is above 0.5 or below 0");
}

TEST(StopWhen, LetsARunGoOnWithinItsLimitsAndAtNan) {
  EXPECT_FALSE(EndingOf({.number = "source.y", .above = 1, .below = -1}));
  EXPECT_FALSE(EndingOf({.number = "source.y", .above = 1, .below = -1},
                        [](double) { return std::numeric_limits<double>::quiet_NaN(); }));
}

TEST(StopWhen, FindsAnElementOfAnyValue) {
  const Joints joints({"shoulder", "elbow"});
  DiagramBuilder b;
  auto& still = b.Add<Constant<JointPosition>>("still", {.space = joints, .value = {9.0, 9.0}});
  auto& fast = b.Add<Constant<JointVelocity>>("fast", {.space = joints, .value = {0.0, 2.0}});
  auto& stop = b.Add<StopWhen>("stop", {.number = "fast.y[elbow]", .above = 1.5, .period = 1ms});
  b.Connect(still.y, stop.in);
  b.Connect(fast.y, stop.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const long before = Allocations();
  sim.AdvanceTo(1);
  EXPECT_EQ(Allocations() - before, 0);
  ASSERT_TRUE(sim.ended());
  EXPECT_EQ(sim.time(), 0);
}

TEST(StopWhen, NamesWhatItCannotFindAndTheLimitThatIsMissing) {
  EXPECT_EQ(ErrorOf([] { EndingOf({.number = "sourc.y", .above = 1}); }),
            "stop: there is no number 'sourc.y'; did you mean 'source.y'?");
  EXPECT_EQ(ErrorOf([] { EndingOf({.number = "source.y"}); }),
            "stop: above or below must be given, the limit at which the run ends");
}

}  // namespace
}  // namespace pliant
