// Rows of limits beside the joints' own, and what gives way where they contradict each other.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pliant/tests/controllers/compliance_rig.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Outcome = ComplianceQpReport::Outcome;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// lower ≤ Σ a_i q̈_i ≤ upper, one row.
AccelerationRows Row(int joints, int joint, double lower, double upper, int priority) {
  AccelerationRows row = AccelerationRows::None(1, joints, priority);
  row.A(0, joint) = 1;
  row.lower(0) = lower;
  row.upper(0) = upper;
  return row;
}

PerJoint Unlimited(const RobotModel& m) { return PerJoint::Constant(m.size(), 1e9); }

TEST(ComplianceQp, KeepsARowAndReportsItsMultiplier) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame", false,
                    {Row(7, 2, -kInfinity, 1, 2), Row(7, 3, -1000, 1000, 2)});
  rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
  RandomStates random(m, 21);
  int active = 0;
  for (int k = 0; k < 200; ++k) {
    rig.SetState(random.q(), 0.1 * random.v());
    rig.Tick(random.tau());
    const ComplianceQpReport& report = rig.report();
    ASSERT_EQ(report.outcome, Outcome::Solved);
    ASSERT_LT(rig.acceleration()(2), 1 + 1e-9);
    // Stationarity, ∇f = Aᵀ λ: the gradient is along the rows that act, and pushes inwards.
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(7);
    double size = 0;
    for (const auto* task : {&rig.pose->objective, &rig.posture->objective}) {
      const Objective& t = rig.sim->Get(*task);
      const Eigen::VectorXd residual = t.A * rig.acceleration() - t.b;
      gradient += t.weight * t.A.transpose() * residual;
      size = std::max(size, t.weight * (t.A.cwiseAbs().transpose() * t.b.cwiseAbs()).maxCoeff());
    }
    gradient(2) -= report.row_multiplier(0);
    gradient(3) -= report.row_multiplier(1);
    ASSERT_LT(gradient.cwiseAbs().maxCoeff(), 1e-9 * size);
    ASSERT_LE(report.row_multiplier(0), 0) << "an upper limit acts downwards";
    active += report.row_multiplier(0) < 0;
  }
  EXPECT_GT(active, 50);
}

TEST(ComplianceQp, LetsTheLeastImportantOfTwoRowsGiveWay) {
  const RobotModel m = Gen3();
  for (const bool first_is_important : {true, false}) {
    ComplianceRig rig(m, "tool_frame", false,
                      {Row(7, 0, 3, kInfinity, first_is_important ? 2 : 4),
                       Row(7, 0, -kInfinity, -5, first_is_important ? 4 : 2)});
    rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
    rig.Tick(JointTorque::Zero(m.joints()));
    const ComplianceQpReport& report = rig.report();
    EXPECT_EQ(report.outcome, Outcome::Relaxed);
    EXPECT_EQ(report.status, QpStatus::Infeasible);
    EXPECT_EQ(report.relaxed_priority, 4);
    EXPECT_NEAR(rig.acceleration()(0), first_is_important ? 3 : -5, 1e-7);
    EXPECT_NEAR(report.row_slack(first_is_important ? 1 : 0), 8, 1e-7);
    EXPECT_NEAR(report.row_slack(first_is_important ? 0 : 1), 0, 1e-7);
  }
}

TEST(ComplianceQp, PutsTheJointsBoundsBeforeRowsAndTorqueBeforeBoth) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame", true, {Row(7, 3, -kInfinity, -1e4, 2)});
  JointPosition q = JointPosition::Zero(m.joints());
  q(3) = -1;
  rig.SetState(q, JointVelocity::Zero(m.joints()));
  rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
  rig.Tick(JointTorque::Zero(m.joints()));
  const double lower = rig.sim->Get(rig.damper->bounds).lower(3);
  EXPECT_EQ(rig.report().relaxed_priority, 2);
  EXPECT_NEAR(rig.acceleration()(3), lower, 1e-6 * std::abs(lower));
  EXPECT_NEAR(rig.report().row_slack(0), 1e4 + lower, 1e-6 * 1e4);
  EXPECT_NEAR(rig.report().bound_slack(3), 0, 1e-6 * std::abs(lower));

  // 0.1 N·m beside what weight asks for cannot bring the joint to -1e4.
  rig.sim->Set(rig.qp->torque_limit, PerJoint(rig.d().gravity.cwiseAbs().array() + 0.1));
  rig.Tick(JointTorque::Zero(m.joints()));
  EXPECT_EQ(rig.report().outcome, Outcome::Relaxed);
  EXPECT_TRUE((rig.torque().array().abs() <= rig.d().gravity.array().abs() + 0.1).all());
}

