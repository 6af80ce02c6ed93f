#include "pliant/controllers/safety_supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using enum SafetyState;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const MotorCurrent kCurrentLimit{10, 10, 10, 10, 6, 6, 6};
const PerJoint kTorquePerAmpere = JointTorque{11, 11, 11, 11, 7.6, 7.6, 7.6};
const JointPosition kHome{0, 0.2618, 3.14159, -2.2689, 0, 0.9599, 1.5708};

SafetySupervisor::Options Options(SafetySupervisor::Settings settings = {}) {
  return {.model = Gen3(),
          .position = kHome,
          .torque_per_ampere = kTorquePerAmpere,
          .current_limit = kCurrentLimit,
          .settings = settings};
}

/// An arm that stands still in whatever mode it is told, and a controller that wants little.
struct Watched {
  explicit Watched(ControlMode mode, SafetySupervisor::Settings settings = {})
      : t{Options(settings)} {
    const Joints joints = Gen3().joints();
    t.Set(t->mode, mode);
    t.Set(t->position_command, kHome);
    t.Set(t->torque_command, tau);
    t.Set(t->current_command, i);
    t.Set(t->measured_position, kHome);
    t.Set(t->measured_velocity, JointVelocity::Zero(joints));
    t.Set(t->measured_torque, JointTorque::Zero(joints));
    t.Set(t->status, {.mode = ControlMode::Position});
  }
  void Tick(int n = 1) {
    for (int k = 0; k < n; ++k) {
      t.Tick();
      status.mode = t.Get(t->arm_mode);
      t.Set(t->status, status);
    }
  }
  /// Until the controller has the arm alone: the mode is there at the second tick, then T.
  void Run() {
    Tick(3 + 500);
    ASSERT_EQ(report().state, Running);
  }
  const SafetyReport& report() { return t.Get(t->report); }
  JointTorque Damped(const JointVelocity& v = JointVelocity::Zero(Gen3().joints())) const {
    RobotDynamics d(Gen3());
    ComputeDynamics(Gen3(), kHome, JointVelocity::Zero(Gen3().joints()), d);
    const PerJoint D = (0.08 * Gen3().effort_limit()).cwiseMin(100 * d.M.diagonal());
    return JointTorque(d.gravity - D.cwiseProduct(v));
  }

