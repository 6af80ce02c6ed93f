#include "pliant/controllers/tool_impedance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/controllers/velocity_tracking.h"
#include "pliant/systems/block_tester.h"
#include "pliant/systems/filtered_derivative.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

FrameDynamics ToolAt(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m, {"end_effector_link"});
  ComputeDynamics(m, q, v, d);
  return d.frame[0];
}

TEST(VelocityTracking, IsZeroWithoutAnErrorAndHasTheGainsOfTheEquation) {
  BlockTester<VelocityTracking> t(VelocityTracking::Options{.gain = 5, .rate_gain_s = 0.1});
  t.Set(t->desired, {0.1, -0.2, 0.3});
  t.Set(t->velocity, {0.1, -0.2, 0.3});
  EXPECT_EQ(t.Get(t->command).norm(), 0);
  t.Set(t->velocity, {0, 0, 0});
  t.Set(t->error_rate, {1, 2, 3});
  EXPECT_LT((Vector3d(t.Get(t->command)) - Vector3d(0.6, -0.8, 1.8)).norm(), 1e-15);
  EXPECT_LT((Vector3d(t.Get(t->error)) - Vector3d(0.1, -0.2, 0.3)).norm(), 1e-15);
}

// m v̇ = D k_p (v_d − v), so v = v_d (1 − exp(−D k_p t/m)); with k_d and an exact derivative the
// mass is m + D k_d, with a filtered one that is what it becomes as the filter gets fast.
TEST(VelocityTracking, MakesAFreeMassFollowAsAFirstOrderLag) {
  const double m = 2, D = 40, k_p = 0.5, h = 1e-5;
  for (const double k_d : {0.0, 0.05}) {
    BlockTester<VelocityTracking> t(VelocityTracking::Options{.gain = k_p, .rate_gain_s = k_d});
    BlockTester<FilteredDerivative<LinearVelocity>> rate(
        FilteredDerivative<LinearVelocity>::Options{.cutoff_hz = 300,
                                                    .period = Duration::Nanoseconds(10'000)});
    Vector3d v = Vector3d::Zero();
    const Vector3d wanted(0.1, 0, -0.2);
    t.Set(t->desired, wanted);
    for (int i = 0; i < 20'000; ++i) {
      t.Set(t->velocity, v);
      if (k_d > 0) {
        rate.Set(rate->u, t.Get(t->error));
        rate.Tick();
        t.Set(t->error_rate, rate.Get(rate->y));
      }
      v += h / m * D * Vector3d(t.Get(t->command));
    }
    const double reached = 1 - std::exp(-D * k_p * 0.2 / (m + D * k_d));
    // The filter, 1/(2π 300 Hz) = 0.5 ms, is late by that much of a lag of 0.1 s: below 1 %.
    EXPECT_LT((v - reached * wanted).norm(), (k_d > 0 ? 5e-3 : 2e-5) * wanted.norm());
  }
}

TEST(VelocityImpedance, HasTheTorqueOfTheEquation) {
  const RobotModel m = Lwr();
  RandomStates random(m, 3);
  const Vector3d D(40, 30, 10), K(15, 10, 5), D_w(1, 2, 3);
  BlockTester<VelocityImpedance> t(VelocityImpedance::Options{
      .joints = m.joints(), .damping = D, .orientation = {.stiffness = K, .damping = D_w}});
  for (int i = 0; i < 50; ++i) {
    const FrameDynamics tool = ToolAt(m, random.q(), random.v());
    const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
    const double angle = 3 * std::abs(random.Uniform(1)(0));
    const Vector3d command = random.Uniform(1).head<3>();
    const Twist twist = random.Uniform(1).head<6>();
    t.Set(t->frame, tool);
    t.Set(t->command, command);
    t.Set(t->target_twist, twist);
    t.Set(t->target,
          Pose{Vector3d::Zero(), AngleAxisd(angle, axis).toRotationMatrix() * tool.pose.rotation});
    EXPECT_LT((Vector3d(t.Get(t->orientation_error)) - angle * axis).norm(), 1e-13);
    Vector6 F;
    F << K.cwiseProduct(angle * axis) - D_w.cwiseProduct((tool.twist - twist).head<3>()),
        D.cwiseProduct(command);
    EXPECT_LT((t.Get(t->wrench) - F).norm(), 1e-12);
    EXPECT_LT((t.Get(t->torque) - tool.J.transpose() * F).norm(), 1e-12);
  }
}

TEST(VelocityImpedance, IsZeroWhereNothingIsMissing) {
  const RobotModel m = Lwr();
  RandomStates random(m, 4);
  BlockTester<VelocityImpedance> t(VelocityImpedance::Options{.joints = m.joints()});
  const FrameDynamics tool = ToolAt(m, random.q(), random.v());
  t.Set(t->frame, tool);
  t.Set(t->target, tool.pose);
  t.Set(t->command, {0, 0, 0});
  // Round-off of R Rᵀ is 1e-15, of which the angle is the square root at worst.
  EXPECT_LT(t.Get(t->torque).norm(), 15 * 1e-7);
}

TEST(VelocityImpedance, TurnsTheShortWayAndIsBoundedAtHalfATurn) {
  const RobotModel m = Lwr();
  RandomStates random(m, 5);
  BlockTester<VelocityImpedance> t(VelocityImpedance::Options{.joints = m.joints()});
  const FrameDynamics tool = ToolAt(m, random.q(), random.v());
  t.Set(t->frame, tool);
  t.Set(t->command, {0, 0, 0});
  for (const double angle : {kPi - 1e-6, kPi, kPi + 1e-6}) {
    t.Set(t->target,
          Pose{Vector3d::Zero(),
               AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix() * tool.pose.rotation});
    const Vector3d e = t.Get(t->orientation_error);
    EXPECT_NEAR(e.norm(), kPi, 2e-6);
    if (angle != kPi) {
      EXPECT_EQ(e.y() > 0, angle < kPi);
    }
    EXPECT_LE(t.Get(t->wrench).head<3>().norm(), 15 * kPi + 1e-9);
  }
}

// For three equal gains F_ω = k e_r does the work −d/dt ½ k ‖e_r‖².
TEST(VelocityImpedance, TurnsWithTheEnergyOfASpring) {
  RandomStates random(Lwr(), 6);
  const double h = 1e-5;
  for (int i = 0; i < 50; ++i) {
    const Vector3d w = random.Uniform(1).head<3>();
    const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
    const Eigen::Matrix3d R = AngleAxisd(2.8 * random.Uniform(1)(0), axis).toRotationMatrix();
    BlockTester<VelocityImpedance> t(VelocityImpedance::Options{.joints = Lwr().joints()});
    t.Set(t->target, Pose{});
    const auto error = [&](double s) {
      FrameDynamics tool = FrameDynamics{};
      tool.J = Jacobian::Zero(6, 7);
      tool.pose.rotation = AngleAxisd(s * w.norm(), w.normalized()).toRotationMatrix() * R;
      t.Set(t->frame, tool);
      return Vector3d(t.Get(t->orientation_error));
    };
    const double rate = (error(h).squaredNorm() - error(-h).squaredNorm()) / (4 * h);
    EXPECT_NEAR(rate, -error(0).dot(w), 1e-8);  // h² and ε/h
  }
}

TEST(ClassicalImpedance, IsASpringAndADamperAboutATarget) {
  const RobotModel m = Lwr();
  RandomStates random(m, 7);
  const Vector3d K(30, 20, 10), D(40, 30, 10);
  BlockTester<ClassicalImpedance> t(ClassicalImpedance::Options{
      .joints = m.joints(), .stiffness = K, .damping = D, .orientation = {.stiffness = {0, 0, 0}}});
  for (int i = 0; i < 20; ++i) {
    const FrameDynamics tool = ToolAt(m, random.q(), random.v());
    const Vector3d p = random.Uniform(1).head<3>();
    const Twist twist = random.Uniform(1).head<6>();
    t.Set(t->frame, tool);
    t.Set(t->target, Pose{p, tool.pose.rotation});
    t.Set(t->target_twist, twist);
    const Vector3d F =
        K.cwiseProduct(p - tool.pose.position) + D.cwiseProduct((twist - tool.twist).tail<3>());
    EXPECT_LT((t.Get(t->wrench).tail<3>() - F).norm(), 1e-13);
    EXPECT_LT((t.Get(t->torque) - tool.J.bottomRows<3>().transpose() * F).norm(), 1e-12);
  }
}

TEST(VelocityTracking, PassesTheLawsOfBlocks) {
  ExpectBlockLaws(
      BlockTester<VelocityTracking>(VelocityTracking::Options{.gain = 5, .rate_gain_s = 0.1}));
}

// What ExpectBlockLaws asks of a block, for inputs that are frames of an arm; there is no state.
TEST(ToolImpedances, StayFiniteAndOffTheHeapAndRepeatThemselves) {
  const RobotModel m = Lwr();
  const auto expect = [&](auto&& t) {
    RandomStates random(m, 65);
    const Context snapshot = t.simulator().Snapshot();
    for (int i = 0; i < 50; ++i) {
      const FrameDynamics tool = ToolAt(m, random.q(), random.v());
      const Vector3d turn = kPi * random.Uniform(1).template head<3>().normalized();  // half a turn
      const Pose target{random.Uniform(1).template head<3>(),
                        AngleAxisd(turn.norm(), turn.normalized()) * tool.pose.rotation};
      const auto torque = [&] {
        t.Set(t->frame, tool);
        t.Set(t->target, target);
        return PerJoint(t.Get(t->torque));
      };
      const PerJoint first = torque();
      const long before = Allocations();
      EXPECT_EQ(torque(), first);
      EXPECT_EQ(Allocations() - before, 0);
      EXPECT_TRUE(first.allFinite());
      t.simulator().Restore(snapshot);
      EXPECT_EQ(torque(), first);
    }
  };
  BlockTester<VelocityImpedance> velocity(VelocityImpedance::Options{.joints = m.joints()});
  velocity.Set(velocity->command, {0.1, -0.2, 0.3});
  expect(velocity);
  expect(BlockTester<ClassicalImpedance>(ClassicalImpedance::Options{.joints = m.joints()}));
}

TEST(ToolImpedances, RefuseGainsThatAreNone) {
  using testing::HasSubstr;
  const Joints joints = Lwr().joints();
  EXPECT_THAT(ErrorOf([] { VelocityTracking block({.gain = 0}); }), HasSubstr("gain must be"));
  EXPECT_THAT(ErrorOf([] { VelocityTracking block({.gain = 1, .rate_gain_s = -1}); }),
              HasSubstr("rate_gain_s must be"));
  EXPECT_THAT(ErrorOf([&] {
                VelocityImpedance block({.joints = joints, .damping = {1, -1, 1}});
              }),
              HasSubstr("damping"));
  EXPECT_THAT(
      ErrorOf([&] {
        VelocityImpedance block({.joints = joints, .orientation = {.stiffness = {1, 1, -1}}});
      }),
      HasSubstr("orientation.stiffness"));
  EXPECT_THAT(
      ErrorOf([&] {
        ClassicalImpedance block({.joints = joints, .orientation = {.damping = {-1, 0, 0}}});
      }),
      HasSubstr("orientation.damping"));
  EXPECT_THAT(ErrorOf([&] {
                ClassicalImpedance block({.joints = joints, .stiffness = {-1, 1, 1}});
              }),
              HasSubstr("stiffness"));
  EXPECT_THAT(ErrorOf([&] {
                ClassicalImpedance block({.joints = joints, .damping = {-1, 1, 1}});
              }),
              HasSubstr("damping"));
}

}  // namespace
}  // namespace pliant
