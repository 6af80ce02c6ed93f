#include "pliant/diagrams/gen3_body.h"

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include <Common.pb.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

namespace config = Kinova::Api::ActuatorConfig;
namespace base = Kinova::Api::Base;
namespace common = Kinova::Api::Common;

constexpr double kDegree = std::numbers::pi / 180;
using Change = std::function<void(Gen3Command&)>;

/// An arm and who commands it: what was measured goes back, changed as the test says.
struct Driven {
  explicit Driven(const Gen3Body::Options& o = {}) : arm{o} {}

  void Step(
      int ticks, const Change& change = [](Gen3Command&) {}) {
    for (int k = 0; k < ticks; ++k) {
      Gen3Command command;
      for (std::size_t j = 0; j < 7; ++j) {
        const auto& a = arm.feedback().actuator[j];
        command.actuator[j] = {.position = a.position, .torque = -a.torque, .current = a.current};
      }
      change(command);
      Gen3Body::Ids ids;
      ids.fill(++id);
      arm.Command(command, ids, id, 0);
      arm.Step();
    }
  }
  std::uint32_t Fault(std::size_t joint) const { return arm.feedback().actuator[joint].fault_a; }

  Gen3Body arm;
  std::uint32_t id = 0;
};

FaultOrder Order(const std::string& text) { return FaultOrder::Of(text, Gen3Body::Kinds()); }

/// All joints of an arm that reaches out, its weight on joints 2, 4 and 6.
Gen3Body::Options Reaching(bool ideal = false) {
  Gen3Body::Options o;
  o.station.position = JointPosition{0, 1.2, 0, 0.3, 0, 0.2, 0};
  o.station.ideal = ideal;
  return o;
}

