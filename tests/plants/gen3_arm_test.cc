#include "pliant/plants/gen3_arm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/gen3_ideal_link.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Single precision of an angle of up to 360°, in radians: half a unit in the last place.
constexpr double kWire = 360 * 6e-8 * kPi / 180;

const MotorCurrent kCurrentLimit{10, 10, 10, 10, 6, 6, 6};

struct Arm {
  explicit Arm(int first_id = 0) : link{std::make_shared<Gen3IdealLink>(first_id)} {}
  Gen3Arm& operator*() { return *operator->(); }
  Gen3Arm* operator->() {
    if (!arm) arm.emplace(options());
    return &*arm;
  }
  Gen3Arm::Options options() {
    return {.link = link,
            .model = Gen3(),
            .current_limit = kCurrentLimit,
            .torque_per_ampere = JointTorque{11, 11, 11, 11, 7.6, 7.6, 7.6},
            .lock_step = std::chrono::milliseconds(1)};
  }
  void Tick(ControlMode mode, const JointPosition& q = JointPosition{0, 0, 0, 0, 0, 0, 0},
            const JointTorque& tau = JointTorque{0, 0, 0, 0, 0, 0, 0},
            const MotorCurrent& i = MotorCurrent{0, 0, 0, 0, 0, 0, 0}) {
    operator->()->Latest();
    arm->Command(mode, q, tau, i);
  }
  Gen3Feedback::Actuator& actuator(int j) {
    return link->now.actuator[static_cast<std::size_t>(j)];
  }
  const Gen3Command::Actuator& sent(int j) {
    return link->sent.actuator[static_cast<std::size_t>(j)];
  }

  std::shared_ptr<Gen3IdealLink> link;
  std::optional<Gen3Arm> arm;
};

TEST(Gen3Arm, ReadsWhereTheArmIsInTheModelsUnitsAndSigns) {
  Arm arm;
  arm.actuator(1) = {
      .position = 345, .velocity = 90, .torque = 3, .current = 2, .motor_temperature = 41};
  const Gen3Sample& start = arm->start();
  EXPECT_NEAR(start.position(1), -15 * kPi / 180, kWire);
  EXPECT_NEAR(start.velocity(1), kPi / 2, 1e-7);
  EXPECT_EQ(start.torque(1), -3) << "the sensor's sign is opposite to the joint's";
  EXPECT_EQ(start.current(1), 2);
  EXPECT_EQ(start.temperature(1), 41);
}

TEST(Gen3Arm, GoesOnWhereATurnOfAContinuousJointEnds) {
  Arm arm;
  double q = 0;
  for (int k = 0; k < 1000; ++k) {  // 2.8 turns forth
    arm.actuator(0).position = static_cast<float>(std::fmod(q * 180 / kPi, 360));
    arm.Tick(ControlMode::Position);
    if (k > 0) {
      EXPECT_NEAR(arm->Latest().position(0), q, kWire);
    }
    q += 0.0175;
  }
}

TEST(Gen3Arm, TakesLimitedJointsWithinHalfATurn) {
  Arm arm;
  arm.Tick(ControlMode::Position);
  for (const auto& [wire, q] :
       {std::pair(190.F, -170.), std::pair(179.F, 179.), std::pair(0.F, 0.)}) {
    arm.actuator(3).position = wire;
    arm.Tick(ControlMode::Position);
    EXPECT_NEAR(arm->Latest().position(3), q * kPi / 180, kWire);
  }
}

TEST(Gen3Arm, AsksForServoingAndThenForTheModeOfEachJoint) {
  Arm arm;
  arm.Tick(ControlMode::Current);
  EXPECT_THAT(arm.link->asked(),
              testing::ElementsAre("low level", "mode 4 of 0", "mode 4 of 1", "mode 4 of 2",
                                   "mode 4 of 3", "mode 4 of 4", "mode 4 of 5", "mode 4 of 6"));
  EXPECT_EQ(arm->start().status.mode, ControlMode::Current);
  EXPECT_EQ(arm->Latest().status.switching, 0U);
}

TEST(Gen3Arm, HasTheProtocolsNumberForEachMode) {
  for (const auto& [mode, number] :
       {std::pair(ControlMode::Position, 1), std::pair(ControlMode::Torque, 3),
        std::pair(ControlMode::Current, 4), std::pair(ControlMode::TorqueHighVelocity, 6)}) {
    Arm arm;
    arm.Tick(mode);
    for (const Gen3Mode of : arm.link->mode) EXPECT_EQ(static_cast<int>(of), number);
  }
}

