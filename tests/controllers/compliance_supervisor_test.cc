#include "pliant/controllers/compliance_supervisor.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Tester = BlockTester<ComplianceSupervisor>;

FrameDynamics ToolAt(const Eigen::Vector3d& p, double turn = 0) {
  FrameDynamics tool;
  tool.J = Jacobian::Zero(6, 7);
  tool.pose.position = p;
  tool.pose.rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return tool;
}

Wrench Pressed(double force, double moment = 0) {
  Wrench W;
  W << 0, moment, 0, 0, 0, -force;
  return W;
}

/// What the pose task is told to do at e and ė = 0: ẍ° − λ₂ (x − x°).
Vector6 Demand(Tester& t, const FrameDynamics& tool) {
  const Pose& target = t.Get(t->target);
  const Eigen::AngleAxisd turn(tool.pose.rotation * target.rotation.transpose());
  Vector6 e;
  e << turn.angle() * turn.axis(), tool.pose.position - target.position;
  return t.Get(t->target_acceleration) - t.Get(t->pose_stiffness).cwiseProduct(e);
}

TEST(ComplianceSupervisor, HoldsTheFirstPoseWithTheGainsOfItsMode) {
  for (const auto mode : {ComplianceMode::Stiff, ComplianceMode::NullSpace,
                          ComplianceMode::FullBody, ComplianceMode::Dual}) {
    Tester t({.joints = 7});
    t.Set(t->mode, mode);
    t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}, 0.2));
    t.Tick();
    t.Set(t->tool, ToolAt({0.5, 0.1, 0.3}, 0.3));
    for (int k = 0; k < 100; ++k) t.Tick();
    const ComplianceSupervisor::Options o;
    const ComplianceGains& gains = mode == ComplianceMode::Stiff      ? o.stiff
                                   : mode == ComplianceMode::FullBody ? o.full_body
                                                                      : o.null_space;
    EXPECT_EQ(t.Get(t->target).position, Eigen::Vector3d(0.4, 0.1, 0.3));
    EXPECT_EQ(t.Get(t->target).rotation, ToolAt({0, 0, 0}, 0.2).pose.rotation);
    EXPECT_EQ(t.Get(t->target_acceleration), Twist());
    EXPECT_EQ(t.Get(t->pose_stiffness), TaskVector::Constant(6, gains.pose_stiffness));
    EXPECT_EQ(t.Get(t->pose_damping), TaskVector::Constant(6, gains.pose_damping));
    EXPECT_EQ(t.Get(t->pose_compliance), gains.pose_compliance * TaskMatrix::Identity(6, 6));
    EXPECT_EQ(t.Get(t->posture_stiffness), PerJoint::Constant(7, gains.posture_stiffness));
    EXPECT_EQ(t.Get(t->posture_damping), PerJoint::Constant(7, gains.posture_damping));
    EXPECT_EQ(t.Get(t->posture_compliance), gains.posture_compliance * JointMatrix::Identity(7, 7));
  }
}

TEST(ComplianceSupervisor, YieldsFromTheUpperThresholdToTheLower) {
  for (const auto norm : {WrenchNorm::Force, WrenchNorm::Mixed}) {
    Tester t({.joints = 7, .norm = norm});
    t.Set(t->mode, ComplianceMode::Dual);
    t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
    // Moment 3, so that √(8.5² + 3²) = 9.01 and √(4.1² + 3²) = 5.08.
    const bool mixed = norm == WrenchNorm::Mixed;
    const auto yields_at = [&](double force) {
      t.Set(t->contact, Pressed(force, 3));
      t.Tick();
      return t.Get(t->yields);
    };
    EXPECT_FALSE(yields_at(mixed ? 8.4 : 8.99));
    EXPECT_TRUE(yields_at(mixed ? 8.5 : 9.0));
    EXPECT_TRUE(yields_at(mixed ? 4.1 : 5.01));
    EXPECT_FALSE(yields_at(mixed ? 3.9 : 4.99));
    EXPECT_FALSE(yields_at(mixed ? 8.4 : 8.99));
  }
}

TEST(ComplianceSupervisor, YieldsInTheModeDualOnly) {
  for (const auto mode :
       {ComplianceMode::Stiff, ComplianceMode::NullSpace, ComplianceMode::FullBody}) {
    Tester t({.joints = 7});
    t.Set(t->mode, mode);
    t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
    t.Set(t->contact, Pressed(100));
    t.Tick();
    EXPECT_FALSE(t.Get(t->yields));
  }
}

TEST(ComplianceSupervisor, StaysWhereItIsLeftAfterYielding) {
  Tester t({.joints = 7});
  t.Set(t->mode, ComplianceMode::Dual);
  t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
  t.Tick();
  t.Set(t->contact, Pressed(20));
  for (int k = 0; k < 600; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->pose_stiffness)(0), 0);
  const FrameDynamics pushed = ToolAt({0.5, 0.0, 0.2}, 0.4);
  t.Set(t->tool, pushed);
  t.Set(t->contact, Pressed(0));
  for (int k = 0; k < 600; ++k) t.Tick();
  EXPECT_LT((t.Get(t->target).position - pushed.pose.position).norm(), 1e-15);
  EXPECT_EQ(t.Get(t->target).rotation, pushed.pose.rotation);
  EXPECT_EQ(t.Get(t->pose_stiffness)(0), 400);
}