double Farthest(const JointPosition& a, const JointPosition& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

TEST(Gen3Body, HoldsItsPositionBeforeLowLevelServoing) {
  Gen3Body arm(Reaching());
  const JointPosition start = arm.position();
  for (int k = 0; k < 1000; ++k) arm.Step();
  // The gears' deflection under a weight of 22 N·m is 1 mrad; holding takes it over.
  EXPECT_LT(Farthest(arm.position(), start), 1e-3);
  EXPECT_EQ(arm.feedback().arm_state, common::ARMSTATE_SERVOING_READY);
}

TEST(Gen3Body, SpeaksInTheUnitsAndSignsOfTheWire) {
  Gen3Body arm(Reaching());
  const RobotModel model = Gen3();
  RobotDynamics at(model);
  ComputeDynamics(model, arm.position(), JointVelocity::Zero(model.joints()), at);
  for (int j = 0; j < 7; ++j) {
    const auto& a = arm.feedback().actuator[static_cast<std::size_t>(j)];
    EXPECT_GE(a.position, 0);
    EXPECT_LT(a.position, 360);
    // Noise of 1e-5 rad; single precision near 360° is 3e-5°.
    EXPECT_NEAR(std::remainder(a.position - arm.position()(j) / kDegree, 360), 0, 6e-3);
    // At rest the sensor feels the weight: bias 0.5, drift 0.05, noise 0.15 N·m.
    EXPECT_NEAR(-a.torque, at.gravity(j), 0.5 + 5 * (0.15 + 0.05)) << j;
  }
  EXPECT_LT(at.gravity(1), -15) << "the arm reaches out";
  EXPECT_GT(arm.feedback().actuator[1].torque, 15) << "opposite to the URDF's axis";
}

TEST(Gen3Body, TurnsAnglesBelowZeroIntoThoseBelow360) {
  Gen3Body::Options o;
  o.station.ideal = true;
  o.station.position = JointPosition{-0.1, 0.1, 6.4, -0.1, 12.6, 0, 0};
  const Gen3Body arm(o);
  const auto& a = arm.feedback().actuator;
  // The positions hold their weight to some 1e-6 rad.
  EXPECT_NEAR(a[0].position, 360 - 0.1 / kDegree, 1e-2);
  EXPECT_NEAR(a[1].position, 0.1 / kDegree, 1e-2);
  EXPECT_NEAR(a[2].position, 6.4 / kDegree - 360, 1e-2);
  EXPECT_NEAR(a[3].position, 360 - 0.1 / kDegree, 1e-2);
  EXPECT_NEAR(a[4].position, 12.6 / kDegree - 720, 1e-2);
}

TEST(Gen3Body, TurnsThroughZeroWithoutAJump) {
  Gen3Body::Options o;
  o.station.ideal = true;
  o.station.position = JointPosition{-0.02, 0.1, 0, -0.1, 0, 0, 0};
  Driven driven(o);
  driven.arm.EnterLowLevel();
  float command = driven.arm.feedback().actuator[0].position;
  for (int k = 0; k < 200; ++k)
    driven.Step(1, [&](Gen3Command& c) {
      command += 0.02F;  // 20 °/s
      if (command >= 360) command -= 360;
      c.actuator[0].position = command;
    });
  EXPECT_FALSE(driven.arm.in_fault());
  EXPECT_NEAR(driven.arm.position()(0), -0.02 + 4 * kDegree, 0.2 * kDegree);
}

TEST(Gen3Body, StaysWithTheCurrentThatCarriesItsWeight) {
  Driven driven(Reaching());
  driven.arm.EnterLowLevel();
  const JointPosition start = driven.arm.position();
  const float current = driven.arm.feedback().actuator[1].current;
  driven.Step(1);
  driven.arm.SetMode(1, Gen3Mode::Current);
  driven.Step(1000, [&](Gen3Command& c) { c.actuator[1].current = current; });
  EXPECT_FALSE(driven.arm.in_fault());
  // Friction of 3 N·m keeps what the current's noise leaves.
  EXPECT_LT(Farthest(driven.arm.position(), start), 2e-3);
}

TEST(Gen3Body, FallsWithoutCurrentTheWayItsWeightPulls) {
  const RobotModel model = Gen3();
  Driven driven(Reaching());
  RobotDynamics at(model);
  ComputeDynamics(model, driven.arm.position(), JointVelocity::Zero(model.joints()), at);
  driven.arm.EnterLowLevel();
  driven.Step(1);
  const double start = driven.arm.position()(1);
  driven.arm.SetMode(1, Gen3Mode::Current);
  driven.Step(200, [](Gen3Command& c) { c.actuator[1].current = 0; });
  const double moved = driven.arm.position()(1) - start;
  // g is what holds it: it falls against g. Friction takes 3 of 20 N·m, 2 kg·m² turn:
  // ½ (17/2) 0.2² = 0.17 rad, less what viscous friction takes.
  EXPECT_LT(at.gravity(1), 0);
  EXPECT_GT(moved, 0.05);
  EXPECT_GT(driven.arm.feedback().actuator[1].velocity, 0);
}

TEST(Gen3Body, TakesTorquesInTheJointsDirectionUnlikeWhatItMeasures) {
  Gen3Body::Options o;
  o.station.position = JointPosition{0, 0, 0, 0, 0, 0, 0};  // upright: nothing weighs
  Driven driven(o);
  driven.arm.EnterLowLevel();
  driven.Step(1);
  driven.arm.SetMode(0, Gen3Mode::Torque);
  const double start = driven.arm.position()(0);
  driven.Step(200, [](Gen3Command& c) { c.actuator[0].torque = 10; });
  EXPECT_GT(driven.arm.position()(0), start + 0.01);
}

TEST(Gen3Body, TripsFollowingErrorBeyondFiveDegrees) {
  for (const Gen3Mode mode : {Gen3Mode::Position, Gen3Mode::Torque, Gen3Mode::Current}) {
    Driven driven;
    driven.arm.EnterLowLevel();
    driven.Step(1);
    driven.arm.SetMode(2, mode);
    driven.Step(1);
    EXPECT_FALSE(driven.arm.in_fault());
    driven.Step(1, [](Gen3Command& c) { c.actuator[2].position += 5.5F; });
    EXPECT_EQ(driven.Fault(2), config::FOLLOWING_ERROR);
    EXPECT_EQ(driven.arm.feedback().fault_a, base::JOINT_FAULT);
    EXPECT_EQ(driven.arm.feedback().arm_state, common::ARMSTATE_IN_FAULT);
    EXPECT_EQ(driven.arm.servoing(), Gen3Servoing::SingleLevel);
    EXPECT_EQ(driven.arm.mode(2), Gen3Mode::Position);
  }
}

TEST(Gen3Body, WarnsBeyondThreeDegrees) {
  Driven driven;
  driven.arm.EnterLowLevel();
  driven.Step(1);
  driven.arm.SetMode(0, Gen3Mode::Current);
  driven.Step(1, [](Gen3Command& c) { c.actuator[0].position += 4; });
  EXPECT_FALSE(driven.arm.in_fault());
  EXPECT_EQ(driven.arm.feedback().actuator[0].warning_a, config::FOLLOWING_ERROR);
}

TEST(Gen3Body, TripsMaximumVelocityAndThenHolds) {
  Gen3Body::Options o;
  o.station.position = JointPosition{0, 0, 0, 0, 0, 0, 0};
  Driven driven(o);
  driven.arm.EnterLowLevel();
  driven.Step(1);
  driven.arm.SetMode(6, Gen3Mode::Current);
  int ticks = 0;
  while (!driven.arm.in_fault() && ++ticks < 2000)
    driven.Step(1, [](Gen3Command& c) { c.actuator[6].current = 3; });
  EXPECT_EQ(driven.Fault(6), config::MAXIMUM_VELOCITY);
  // The largest current makes 45 N·m, which stop a rotor of 0.22 kg·m² at 200 °/s within 30 mrad,
  // begun some milliseconds late: well within what would be a following error. It then comes back.
  const double tripped = driven.arm.position()(6);
  for (int k = 0; k < 1000; ++k) {
    driven.Step(1, [](Gen3Command& c) { c.actuator[6].current = 3; });
    EXPECT_NEAR(driven.arm.position()(6), tripped, 5 * kDegree);
  }
  EXPECT_NEAR(driven.arm.position()(6), tripped, 0.01);
}

TEST(Gen3Body, TripsTheJointsLimitAndLetsItBackIn) {
  Gen3Body::Options o;
  o.station.position = JointPosition{0, 0, 0, 0, 0, 2.05, 0};
  Driven driven(o);
  driven.arm.EnterLowLevel();
  driven.Step(1);
  driven.arm.SetMode(5, Gen3Mode::Current);
  for (int k = 0; k < 1000 && !driven.arm.in_fault(); ++k)
    driven.Step(1, [](Gen3Command& c) { c.actuator[5].current = 0.6F; });
  EXPECT_EQ(driven.Fault(5), config::JOINT_LIMIT_HIGH);
  for (int k = 0; k < 300; ++k) driven.arm.Step();
  driven.arm.ClearFaults();
  driven.arm.EnterLowLevel();
  driven.Step(10);
  EXPECT_FALSE(driven.arm.in_fault());
}

TEST(Gen3Body, TripsCyclicDataJitterOnceCommandsStayAway) {
  Driven driven;
  driven.arm.EnterLowLevel();
  for (int k = 0; k < 100; ++k) driven.arm.Step();
  EXPECT_FALSE(driven.arm.in_fault()) << "it waits for the first";
  driven.Step(1);
  for (int k = 0; k < 19; ++k) driven.arm.Step();
  EXPECT_FALSE(driven.arm.in_fault());
  driven.arm.Step();
  EXPECT_EQ(driven.arm.feedback().fault_a, base::CYCLIC_DATA_JITTER);
  EXPECT_EQ(driven.arm.servoing(), Gen3Servoing::SingleLevel);
}

TEST(Gen3Body, DoesNotActOnCommandsThatAreOldOrRepeatedOrNotFinite) {
  Driven driven;
  driven.arm.EnterLowLevel();
  driven.id = 65530;
  driven.Step(3);
  const auto acts = [&](std::uint32_t id, float position) {
    Gen3Command command;
    for (std::size_t j = 0; j < 7; ++j)
      command.actuator[j].position = driven.arm.feedback().actuator[j].position;
    command.actuator[0].torque = position;
    Gen3Body::Ids ids;
    ids.fill(id);
    driven.arm.Command(command, ids, id, 0);
    return driven.arm.feedback().actuator[0].command_id == id;
  };
  EXPECT_TRUE(acts(65535, 0));
  EXPECT_FALSE(acts(65534, 0));
  EXPECT_TRUE(acts(0, 0)) << "ids wrap";
  EXPECT_FALSE(acts(65535, 0));
  EXPECT_TRUE(acts(0x70003, 0)) << "the high bits are the device's";
  EXPECT_FALSE(acts(4, std::numeric_limits<float>::quiet_NaN()));
}

TEST(Gen3Body, HoldsAfterAnEmergencyStopUntilFaultsAreCleared) {
  Driven driven;
  driven.arm.EnterLowLevel();
  driven.Step(10);
  driven.arm.EmergencyStop();
  EXPECT_EQ(driven.arm.feedback().fault_a, base::EMERGENCY_STOP_ACTIVATED);
  EXPECT_EQ(driven.arm.servoing(), Gen3Servoing::SingleLevel);
  driven.arm.EnterLowLevel();
  EXPECT_EQ(driven.arm.servoing(), Gen3Servoing::SingleLevel);
  driven.arm.ClearFaults();
  driven.arm.EnterLowLevel();
  EXPECT_EQ(driven.arm.servoing(), Gen3Servoing::LowLevel);
}

TEST(Gen3Body, ShowsTheFaultsThatAreOrdered) {
  const auto after = [](const std::string& order) {
    Gen3Body::Options o;
    o.faults = {Order(order)};
    auto driven = std::make_unique<Driven>(o);
    driven->arm.EnterLowLevel();
    driven->Step(9);
    EXPECT_FALSE(driven->arm.in_fault()) << order;
    driven->Step(2);
    return driven;
  };
  EXPECT_EQ(after("actuator_fault@0.01+1:3")->Fault(2), config::MOTOR_DRIVER_FAULT);
  EXPECT_EQ(after("following_error@0.01+1:1")->Fault(0), config::FOLLOWING_ERROR);
  EXPECT_EQ(after("overspeed@0.01+1:7")->Fault(6), config::MAXIMUM_VELOCITY);
  EXPECT_EQ(after("emergency_stop@0.01+1")->arm.feedback().fault_a, base::EMERGENCY_STOP_ACTIVATED);
  EXPECT_EQ(after("torque_sensor_dead@0.01+1:4")->arm.feedback().actuator[3].torque, 0);

  const auto calm = after("frozen@5+1");  // not yet
  const auto torn = after("torque_jump@0.01+1:4");
  EXPECT_NEAR(torn->arm.feedback().actuator[3].torque, calm->arm.feedback().actuator[3].torque - 30,
              1e-4);
  const auto turned = after("encoder_jump@0.01+1:5");
  EXPECT_NEAR(std::remainder(turned->arm.feedback().actuator[4].position -
                                 calm->arm.feedback().actuator[4].position,
                             360),
              2, 0.1);
  EXPECT_TRUE(std::isnan(after("nan@0.01+1")->arm.feedback().actuator[2].position));

  const auto frozen = after("frozen@0.01+1");
  const Gen3Feedback before = frozen->arm.feedback();
  frozen->Step(5);
  EXPECT_EQ(frozen->arm.feedback().actuator[1].torque, before.actuator[1].torque);
  EXPECT_EQ(frozen->arm.feedback().actuator[1].command_id, before.actuator[1].command_id + 5);
}

TEST(Gen3Body, ShowsAFaultAgainThatIsClearedWhileItLasts) {
  Gen3Body::Options o;
  o.faults = {Order("actuator_fault@0.01+0.1:3")};
  Driven driven(o);
  driven.arm.EnterLowLevel();
  driven.Step(20);
  driven.arm.ClearFaults();
  driven.arm.Step();
  EXPECT_TRUE(driven.arm.in_fault());
  driven.Step(100);
  driven.arm.ClearFaults();
  driven.arm.Step();
  EXPECT_FALSE(driven.arm.in_fault());
}

TEST(Gen3Body, WarmsItsMotorsWithTheirCurrent) {
  Driven driven(Reaching());
  const float before = driven.arm.feedback().actuator[1].motor_temperature;
  const double current = driven.arm.feedback().actuator[1].current;
  for (int k = 0; k < 2000; ++k) driven.arm.Step();
  // T' = c i²/θ while it is near the ambient temperature; the current's ripple adds to i².
  const double warmed = driven.arm.feedback().actuator[1].motor_temperature - before;
  EXPECT_NEAR(warmed, 2 * 0.5 * current * current / 600, 0.3 * warmed);
}

TEST(Gen3Body, RefusesWhatItCannotBe) {
  const auto refused = [](const std::function<void(Gen3Body::Options&)>& change) {
    Gen3Body::Options o;
    change(o);
    return ErrorOf([&] { Gen3Body arm(o); });
  };
  EXPECT_EQ(refused([](auto& o) { o.patience_ticks = 0; }), "patience_ticks must be > 0, got 0");
  EXPECT_TRUE(refused([](auto& o) {
                o.model = RobotModel::FromUrdfText(kTree);
              }).starts_with("the model of a Gen3 must have 7 joints, got "));
  EXPECT_EQ(refused([](auto& o) { o.station.position = JointPosition{0, 3, 0, 0, 0, 0, 0}; }),
            "position of joint_2 must be within -2.24 … 2.24 rad, got 3");
  EXPECT_EQ(refused([](auto& o) { o.faults = {Order("overspeed@0+1:8")}; }),
            "the joint of the fault overspeed must be one of 1 … 7, got 8");
}

}  // namespace
}  // namespace pliant
