#include "pliant/systems/tick_timing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/systems/logger.h"
#include "pliant/systems/real_time_runner.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(TickTimer, ShowsWhatTheRunnerWrote) {
  const auto times = std::make_shared<TickTimes>();
  DiagramBuilder b;
  auto& timer = b.Add<TickTimer>("timer", {.times = times, .period = 1ms});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  *times = {.lateness_ns = 12'000, .compute_ns = 250'000, .missed = 3};
  sim.AdvanceThroughTick();
  EXPECT_EQ(sim.Get(timer.timing).lateness, 12e-6);
  EXPECT_EQ(sim.Get(timer.timing).compute, 250e-6);
  EXPECT_EQ(sim.Get(timer.timing).missed, 3);
  EXPECT_FALSE(sim.Get(timer.timing).overran);
  times->lateness_ns = 1'000'000;
  EXPECT_FALSE(sim.Get(timer.timing).overran);  // held until the next tick
  sim.AdvanceThroughTick();
  EXPECT_TRUE(sim.Get(timer.timing).overran);
}

TEST(TickTimer, IsAllZerosInASimulation) {
  DiagramBuilder b;
  auto& timer = b.Add<TickTimer>("timer", {.period = 1ms});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.1);
  EXPECT_EQ(sim.Get(timer.timing).lateness, 0);
  EXPECT_EQ(sim.Get(timer.timing).compute, 0);
  EXPECT_EQ(sim.Get(timer.timing).missed, 0);
  EXPECT_FALSE(sim.Get(timer.timing).overran);
}

TEST(TickTimer, IsLoggedByItsFields) {
  const auto times = std::make_shared<TickTimes>();
  DiagramBuilder b;
  auto& timer = b.Add<TickTimer>("timer", {.times = times, .period = 1ms});
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(timer.timing, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  for (int k = 0; k < 3; ++k) {
    *times = {.lateness_ns = 500'000 * k, .compute_ns = 0, .missed = k};
    sim.AdvanceThroughTick();
  }
  const Log& log = sim.Get(logger.log);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(log["timer.timing.lateness"][k], 500e-6 * k);
    EXPECT_EQ(log["timer.timing.missed"][k], k);
    EXPECT_EQ(log["timer.timing.overran"][k], k == 2 ? 1 : 0);
  }
}

TEST(TickTimer, RefusesAPeriodThatIsNone) {
  DiagramBuilder b;
  EXPECT_THAT(ErrorOf([&] { b.Add<TickTimer>("timer", {.period = 0ms}); }),
              testing::HasSubstr("timer: "));
}

}  // namespace
}  // namespace pliant