TEST(ComplianceSupervisor, ChangesWhatItDemandsByAStepOfTheWholeChangeATick) {
  const double part = 1e-3 / 0.5;                             // h/T
  const FrameDynamics off = ToolAt({0.45, 0.08, 0.33}, 0.1);  // 5 cm and 0.1 rad off its target
  for (const auto from : {ComplianceMode::Stiff, ComplianceMode::NullSpace,
                          ComplianceMode::FullBody, ComplianceMode::Dual})
    for (const auto to : {ComplianceMode::Stiff, ComplianceMode::NullSpace,
                          ComplianceMode::FullBody, ComplianceMode::Dual}) {
      if (from == to) continue;
      Tester t({.joints = 7});
      t.Set(t->mode, from);
      t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
      t.Tick();
      t.Set(t->tool, off);
      t.Tick();
      Vector6 last = Demand(t, off);
      const Vector6 at_first = last;
      const double whole = at_first.norm() + 1e-12;
      t.Set(t->mode, to);
      for (int k = 0; k < 600; ++k) {
        t.Tick();
        const Vector6 now = Demand(t, off);
        ASSERT_LT((now - last).norm(), part * whole * (1 + 1e-9)) << k;
        last = now;
      }
      EXPECT_LT(last.norm(), 1e-12 * whole) << "it holds the pose it had at the change";
    }
}

TEST(ComplianceSupervisor, KeepsItsDemandThroughAChangeDuringAChange) {
  const double part = 1e-3 / 0.5;
  Tester t({.joints = 7});
  t.Set(t->mode, ComplianceMode::NullSpace);
  t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
  t.Tick();
  FrameDynamics off = ToolAt({0.45, 0.08, 0.33}, 0.1);
  t.Set(t->tool, off);
  t.Tick();
  double largest = Demand(t, off).norm();
  const auto change = [&](ComplianceMode mode) {
    const Vector6 before = Demand(t, off);
    largest = std::max(largest, before.norm());
    t.Set(t->mode, mode);
    t.Tick();
    EXPECT_LT((Demand(t, off) - before).norm(), part * 2 * largest);
    for (int k = 0; k < 100; ++k) t.Tick();
  };
  change(ComplianceMode::FullBody);
  change(ComplianceMode::Dual);
  change(ComplianceMode::FullBody);
  change(ComplianceMode::Stiff);
}

TEST(ComplianceSupervisor, SwingsWithTheRatesOfItsMotion) {
  const double h = 1e-3;
  const Eigen::Vector3d way(0.02, 0.1, 0);
  Tester t({.joints = 7, .swing = way, .swing_hz = 0.5});
  t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
  t.Tick();
  double furthest = 0;
  Eigen::Vector3d before = t.Get(t->target).position, now = before;
  Eigen::Vector3d speed = Eigen::Vector3d::Zero(), acceleration = speed;
  for (int k = 0; k < 8000; ++k) {
    t.Set(t->dynamic, k > 100 && k < 5300);
    t.Tick();
    const Eigen::Vector3d after = t.Get(t->target).position;
    // Central differences: h²/6 of the third rate, at most (2π f)³ d + 60 d/T³, where A starts and
    // stops h of it.
    ASSERT_LT(((after - before) / (2 * h) - speed).norm(), 1e-4) << k;
    ASSERT_LT(((after - 2 * now + before) / (h * h) - acceleration).norm(), 0.1) << k;
    furthest = std::max(furthest, (after - Eigen::Vector3d(0.4, 0.1, 0.3)).norm());
    before = now;
    now = after;
    speed = t.Get(t->target_twist).tail<3>();
    acceleration = t.Get(t->target_acceleration).tail<3>();
  }
  EXPECT_NEAR(furthest, way.norm(), 1e-6);
  EXPECT_LT((now - Eigen::Vector3d(0.4, 0.1, 0.3)).norm(), 1e-15) << "back at its anchor";
}

TEST(ComplianceSupervisor, HoldsThePoseItHasWhileTheArmBrakes) {
  Tester t({.joints = 7});
  t.Set(t->mode, ComplianceMode::FullBody);
  t.Set(t->dynamic, true);
  t.Set(t->tool, ToolAt({0.4, 0.1, 0.3}));
  for (int k = 0; k < 1000; ++k) t.Tick();
  const FrameDynamics off = ToolAt({0.5, 0.1, 0.3});
  t.Set(t->tool, off);
  t.Set(t->brakes, true);
  for (int k = 0; k < 1000; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->pose_stiffness)(0), 400);
  EXPECT_EQ(t.Get(t->pose_compliance)(0, 0), 0);
  EXPECT_EQ(t.Get(t->posture_stiffness)(0), 10);
  EXPECT_EQ(t.Get(t->posture_damping)(0), 20);
  EXPECT_EQ(t.Get(t->target_twist), Twist());
  t.Set(t->brakes, false);
  for (int k = 0; k < 1000; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->pose_stiffness)(0), 30);
  EXPECT_NE(t.Get(t->target_twist), Twist());
}

TEST(ComplianceSupervisor, RefusesThresholdsAndTimesThatAreNone) {
  const auto error = [](ComplianceSupervisor::Options o) {
    return ErrorOf([&] { ComplianceSupervisor supervisor(o); });
  };
  EXPECT_EQ(error({.joints = 7, .enter = 5, .leave = 5}), "leave must be below enter, 5 N, got 5");
  EXPECT_EQ(error({.joints = 7, .leave = 0}), "leave must be > 0 N, got 0");
  EXPECT_EQ(error({.joints = 7, .change_s = 0}), "change_s must be > 0 s, got 0");
  EXPECT_EQ(error({.joints = 7, .swing_hz = -1}), "swing_hz must be > 0 Hz, got -1");
  EXPECT_EQ(error({.joints = 0}), "joints must be from 1 to 32, got 0");
  EXPECT_EQ(error({.joints = 7, .full_body = {-30, 11, 1, 0, 4, 1}}),
            "full_body.pose_stiffness must be >= 0 1/s², got -30");
}

}  // namespace
}  // namespace pliant