TEST(Gen3Arm, CommandsTorquesAndCurrentsWithTheModelsSign) {
  Arm arm;
  arm.Tick(ControlMode::Torque, arm->start().position, {1, -2, 3, 0, 0, 0, 0});
  EXPECT_EQ(arm.sent(0).torque, 1);
  EXPECT_EQ(arm.sent(1).torque, -2);
  arm.Tick(ControlMode::Current, arm->start().position, {0, 0, 0, 0, 0, 0, 0},
           {0.5, -0.25, 0, 0, 0, 0, 0});
  EXPECT_EQ(arm.sent(0).current, 0.5);
  EXPECT_EQ(arm.sent(1).current, -0.25);
}

TEST(Gen3Arm, EchoesThePositionOfAJointThatIsNotInPositionMode) {
  Arm arm;
  arm.actuator(2).position = 10;
  arm.Tick(ControlMode::Current);
  arm.actuator(2).position = 12;
  arm.Tick(ControlMode::Current);
  EXPECT_EQ(arm.sent(2).position, 10) << "the command of the tick that saw 10";
  arm.Tick(ControlMode::Current);
  EXPECT_NEAR(arm.sent(2).position, 12, 1e-5);
  EXPECT_EQ(arm.sent(2).velocity, 0);
}

TEST(Gen3Arm, LeadsPositionsNoFasterThanTheJointsTurn) {
  Arm arm;
  arm.Tick(ControlMode::Position);
  const JointPosition far{0, 1, 0, 0, 0, 0, 0};
  const double step = Gen3().velocity_limit()(1) * 1e-3;
  for (int k = 1; k <= 3; ++k) {
    arm.Tick(ControlMode::Position, far);
    EXPECT_NEAR(arm.sent(1).position * kPi / 180, k * step, kWire);
    EXPECT_NEAR(arm.sent(1).velocity * kPi / 180, Gen3().velocity_limit()(1), 1e-6);
  }
}

TEST(Gen3Arm, CutsCommandsAtTheLimitsAndSaysSo) {
  Arm arm;
  arm.Tick(ControlMode::Torque, arm->start().position, {0, 1000, 0, -1000, 0, 0, 0});
  EXPECT_EQ(arm.sent(1).torque, Gen3().effort_limit()(1));
  EXPECT_EQ(arm.sent(3).torque, -Gen3().effort_limit()(3));
  EXPECT_EQ(arm->Latest().status.saturated, 0b1010U);
  arm.Tick(ControlMode::Current, arm->start().position, {0, 0, 0, 0, 0, 0, 0},
           {0, 0, 0, 0, 0, 0, 99});
  EXPECT_EQ(arm.sent(6).current, 6);
}

TEST(Gen3Arm, KeepsTheLastCommandInThePlaceOfNoNumber) {
  Arm arm;
  arm.Tick(ControlMode::Torque, arm->start().position, {0, 5, 0, 0, 0, 0, 0});
  arm.Tick(ControlMode::Torque, arm->start().position, {0, kNaN, 0, 0, 0, 0, 0});
  EXPECT_EQ(arm.sent(1).torque, 5);
  EXPECT_EQ(arm->Latest().status.saturated, 0b10U);
  arm.Tick(ControlMode::Position, {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
  EXPECT_EQ(arm.sent(1).position, 0);
}

TEST(Gen3Arm, TakesAModeThatIsNoneForPosition) {
  Arm arm;
  arm.Tick(static_cast<ControlMode>(77));
  EXPECT_EQ(arm.link->mode[0], Gen3Mode::Position);
}

TEST(Gen3Arm, CountsTheTicksSinceItsMeasurementsWereNew) {
  Arm arm;
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 0);
  arm.link->deliver = [](const Gen3Feedback&, Gen3IdealLink&) {};
  for (int k = 0; k <= 3; ++k) {
    arm.Tick(ControlMode::Position);
    EXPECT_EQ(arm->start().status.age, k) << "an answer of before was still on its way at k = 0";
  }
  arm.link->deliver = {};
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 0);
}

TEST(Gen3Arm, DoesNotTakeAnOlderAnswerForANewer) {
  Arm arm(65533);  // the order goes round
  std::deque<Gen3Feedback> kept;
  arm.link->deliver = [&](const Gen3Feedback& f, Gen3IdealLink& link) {
    kept.push_back(f);
    if (kept.size() < 2) return;
    link.answers.push_back(kept[1]);
    link.answers.push_back(kept[0]);
    kept.clear();
  };
  for (int k = 0; k < 8; ++k) {
    arm.actuator(0).velocity = static_cast<float>(k);
    arm.Tick(ControlMode::Position);
  }
  arm->Latest();
  EXPECT_NEAR(arm->start().velocity(0), 7 * kPi / 180, 1e-7);
  EXPECT_EQ(arm->start().report.out_of_order, 4);
  EXPECT_EQ(arm->start().report.late, 0) << "what is taken is of the last tick";
}