  BlockTester<SafetySupervisor> t;
  ArmStatus status{.mode = ControlMode::Position};
  JointTorque tau{1, 2, 3, 4, 5, 6, 7};
  MotorCurrent i{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
};

TEST(SafetySupervisor, LetsTheControllerHaveTheArmBitForBit) {
  Watched w(ControlMode::Torque);
  w.Run();
  EXPECT_EQ(w.t.Get(w.t->arm_torque), w.tau);
  EXPECT_EQ(w.t.Get(w.t->arm_current), w.i);
  EXPECT_EQ(w.t.Get(w.t->arm_mode), ControlMode::Torque);
  EXPECT_EQ(w.report().cause, SafetyCause::None);
}

TEST(SafetySupervisor, PassesPositionsOnFromTheFirstTick) {
  Watched w(ControlMode::Position);
  w.Tick();
  EXPECT_EQ(w.report().state, Running);
  EXPECT_EQ(w.t.Get(w.t->arm_position), kHome);
}

TEST(SafetySupervisor, CarriesTheArmUntilItIsInTheModeAskedFor) {
  Watched w(ControlMode::Current);
  w.status.switching = 0b1000000;
  w.Tick(100);
  EXPECT_EQ(w.report().state, Engaging);
  EXPECT_EQ(w.t.Get(w.t->arm_mode), ControlMode::Current);
  const PerJoint carried = w.Damped().cwiseQuotient(kTorquePerAmpere);
  EXPECT_LT((w.t.Get(w.t->arm_current) - carried).norm(), 1e-12);  // round-off
  w.status.switching = 0;
  w.Tick(2);
  EXPECT_EQ(w.report().state, Running);
}

TEST(SafetySupervisor, BlendsLinearlyFromTheOneToTheOther) {
  Watched w(ControlMode::Torque);
  w.Tick(2);
  const JointTorque begin = w.t.Get(w.t->arm_torque);
  const double share = 1e-3 / 0.5;
  EXPECT_LT((begin - ((1 - share) * w.Damped() + share * w.tau)).norm(), 1e-12);  // round-off
  w.Tick(249);
  EXPECT_LT((w.t.Get(w.t->arm_torque) - (0.5 * w.Damped() + 0.5 * w.tau)).norm(), 1e-11)
      << "250 sums of 1/500";
}

TEST(SafetySupervisor, DampsAndCarriesAfterAFault) {
  Watched w(ControlMode::Torque);
  w.Run();
  const JointVelocity v{0.1, -0.2, 0.3, 0.2, 0.1, 0.1, -0.3};
  w.t.Set(w.t->measured_velocity, v);
  w.t.Set(w.t->word, {.stop = true});
  w.Tick();
  EXPECT_EQ(w.report().state, Damped);
  EXPECT_EQ(w.report().cause, SafetyCause::UserStop);
  EXPECT_LT((w.t.Get(w.t->arm_torque) - w.Damped(v)).norm(), 1e-12);  // round-off
  const PerJoint i = w.Damped(v).cwiseQuotient(kTorquePerAmpere);
  EXPECT_LT((w.t.Get(w.t->arm_current) - i).norm(), 1e-12);
}

TEST(SafetySupervisor, HoldsWhenTheArmIsAtRestAndEndsThere) {
  Watched w(ControlMode::Torque);
  w.Run();
  w.t.Set(w.t->word, {.stop = true});
  w.Tick(1);
  w.Tick(199);
  EXPECT_EQ(w.report().state, Damped) << "at rest for 0.2 s";
  w.Tick(2);
  EXPECT_EQ(w.report().state, Holding);
  EXPECT_EQ(w.t.Get(w.t->arm_mode), ControlMode::Position);
  EXPECT_EQ(w.t.Get(w.t->arm_position), kHome);
  w.Tick(203);
  EXPECT_EQ(w.report().state, Stopped) << "nobody can acknowledge a stop: at rest for 0.2 s";
}

TEST(SafetySupervisor, HoldsAfterAWhileEvenIfSomethingMovesTheArm) {
  Watched w(ControlMode::Torque, {.damped_s = 1});
  w.Run();
  w.t.Set(w.t->measured_velocity, {0, 0.3, 0, 0, 0, 0, 0});
  w.t.Set(w.t->word, {.stop = true});
  w.Tick(1000);
  EXPECT_EQ(w.report().state, Damped);
  w.Tick(2);
  EXPECT_EQ(w.report().state, Holding);
  // From 0.3 rad/s with 5 rad/s²: 60 ms and v²/2a = 9 mrad, in steps of h one v h/2 less.
  w.Tick(60);
  EXPECT_NEAR(w.t.Get(w.t->arm_position)(1) - kHome(1), 0.3 * 0.3 / 2 / 5, 0.3e-3);
}

TEST(SafetySupervisor, WaitsForAnAcknowledgementAndThenStops) {
  Watched w(ControlMode::Torque);
  w.Run();
  w.t.Set(w.t->torque_command, {kNaN, 0, 0, 0, 0, 0, 0});
  w.Tick();
  w.t.Set(w.t->torque_command, w.tau);
  w.Tick(202);
  EXPECT_EQ(w.report().state, Holding);
  EXPECT_EQ(w.report().cause, SafetyCause::CommandNotFinite)
      << "the first fault, though it is over";
  EXPECT_EQ(w.report().now, SafetyCause::None);
  w.Tick(4900);
  EXPECT_EQ(w.report().state, Holding);
  w.Tick(200);
  EXPECT_EQ(w.report().state, Stopped);
  w.t.Set(w.t->word, {.acknowledged = 1});
  w.Tick();
  EXPECT_EQ(w.report().state, Stopped) << "too late";
}

TEST(SafetySupervisor, LetsTheControllerBackWhenAFaultIsOverAndAcknowledged) {
  for (const int after : {50, 300}) {  // in Damped, in Holding
    Watched w(ControlMode::Torque);
    w.Run();
    w.t.Set(w.t->torque_command, {kNaN, 0, 0, 0, 0, 0, 0});
    EXPECT_FALSE(w.t.Get(w.t->has_arm));
    w.Tick(after);
    EXPECT_TRUE(w.t.Get(w.t->has_arm));
    w.t.Set(w.t->word, {.acknowledged = 1});
    w.Tick();
    EXPECT_NE(w.report().cause, SafetyCause::None) << "the fault is still there";
    w.t.Set(w.t->torque_command, w.tau);
    w.Tick(10);
    EXPECT_NE(w.report().cause, SafetyCause::None) << "that acknowledgement is spent";
    w.t.Set(w.t->word, {.acknowledged = 2});
    w.Tick();
    EXPECT_EQ(w.report().state, Engaging);
    EXPECT_FALSE(w.t.Get(w.t->has_arm));
    w.Tick(503);
    EXPECT_EQ(w.report().state, Running);
    EXPECT_EQ(w.t.Get(w.t->arm_torque), w.tau);
  }
}

TEST(SafetySupervisor, LeadsFromWhereTheArmIsHeldToTheControllersPosition) {
  Watched w(ControlMode::Position);
  w.Tick(2);
  w.t.Set(w.t->position_command, {kNaN, 0, 0, 0, 0, 0, 0});
  w.Tick(50);
  ASSERT_EQ(w.report().state, Holding);
  JointPosition wanted = kHome;
  wanted(1) += 0.05;
  w.t.Set(w.t->position_command, wanted);
  w.Tick();
  w.t.Set(w.t->word, {.acknowledged = 1});
  w.Tick();
  const double held = w.t.Get(w.t->arm_position)(1);
  double before = held;
  for (int k = 0; k < 600; ++k) {
    w.Tick();
    EXPECT_GE(w.t.Get(w.t->arm_position)(1), before);
    before = w.t.Get(w.t->arm_position)(1);
  }
  EXPECT_EQ(held, kHome(1));
  EXPECT_EQ(before, wanted(1));
}

/// What goes wrong, and how it is called.
struct Fault {
  SafetyCause cause;
  std::function<void(Watched&)> happen;
  bool holds_at_once = false;
};

std::vector<Fault> Faults() {
  const auto measured = [](auto port, int joint, double value) {
    return [=](Watched& w) {
      auto x = w.t.Get((*w.t).*port);
      x(joint) = value;
      w.t.Set((*w.t).*port, x);
    };
  };
  const auto status = [](auto change) {
    return [=](Watched& w) {
      change(w.status);
      w.t.Set(w.t->status, w.status);
    };
  };
  using S = SafetySupervisor;
  return {
      {SafetyCause::UserStop, [](Watched& w) { w.t.Set(w.t->word, {.stop = true}); }},
      {SafetyCause::NotConnected, status([](ArmStatus& s) { s.connected = false; }), true},
      {SafetyCause::ArmFault, status([](ArmStatus& s) { s.arm_faulted = true; }), true},
      {SafetyCause::JointFault, status([](ArmStatus& s) { s.faulted = 4; }), true},
      {SafetyCause::StaleFeedback, status([](ArmStatus& s) { s.age = 5; }), true},
      {SafetyCause::NotFinite, measured(&S::measured_position, 2, kNaN), true},
      {SafetyCause::NotFinite, measured(&S::measured_velocity, 2, kNaN), true},
      {SafetyCause::NotFinite, measured(&S::measured_torque, 2, kNaN), true},
      {SafetyCause::PositionLimit, measured(&S::measured_position, 1, 2.235)},
      {SafetyCause::PositionLimit, measured(&S::measured_position, 1, -2.235)},
      {SafetyCause::PositionJump, measured(&S::measured_position, 0, 0.03)},
      {SafetyCause::VelocityLimit, measured(&S::measured_velocity, 4, -3)},
      {SafetyCause::TorqueLimit,
       [](Watched& w) {
         for (const double tau : {30., 60., 92.}) {
           w.t.Set(w.t->measured_torque, {0, tau, 0, 0, 0, 0, 0});
           if (tau < 90) w.Tick();
         }
       }},
      {SafetyCause::TorqueJump, measured(&S::measured_torque, 1, 40), true},
      {SafetyCause::Temperature, measured(&S::temperature, 0, 80)},
      {SafetyCause::Divergence, measured(&S::external_torque, 3, 96)},
      {SafetyCause::Divergence, measured(&S::external_torque, 3, kNaN)},
      {SafetyCause::CommandNotFinite,
       [](Watched& w) {
         w.t.Set(w.t->position_command, {kNaN, 0, 0, 0, 0, 0, 0});
         w.t.Set(w.t->torque_command, {kNaN, 0, 0, 0, 0, 0, 0});
         w.t.Set(w.t->current_command, {kNaN, 0, 0, 0, 0, 0, 0});
       }},
      {SafetyCause::CommandNotFinite,
       [](Watched& w) { w.t.Set(w.t->mode, static_cast<ControlMode>(9)); }},
      {SafetyCause::Overruns, [](Watched& w) { w.t.Set(w.t->timing, {.missed = 21}); }},
  };
}

TEST(SafetySupervisor, KnowsEveryFaultInEveryMode) {
  for (const Fault& fault : Faults())
    for (const ControlMode mode : {ControlMode::Position, ControlMode::Torque, ControlMode::Current,
                                   ControlMode::TorqueHighVelocity}) {
      SCOPED_TRACE(WordOf(fault.cause) + ", " + WordOf(mode));
      Watched w(mode);
      w.Run();
      fault.happen(w);
      w.Tick();
      EXPECT_EQ(w.report().cause, fault.cause);
      const bool holds = fault.holds_at_once || mode == ControlMode::Position;
      EXPECT_EQ(w.report().state, holds ? Holding : Damped);
      EXPECT_EQ(w.t.Get(w.t->arm_mode), holds ? ControlMode::Position : mode);
      EXPECT_TRUE(w.t.Get(w.t->arm_position).allFinite());
      EXPECT_TRUE(w.t.Get(w.t->arm_torque).allFinite());
      EXPECT_TRUE(w.t.Get(w.t->arm_current).allFinite());
      w.Tick(10000);  // t_damped + t_hold and more
      EXPECT_EQ(w.report().state, Stopped);
      EXPECT_EQ(w.report().cause, fault.cause) << "the first";
    }
}

TEST(SafetySupervisor, KnowsCommandsThatJump) {
  for (const ControlMode mode : {ControlMode::Torque, ControlMode::Current}) {
    Watched w(mode);
    w.Run();
    w.t.Set(w.t->torque_command, w.tau + JointTorque{0, 48, 0, 0, 0, 0, 0});
    w.t.Set(w.t->current_command, w.i + MotorCurrent{0, 5.1, 0, 0, 0, 0, 0});
    w.Tick();
    EXPECT_EQ(w.report().cause, SafetyCause::CommandJump);
    EXPECT_EQ(w.report().joint, 1);
    EXPECT_EQ(w.report().state, Damped);
  }
}

TEST(SafetySupervisor, KnowsAPositionThatIsNotFollowed) {
  Watched w(ControlMode::Position);
  w.Run();
  for (int k = 1; k <= 80; ++k) {
    w.t.Set(w.t->position_command, kHome + JointPosition{0, 0, 0, 1e-3 * k, 0, 0, 0});
    w.Tick();
  }
  EXPECT_EQ(w.report().cause, SafetyCause::Tracking);
  EXPECT_EQ(w.report().joint, 3);
  EXPECT_NEAR(w.report().value, 0.071, 1e-12);
}

TEST(SafetySupervisor, DoesNotFollowAPositionThatJumps) {
  Watched w(ControlMode::Position);
  w.Run();
  w.t.Set(w.t->position_command, kHome + JointPosition{0, 0, 0, 1, 0, 0, 0});
  w.Tick(20);
  EXPECT_EQ(w.report().cause, SafetyCause::CommandJump);
  EXPECT_EQ(w.t.Get(w.t->arm_position), kHome);
}

TEST(SafetySupervisor, HoldsTheArmUntilAPositionToFollowIsNear) {
  Watched w(ControlMode::Position, {.engage_s = 1});
  w.t.Set(w.t->position_command, kHome + JointPosition{0, 0, 0, 0.5, 0, 0, 0});
  w.Tick(900);
  EXPECT_EQ(w.report().state, Engaging);
  EXPECT_EQ(w.t.Get(w.t->arm_position), kHome);
  w.Tick(200);
  EXPECT_EQ(w.report().cause, SafetyCause::Tracking);
}

TEST(SafetySupervisor, HoldsNearTheArmWhenItFellBehindItsReference) {
  Watched w(ControlMode::Position);
  w.Run();
  for (int k = 1; k <= 60; ++k) {
    w.t.Set(w.t->position_command, kHome + JointPosition{0, 0, 0, 1e-3 * k, 0, 0, 0});
    w.Tick();
  }
  w.status.arm_faulted = true;
  w.t.Set(w.t->status, w.status);
  w.Tick(100);
  EXPECT_EQ(w.report().state, Holding);
  EXPECT_NEAR(w.t.Get(w.t->arm_position)(3), kHome(3) + 0.06, 1e-12) << "the arm is at rest";
}

TEST(SafetySupervisor, FollowsAJointThatIsNotInPositionControlYet) {
  Watched w(ControlMode::Torque);
  w.Run();
  w.status.arm_faulted = true;
  w.status.switching = 0b10;
  w.t.Set(w.t->status, w.status);
  w.t.Set(w.t->measured_velocity, {0, 0.5, 0, 0, 0, 0, 0});
  for (int k = 1; k <= 10; ++k) {
    w.t.Set(w.t->measured_position, kHome + JointPosition{0, 5e-4 * k, 0, 0, 0, 0, 0});
    w.Tick();
  }
  EXPECT_NEAR(w.t.Get(w.t->arm_position)(1), kHome(1) + 5e-3, 1e-12);
}

TEST(SafetySupervisor, DoesNotWaitForAModeForEver) {
  Watched w(ControlMode::Current, {.engage_s = 1});
  w.status.switching = 1;
  w.Tick(1000);
  EXPECT_EQ(w.report().state, Engaging);
  w.Tick(3);
  EXPECT_EQ(w.report().cause, SafetyCause::Mode);
  EXPECT_EQ(w.report().state, Holding);
}

TEST(SafetySupervisor, ForgivesMissedTicksThatAreFarApart) {
  Watched w(ControlMode::Torque);
  w.Run();
  for (int k = 1; k <= 40; ++k) {  // 20 a second
    w.t.Set(w.t->timing, {.missed = k});
    w.Tick(50);
  }
  EXPECT_EQ(w.report().state, Running);
  w.t.Set(w.t->timing, {.missed = 61});
  w.Tick();
  EXPECT_EQ(w.report().cause, SafetyCause::Overruns);
}

TEST(SafetySupervisor, DoesNotBrakeAMotionThatMayBeOver) {
  Watched w(ControlMode::Torque);
  w.Run();
  w.t.Set(w.t->measured_velocity, {1, 1, 1, 1, 1, 1, 1});
  w.status.age = 3;
  w.t.Set(w.t->status, w.status);
  w.t.Set(w.t->word, {.stop = true});
  w.Tick();
  EXPECT_EQ(w.report().state, Damped);
  EXPECT_LT((w.t.Get(w.t->arm_torque) - w.Damped()).norm(), 1e-12);
}

TEST(SafetySupervisor, LetsNothingOutOfBoundsWhateverComesIn) {
  const RobotModel model = Gen3();
  std::mt19937 random(3);
  std::uniform_int_distribution<int> choice(0, 9);
  std::uniform_real_distribution<double> number(-200, 200);
  std::uniform_int_distribution<std::uint64_t> bits;
  const auto any = [&] {
    switch (choice(random)) {
      case 0:
        return kNaN;
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return std::bit_cast<double>(bits(random));
      default:
        return number(random);
    }
  };
  const auto vector = [&]<class S>(S x) {
    for (Eigen::Index j = 0; j < x.size(); ++j) x(j) = any();
    return x;
  };
  Watched w(ControlMode::Torque);
  for (int k = 0; k < 20000; ++k) {
    if (k % 40 == 0)  // so that it leaves its states again
      w.t.Set(w.t->word, {.acknowledged = static_cast<std::uint32_t>(k)});
    if (choice(random) < 3) {
      w.t.Set(w.t->mode, static_cast<ControlMode>(choice(random)));
      w.t.Set(w.t->position_command, vector(kHome));
      w.t.Set(w.t->torque_command, vector(w.tau));
      w.t.Set(w.t->current_command, vector(w.i));
      w.t.Set(w.t->measured_position, vector(kHome));
      w.t.Set(w.t->measured_velocity, vector(JointVelocity::Zero(model.joints())));
      w.t.Set(w.t->measured_torque, vector(w.tau));
      w.status.age = choice(random);
      w.status.connected = choice(random) > 0;
    }
    w.Tick();
    ASSERT_TRUE(w.t.Get(w.t->arm_position).allFinite()) << "tick " << k;
    ASSERT_TRUE(
        (w.t.Get(w.t->arm_torque).cwiseAbs().array() <= model.effort_limit().array()).all());
    ASSERT_TRUE((w.t.Get(w.t->arm_current).cwiseAbs().array() <= kCurrentLimit.array()).all());
    ASSERT_TRUE(IsMode(w.t.Get(w.t->arm_mode)));
  }
}

TEST(SafetySupervisor, TakesNothingFromTheHeap) {
  Watched w(ControlMode::Current);
  w.Tick(3);
  const long before = Allocations();
  for (int k = 0; k < 300; ++k) w.t.Tick();
  w.t.Set(w.t->word, {.stop = true});
  for (int k = 0; k < 1000; ++k) w.t.Tick();
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(SafetySupervisor, RefusesSettingsThatMakeNoSense) {
  EXPECT_THAT(ErrorOf([] { SafetySupervisor(Options({.stale_after = 0})); }),
              testing::HasSubstr("stale_after"));
  EXPECT_THAT(ErrorOf([] { SafetySupervisor(Options({.deceleration = -1})); }),
              testing::HasSubstr("deceleration"));
  EXPECT_THAT(ErrorOf([] { SafetySupervisor(Options({.damping = Eigen::Vector2d(1, 1)})); }),
              testing::HasSubstr("damping"));
  EXPECT_THAT(ErrorOf([] {
                SafetySupervisor::Options o = Options();
                o.current_limit = MotorCurrent{1, 2};
                SafetySupervisor{o};
              }),
              testing::HasSubstr("current_limit"));
}

}  // namespace
}  // namespace pliant
