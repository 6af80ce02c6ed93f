#include "pliant/plants/arm_firmware.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"first", "second"};

ArmFirmware::Options Options(ControlMode mode) {
  return {.joints = kTwo,
          .torque_per_ampere = Eigen::Vector2d(11, 7.6),
          .position_stiffness = Eigen::Vector2d(1000, 500),
          .position_damping = Eigen::Vector2d(100, 50),
          .position_integral = Eigen::Vector2d(2000, 0),
          .torque_limit = Eigen::Vector2d(95, 45),
          .mode = mode};
}

struct Tester : BlockTester<ArmFirmware> {
  explicit Tester(const ArmFirmware::Options& o) : BlockTester<ArmFirmware>(o) {
    ArmFirmware& firmware = **this;
    Set(firmware.position, {0, 0});
    Set(firmware.motor_velocity, {0, 0});
    Set(firmware.torque, {0, 0});
  }
};

TEST(ArmFirmware, PassesCurrentsOnWithinTheTorqueLimits) {
  Tester t(Options(ControlMode::Current));
  t.Set(t->current_command, {2, -10});
  t.Tick();
  EXPECT_EQ(t.Get(t->active), ControlMode::Current);
  EXPECT_LT((t.Get(t->current) - Eigen::Vector2d(2, -45 / 7.6)).norm(), 1e-15);
}

TEST(ArmFirmware, ActsOnACommandFromItsTickOn) {
  Tester t(Options(ControlMode::Torque));
  t.Set(t->torque_command, {22, 0});
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(0, 0)) << "no tick yet";
  t.Tick();
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(2, 0));
  t.Set(t->torque_command, {33, 0});
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(2, 0)) << "until the next";
  t.Tick();
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(3, 0));
}

TEST(ArmFirmware, HoldsAPositionByItsGains) {
  Tester t(Options(ControlMode::Position));
  t.Set(t->position_command, {0, 0});
  t.Tick();
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(0, 0)) << "it stands where it shall";
  t.Set(t->position, {-0.02, -0.01});
  t.Set(t->motor_velocity, {0.1, -0.2});
  t.Tick();
  EXPECT_NEAR(11 * t.Get(t->current)(0), 1000 * 0.02 - 100 * 0.1 + 2000 * 0.02 * 1e-3, 1e-12);
  EXPECT_NEAR(7.6 * t.Get(t->current)(1), 500 * 0.01 + 50 * 0.2, 1e-12);
  t.Set(t->position_command, {0.0001, 0});
  t.Tick();
  const double velocity = 0.0001 / 1e-3, integral = 2000 * (0.02 + 0.0201) * 1e-3;
  EXPECT_NEAR(11 * t.Get(t->current)(0), 1000 * 0.0201 + 100 * (velocity - 0.1) + integral, 1e-11);
}

TEST(ArmFirmware, GoesStraightFromOneSlowCommandToTheNext) {
  ArmFirmware::Options o = Options(ControlMode::Position);
  o.command_period = 5ms;
  o.position_integral.setZero();
  Tester t(o);
  t.Set(t->position_command, {0, 0});
  t.Tick();
  t.Set(t->position_command, {0.005, 0});  // 1 rad/s
  for (int k = 1; k <= 7; ++k) {
    t.Tick();
    const double r = 0.001 * std::min(k, 5), velocity = k <= 5 ? 1 : 0;
    // To 95 N·m, the torque limit.
    EXPECT_NEAR(11 * t.Get(t->current)(0), std::min(95.0, 1000 * r + 100 * velocity), 1e-11) << k;
    EXPECT_EQ(t.Get(t->cut), k <= 5 ? 1u : 0u);
  }
}

TEST(ArmFirmware, ChangesItsModeWithoutAJumpWhileItMoves) {
  Tester t(Options(ControlMode::Torque));
  t.Set(t->torque_command, {10, 5});
  t.Set(t->motor_velocity, {0.5, -0.5});
  for (int k = 0; k < 20; ++k) {
    if (k == 10) t.Set(t->mode, ControlMode::Position);
    const JointPosition q{0.0005 * k, -0.0005 * k};
    t.Set(t->position, q);
    t.Set(t->position_command, q);  // echoed, as a driver does
    t.Tick();
    EXPECT_LT((t.Get(t->current) - Eigen::Vector2d(10 / 11.0, 5 / 7.6)).norm(), 1e-12) << k;
  }
}

TEST(ArmFirmware, TakesOverTheTorqueThatWasThere) {
  Tester t(Options(ControlMode::Torque));
  const auto& mode = t->mode;
  t.Set(t->torque_command, {20, -10});
  t.Set(t->position, {0.3, 0.4});
  t.Set(t->position_command, {0.3, 0.4});
  t.Tick();
  const MotorCurrent before = t.Get(t->current);
  t.Set(mode, ControlMode::Position);
  t.Tick();
  EXPECT_EQ(t.Get(t->active), ControlMode::Position);
  EXPECT_LT((t.Get(t->current) - before).norm(), 1e-14);
}

TEST(ArmFirmware, EndsItsIntegralAtTheTorqueLimit) {
  Tester t(Options(ControlMode::Position));
  t.Set(t->position_command, {1, 0});
  t.AdvanceTo(1);
  EXPECT_DOUBLE_EQ(11 * t.Get(t->current)(0), 95);
  t.Set(t->position_command, {-0.1, 0});  // −100 N·m by stiffness, and 95 N·m that are stored
  t.Tick();
  t.Tick();
  EXPECT_LT(11 * t.Get(t->current)(0), 0);
}