TEST(Gen3Arm, DoesNotTakeWhatIsNoNumber) {
  Arm arm;
  arm.actuator(0).position = 20;
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  arm.actuator(0).position = std::numeric_limits<float>::quiet_NaN();
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  EXPECT_NEAR(arm->start().position(0), 20 * kPi / 180, kWire);
  EXPECT_EQ(arm->start().report.not_finite, 1);
  EXPECT_EQ(arm->start().status.age, 1);
}

TEST(Gen3Arm, TakesNumbersThatNeverChangeForOld) {
  Arm arm;
  for (int k = 0; k < 60; ++k) arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 59) << "answers like the first";
  for (int j = 0; j < 6; ++j) arm.actuator(j).torque += 1;
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 61) << "one joint is enough";
  for (int j = 0; j < 7; ++j) arm.actuator(j).torque += 1;
  arm.Tick(ControlMode::Position);
  arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 0);
}

TEST(Gen3Arm, TakesATorqueThatAloneStandsStillForAFault) {
  Arm arm;
  for (int k = 0; k < 60; ++k) {
    for (int j = 0; j < 7; ++j) {
      arm.actuator(j).velocity += 1;
      if (j != 3) arm.actuator(j).torque += 1;
    }
    arm.Tick(ControlMode::Position);
  }
  EXPECT_EQ(arm->start().status.faulted, 0b1000U);
  EXPECT_EQ(arm->start().status.age, 0);
}

TEST(Gen3Arm, MeasuresTheAgeOfAnAnswerByTheCommandItAnswers) {
  Arm arm;
  std::deque<Gen3Feedback> on_the_way;
  arm.link->deliver = [&](const Gen3Feedback& f, Gen3IdealLink& link) {
    on_the_way.push_back(f);  // each is 30 ticks late
    if (on_the_way.size() <= 30) return;
    link.answers.push_back(on_the_way.front());
    on_the_way.pop_front();
  };
  for (int k = 0; k < 50; ++k) arm.Tick(ControlMode::Position);
  EXPECT_EQ(arm->start().status.age, 30);
}

TEST(Gen3Arm, IsNotConnectedOnceTheArmHasLeftLowLevelServoing) {
  Arm arm;
  arm.link->now.arm_state = 6;
  for (int k = 0; k < 3; ++k) arm.Tick(ControlMode::Current);
  EXPECT_TRUE(arm->start().status.connected);
  arm.link->now.arm_state = 7;
  for (int k = 0; k < 60; ++k) arm.Tick(ControlMode::Current);
  EXPECT_FALSE(arm->start().status.connected);
}

TEST(Gen3Arm, LeavesThePositionOfAJointWhereAServiceFailed) {
  Arm arm;
  arm.Tick(ControlMode::Torque);
  arm.actuator(2).position = 10;
  arm.Tick(ControlMode::Torque);
  arm.Tick(ControlMode::Torque);
  EXPECT_NEAR(arm.sent(2).position, 10, 1e-5);
  arm.link->refuses = "mode 1 of 0";
  arm.Tick(ControlMode::Position, arm->start().position);
  arm.actuator(2).position = 14;
  for (int k = 0; k < 3; ++k)
    arm.Tick(ControlMode::Position, arm->start().position, {0, 3, 0, 0, 0, 0, 0});
  EXPECT_NEAR(arm.sent(2).position, 10, 1e-5) << "its firmware sees the growing error";
  EXPECT_EQ(arm.sent(1).torque, 3) << "it may still be in torque mode";
}

TEST(Gen3Arm, SaysWhatTheArmReports) {
  Arm arm;
  arm.actuator(2).fault_a = 0x20;
  arm.link->now.fault_a = 0x10;
  arm.Tick(ControlMode::Position);
  const Gen3Sample& sample = arm->Latest();
  EXPECT_EQ(sample.status.faulted, 0b100U);
  EXPECT_TRUE(sample.status.arm_faulted);
  EXPECT_EQ(sample.report.fault[2], 0x20U);
  EXPECT_EQ(sample.report.base_fault, 0x10U);
}

TEST(Gen3Arm, HandsTheArmBack) {
  Arm arm;
  arm.Tick(ControlMode::Torque);
  arm->HandBack();
  EXPECT_EQ(arm.link->asked().back(), "single level");
  EXPECT_EQ(arm.link->servoing, Gen3Servoing::SingleLevel);
  for (const Gen3Mode of : arm.link->mode) EXPECT_EQ(of, Gen3Mode::Position);
  const std::size_t asked = arm.link->asked().size();
  arm.Tick(ControlMode::Torque);
  EXPECT_EQ(arm.link->asked().size(), asked) << "it commands no more";
}