TEST(ComplianceQp, GivesContradictingRowsOfOnePriorityTheMiddle) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame", false,
                    {Row(7, 1, 6, kInfinity, 3), Row(7, 1, -kInfinity, 2, 3)});
  rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
  rig.Tick(JointTorque::Zero(m.joints()));
  EXPECT_NEAR(rig.acceleration()(1), 4, 1e-6);
  EXPECT_NEAR(rig.report().row_slack(0), 2, 1e-6);
  EXPECT_NEAR(rig.report().row_slack(1), 2, 1e-6);
}

TEST(ComplianceQp, RefusesMoreRowsThanItHasRoomFor) {
  const RobotModel m = Gen3();
  EXPECT_EQ(ErrorOf([&] { ComplianceQp({.model = m, .period = 1ms, .rows = 65}); }),
            "rows must be from 0 to 64, got 65");
}

TEST(ComplianceQp, FallsBackWhereOtherRowsJoinThanItWasMadeFor) {
  const RobotModel m = Gen3();
  DiagramBuilder b;
  auto& q = b.Add<Constant<JointPosition>>(
      "q", {.space = m.joints(), .value = JointPosition::Zero(m.joints())});
  auto& v = b.Add<Constant<JointVelocity>>(
      "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
  auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m});
  auto& rows = b.Add<Constant<AccelerationRows>>(
      "rows", {.space = m.joints(), .value = AccelerationRows::None(2, 7, 2)});
  auto& qp = b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms, .rows = 1});
  b.Connect(q.y, dynamics.position);
  b.Connect(v.y, dynamics.velocity);
  b.Connect(dynamics.dynamics, qp.dynamics);
  b.Connect(rows.y, qp.rows);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  sim.AdvanceThroughTick();
  EXPECT_EQ(sim.Get(qp.report).outcome, Outcome::Fallback);
  EXPECT_EQ(sim.Get(qp.report).status, QpStatus::InvalidData);
}

/// Rows of random directions whose limits mostly contradict each other and everything else.
AccelerationRows RandomRows(int count, int priority, RandomStates& random) {
  AccelerationRows rows = AccelerationRows::None(count, 7, priority);
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd draw = random.Uniform(1.0);
    rows.A.row(i) = random.Uniform(1.0).transpose();
    if (draw(0) < 0.5) rows.lower(i) = 300 * draw(1);
    if (draw(2) < 0.5) rows.upper(i) = 300 * draw(3);
  }
  return rows;
}

// 10⁵ ticks with states, pushes and limits far beyond what an arm meets: every one ends with finite
// numbers, inside the torque limits, and what is exceeded is said.
TEST(ComplianceQp, NeverLosesItselfInContradictingLimits) {
  const RobotModel m = Gen3();
  RandomStates random(m, 22);
  ComplianceRig rig(m, "tool_frame", true,
                    {AccelerationRows::None(4, 7, 2), AccelerationRows::None(3, 7, 3),
                     AccelerationRows::None(6, 7, 5)});
  int relaxed = 0, fallbacks = 0;
  long allocations = 0;
  int counts[] = {4, 3, 6};
  for (int k = 0; k < 100'000; ++k) {
    const PerJoint limit = (0.2 + 0.8 * std::abs(random.Uniform(1.0)(0))) * m.effort_limit();
    rig.sim->Set(rig.qp->torque_limit, limit);
    rig.SetState(3 * random.q(), 3 * random.v());
    for (std::size_t r = 0; r < 3; ++r)
      rig.sim->Set(rig.rows[r]->value,
                   RandomRows(counts[r], rig.sim->Get(rig.rows[r]->y).priority, random));
    const JointTorque tau_e = 3 * random.tau();
    const long before = Allocations();
    rig.Tick(tau_e);
    allocations += Allocations() - before;
    const ComplianceQpReport& report = rig.report();
    ASSERT_TRUE(rig.torque().allFinite()) << k;
    ASSERT_TRUE(rig.acceleration().allFinite()) << k;
    ASSERT_TRUE((rig.torque().array().abs() <= limit.array()).all()) << k;
    fallbacks += report.outcome == Outcome::Fallback;
    if (report.outcome != Outcome::Relaxed) continue;
    ++relaxed;
    ASSERT_TRUE(report.bound_slack.allFinite() && report.row_slack.allFinite()) << k;
    ASSERT_GT(report.relaxed_priority, 0) << k;
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(fallbacks, 0);
  EXPECT_GT(relaxed, 50'000);
}

}  // namespace
}  // namespace pliant
