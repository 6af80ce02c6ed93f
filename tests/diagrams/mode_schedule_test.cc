#include "pliant/diagrams/mode_schedule.h"

#include <gtest/gtest.h>

#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr ControlMode kPosition = ControlMode::Position, kTorque = ControlMode::Torque;

TEST(ModeSchedule, ChangesAtTheFirstTickThatIsNotBeforeTheChange) {
  DiagramBuilder b;
  auto& schedule = b.Add<ModeSchedule>(
      "schedule", {.first = kTorque, .changes = {{0.002, kPosition}, {0.0035, kTorque}}});
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  for (const ControlMode mode : {kTorque, kTorque, kPosition, kPosition, kTorque, kTorque}) {
    sim.AdvanceThroughTick();
    EXPECT_EQ(sim.Get(schedule.mode), mode) << sim.time();
  }
}

TEST(ModeSchedule, RefusesTimesThatDoNotGrow) {
  const auto error = [](double first, double second) {
    return ErrorOf([&] { ModeSchedule({.changes = {{first, kPosition}, {second, kTorque}}}); });
  };
  EXPECT_EQ(error(1, 1), "each mode begins after the one before it, got 1 s behind 1 s");
  EXPECT_EQ(error(2, 1), "each mode begins after the one before it, got 1 s behind 2 s");
  EXPECT_EQ(error(-1, 1), "a mode: at_s must be from 0 to 1000000 s, got -1");
}

}  // namespace
}  // namespace pliant