TEST(Gen3Arm, CommandsAJointInItsModeUntilItHasLeftIt) {
  Arm arm;
  arm.Tick(ControlMode::Current);
  arm.link->refuses = "mode";
  for (int k = 0; k < 3; ++k)
    arm.Tick(ControlMode::Position, {0, 0, 0, 0, 0, 0, 0}, {1, 2, 3, 4, 5, 6, 7},
             {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7});
  EXPECT_FLOAT_EQ(arm.sent(6).torque, 7) << "refused position mode: it is still in the other";
  EXPECT_FLOAT_EQ(arm.sent(6).current, 0.7F);
}

TEST(Gen3Arm, HandsTheArmBackInRealTimeToo) {
  Arm arm;
  Gen3Arm::Options o = arm.options();
  o.lock_step = {};
  arm.arm.emplace(o);
  arm.Tick(ControlMode::Current);
  while (arm->Latest().status.switching != 0) arm.Tick(ControlMode::Current);
  arm.arm.reset();
  EXPECT_EQ(arm.link->servoing, Gen3Servoing::SingleLevel);
  for (const Gen3Mode of : arm.link->mode) EXPECT_EQ(of, Gen3Mode::Position);
}

TEST(Gen3Arm, CarriesItsWeightAndDampsUntilItIsHandedBack) {
  Arm arm;
  arm.actuator(1).position = 90;  // stretched out to the side
  arm.actuator(3).velocity = 20;
  arm.link->now.actuator[1].torque = 1;
  Gen3Arm::Options o = arm.options();
  o.lock_step = {};
  o.frozen_after = 0;
  arm.arm.emplace(o);
  arm.Tick(ControlMode::Torque, arm->start().position, {0, 50, 0, 0, 0, 0, 0});
  while (arm->Latest().status.switching != 0) arm.Tick(ControlMode::Torque);
  arm.Tick(ControlMode::Torque);  // its answer is new when the arm is handed back
  arm->HandBack();
  const RobotModel model = Gen3();
  RobotDynamics d(model);
  ComputeDynamics(model, arm->start().position, JointVelocity::Zero(model.joints()), d);
  ASSERT_LT(d.gravity(1), -20);
  EXPECT_NEAR(arm.sent(1).torque, d.gravity(1), 1e-5) << "single precision of 22 N·m";
  EXPECT_NEAR(arm.sent(1).current, d.gravity(1) / 11, 1e-6);
  const double damped = d.gravity(3) - 0.08 * model.effort_limit()(3) * 20 * kPi / 180;
  EXPECT_NEAR(arm.sent(3).torque, damped, 1e-5);
}

TEST(Gen3Arm, SaysWhatServiceFailedAndIsNotConnected) {
  Arm arm;
  arm.link->refuses = "mode 3 of 4";
  arm.Tick(ControlMode::Torque);
  EXPECT_FALSE(arm->Latest().status.connected);
  EXPECT_THAT(arm->failures(), testing::HasSubstr("the arm refused: mode 3 of 4"));
  arm->HandBack();
  EXPECT_EQ(arm.link->servoing, Gen3Servoing::SingleLevel) << "all the same";
}

TEST(Gen3Arm, RefusesAnArmThatIsNotWhatItSays) {
  Arm arm;
  arm.link->actuators = 6;
  EXPECT_EQ(ErrorOf([&] { Gen3Arm(arm.options()); }),
            "the arm must have 7 actuators, as the model has, got 6");
  arm.link->actuators = 7;
  arm.link->arm_state = 4;
  EXPECT_THAT(ErrorOf([&] { Gen3Arm(arm.options()); }), testing::HasSubstr("the arm is in fault"));
  arm.link->arm_state = 7;
  arm.actuator(0).torque = std::numeric_limits<float>::infinity();
  EXPECT_THAT(ErrorOf([&] { Gen3Arm(arm.options()); }),
              testing::HasSubstr("must be finite, got NaN or infinity at joint 1"));
  Gen3Arm::Options o = arm.options();
  o.frozen_after = -1;
  EXPECT_EQ(ErrorOf([&] { Gen3Arm{o}; }), "frozen_after must be >= 0, got -1");
  o = arm.options();
  o.link = nullptr;
  EXPECT_EQ(ErrorOf([&] { Gen3Arm{o}; }),
            "link is missing: expected a way to the arm, as of ConnectGen3");
}

}  // namespace
}  // namespace pliant