TEST(ArmFirmware, SeesItsTorqueErrorThroughKinovasLag) {
  ArmFirmware::Options o = Options(ControlMode::Torque);
  o.torque_feedforward = 0;
  o.torque_feedback = 2;
  // The continuous lag that the coefficients stand for, to their four digits.
  const auto lag = [](double f) {
    const std::complex<double> s(0, f);
    return (1.0 + s / 8.0) * (1.0 + s / 20.0) / ((1.0 + s / 1.0) * (1.0 + s / 3.0));
  };
  for (const double f : {0.1, 1.0, 3.0, 8.0, 20.0}) {
    Tester t(o);
    const int period = static_cast<int>(std::lround(1000 / f)), settle = 3 * period + 2000;
    std::complex<double> sum = 0;
    for (int k = 0; k < settle + period; ++k) {
      const double phase = 2 * std::numbers::pi * k / period;
      t.Set(t->torque_command, {std::sin(phase), 0});
      t.Tick();
      if (k >= settle) sum += t.Get(t->current)(0) * 11 * std::polar(1.0, -phase);
    }
    // Σ sin(φ + arg) |H| e^{−iφ} = H N/(2 i)
    const std::complex<double> H =
        sum * std::complex<double>(0, 2) / static_cast<double>(period) / 2.0;
    EXPECT_LT(std::abs(H - lag(1000.0 / period)), 0.01) << f << " Hz";
  }
}

TEST(ArmFirmware, LeavesATorqueThatIsThereAndBrakesAMotorThatTurns) {
  ArmFirmware::Options o = Options(ControlMode::Torque);
  o.torque_feedback = 3;
  o.torque_damping = 4;
  Tester t(o);
  t.Set(t->torque_command, {22, -7.6});
  t.Set(t->torque, {22, -7.6});
  t.Set(t->motor_velocity, {0.5, -0.5});
  for (int k = 0; k < 5; ++k) t.Tick();
  EXPECT_LT((t.Get(t->current) - Eigen::Vector2d((22 - 2) / 11., (-7.6 + 2) / 7.6)).norm(), 1e-14);
}

TEST(ArmFirmware, CarriesTheWeightOfAnArmThatSaysSo) {
  const RobotModel lwr = Lwr();
  const int n = lwr.size();
  const JointPosition q{0, 0.7, 0, -1.57, 0, 0.87, 0};
  for (const ControlMode mode : {ControlMode::Torque, ControlMode::Position}) {
    BlockTester<ArmFirmware> t({.joints = lwr.joints(),
                                .torque_per_ampere = PerJoint::Constant(n, 2),
                                .position_stiffness = PerJoint::Zero(n),
                                .position_damping = PerJoint::Zero(n),
                                .position_integral = PerJoint::Zero(n),
                                .torque_limit = lwr.effort_limit(),
                                .compensated = lwr,
                                .load = JointTorque::Zero(lwr.joints()),
                                .mode = mode});
    t.Set(t->position, q);
    t.Set(t->motor_velocity, JointVelocity::Zero(lwr.joints()));
    t.Set(t->torque, JointTorque::Zero(lwr.joints()));
    t.Tick();
    RobotDynamics d(lwr);
    ComputeDynamics(lwr, q, JointVelocity::Zero(lwr.joints()), d);
    if (mode == ControlMode::Torque)
      EXPECT_LT((2 * t.Get(t->current) - d.gravity).norm(), 1e-13);
    else  // the integral takes over the zero torque there was
      EXPECT_LT(t.Get(t->current).norm(), 1e-13);
  }
}

TEST(ArmFirmware, KeepsTheLawsOfBlocks) {
  for (const ControlMode mode : {ControlMode::Position, ControlMode::Torque, ControlMode::Current})
    ExpectBlockLaws(BlockTester<ArmFirmware>(Options(mode)), {.amplitude = 0.1});
}

TEST(ArmFirmware, RefusesGainsThatAreNone) {
  const auto error = [](auto change) {
    ArmFirmware::Options o = Options(ControlMode::Torque);
    change(o);
    return ErrorOf([&] { ArmFirmware firmware(o); });
  };
  using O = ArmFirmware::Options;
  EXPECT_EQ(error([](O& o) { o.torque_per_ampere(1) = 0; }),
            "torque_per_ampere[second] must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](O& o) { o.position_damping(0) = -1; }),
            "position_damping[first] must be >= 0 N·m·s/rad, got -1");
  EXPECT_EQ(error([](O& o) { o.position_stiffness.resize(0); }),
            "position_stiffness has an element for each of the 2 joints, got 0");
  EXPECT_EQ(error([](O& o) { o.load = {1}; }),
            "load has an element for each of the 2 joints, got 1");
  EXPECT_EQ(error([](O& o) { o.compensated = Gen3(); }),
            "compensated must be a model of the arm's joints");
  EXPECT_EQ(error([](O& o) { o.command_period = 1500us; }),
            "command_period must be a multiple of period = 1 ms, got 1500 us");
  EXPECT_EQ(error([](O& o) {
              o.period = 5ms;
              o.torque_feedback = 1;
            }),
            "period must be 1 ms where torque_feedback is > 0: H is made for it, got 5 ms");
  EXPECT_EQ(error([](O& o) { o.torque_feedback = -1; }), "torque_feedback must be >= 0, got -1");
}

}  // namespace
}  // namespace pliant
