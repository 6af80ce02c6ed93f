#include "pliant/plants/motor_drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/diagram.h"
#include "pliant/systems/pulse.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"first", "second"};

std::vector<ActuatorParameters> Motors(double theta) {
  const ActuatorParameters motor{.gear_ratio = 100,
                                 .torque_constant = 0.11,
                                 .efficiency = 0.9,
                                 .rotor_inertia = 0.4e-4,
                                 .current_limit = 8,
                                 .torque_limit = 60,
                                 .current_time_constant = theta,
                                 .stiffness = 25000,
                                 .friction = {.coulomb = 0, .viscous = 0, .stiction = 0}};
  return {motor, motor};
}

TEST(MotorDrive, LetsTheCurrentFollowAtFirstOrder) {
  BlockTester<MotorDrive> t({.joints = kTwo, .parameters = Motors(2e-3), .current = {1, 0}});
  t.Set(t->command, {3, -20});
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(1, 0)) << "no tick yet";
  t.Tick();
  for (const double s : {0.3e-3, 1e-3, 5.5e-3}) {
    t.AdvanceTo(s);
    const double rise = 1 - std::exp(-s / 2e-3);
    EXPECT_NEAR(t.Get(t->current)(0), 1 + 2 * rise, 1e-14);
    EXPECT_NEAR(t.Get(t->current)(1), -8 * rise, 1e-14) << "clamped before the lag";
    EXPECT_NEAR(t.Get(t->torque)(0), 0.9 * 0.11 * 100 * t.Get(t->current)(0), 1e-13);
  }
  EXPECT_GE(t.Get(t->torque)(1), -60) << "8 A would make 79.2 N·m";
  EXPECT_EQ(t.Get(t->saturated), 2u);
}

TEST(MotorDrive, TakesACommandOverAtItsTicks) {
  // From a held source, in the same tick: there is no delay, and nothing acts before it was said.
  DiagramBuilder b;
  auto& source = b.Add<Pulse<MotorCurrent>>(
      "source", {.space = kTwo, .high = {1, 1}, .at = 1ms, .width = 250us});
  auto& drive =
      b.Add<MotorDrive>("drive", {.joints = kTwo, .parameters = Motors(0.5e-3), .period = 1ms});
  b.Connect(source.y, drive.command);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  sim.AdvanceTo(1e-3);
  EXPECT_EQ(sim.Get(drive.current)(0), 0);
  for (const double t : {1.1e-3, 1.5e-3, 2e-3}) {  // the command is sampled, and held when it ends
    sim.AdvanceTo(t);
    EXPECT_NEAR(sim.Get(drive.current)(0), 1 - std::exp(-(t - 1e-3) / 0.5e-3), 1e-14);
  }
  const double there = sim.Get(drive.current)(0);
  sim.AdvanceTo(2.4e-3);
  EXPECT_NEAR(sim.Get(drive.current)(0), there * std::exp(-0.4e-3 / 0.5e-3), 1e-14);
}

TEST(MotorDrive, FollowsAtOnceWithoutATimeConstant) {
  BlockTester<MotorDrive> t({.joints = kTwo, .parameters = Motors(0)});
  t.Set(t->command, {7.5, -9});
  t.Tick();
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(7.5, -8));
  EXPECT_EQ(t.Get(t->torque), Eigen::Vector2d(60, -60));
  EXPECT_EQ(t.Get(t->saturated), 3u) << "the first by torque, the second by current";
  t.Set(t->command, {1, 2});
  t.Tick();
  EXPECT_EQ(t.Get(t->saturated), 0u);
}

TEST(MotorDrive, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<MotorDrive>({.joints = kTwo, .parameters = Motors(0)}));
  ExpectBlockLaws(BlockTester<MotorDrive>({.joints = kTwo, .parameters = Motors(1e-3)}));
}

TEST(MotorDrive, RefusesWhatIsNoMotor) {
  const auto error = [](auto change) {
    std::vector<ActuatorParameters> p = Motors(0);
    change(p[0]);
    return ErrorOf([&] { MotorDrive drive({.joints = kTwo, .parameters = p}); });
  };
  using P = ActuatorParameters;
  EXPECT_EQ(error([](P& p) { p.torque_constant = 0; }),
            "first: torque_constant must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](P& p) { p.gear_ratio = -100; }), "first: gear_ratio must be > 0, got -100");
  EXPECT_EQ(error([](P& p) { p.efficiency = 1.1; }),
            "first: efficiency must be above 0 to 1, got 1.1");
  EXPECT_EQ(error([](P& p) { p.current_limit = 0; }), "first: current_limit must be > 0 A, got 0");
  EXPECT_EQ(error([](P& p) { p.current_time_constant = -1; }),
            "first: current_time_constant must be >= 0 s, got -1");
  EXPECT_EQ(
      ErrorOf([] { MotorDrive drive({.joints = kTwo, .parameters = Motors(0), .current = {1}}); }),
      "current has an element for each of the 2 joints, got 1");
  EXPECT_EQ(ErrorOf([] { MotorDrive drive({.joints = kTwo, .parameters = {}}); }),
            "actuators has an element for each of the 2 joints, got 0");
}

}  // namespace
}  // namespace pliant
