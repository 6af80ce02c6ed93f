// The properties that EC claims of its controller, on random states of both arms of the papers.

#include "pliant/controllers/compliance_qp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "pliant/tests/controllers/compliance_rig.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Outcome = ComplianceQpReport::Outcome;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kProblems = 1000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// cond(H) is at most w ‖J‖² / w₀ ≈ 10⁵, so round-off in q̈ and τ is some 10⁻¹¹ of their size.
constexpr double kRoundOff = 1e-9;

PerJoint Unlimited(const RobotModel& m) { return PerJoint::Constant(m.size(), 1e9); }

/// A posture inside the limits, with `margin` of the range at both ends left out.
JointPosition Inside(const RobotModel& m, RandomStates& random, double margin) {
  const VectorXd unit = random.Uniform(1.0);
  JointPosition q = JointPosition::Zero(m.joints());
  for (int i = 0; i < m.size(); ++i) {
    const double lower = std::isfinite(m.joint(i).lower) ? m.joint(i).lower : -3.0;
    const double upper = std::isfinite(m.joint(i).upper) ? m.joint(i).upper : 3.0;
    q(i) = 0.5 * (lower + upper) + 0.5 * (1 - 2 * margin) * (upper - lower) * unit(i);
  }
  return q;
}

MatrixXd RandomPsd(int n, RandomStates& random) {
  const MatrixXd root = MatrixXd::NullaryExpr(n, n, [&] { return random.Uniform(0.7)(0); });
  return root * root.transpose();
}

TEST(ComplianceQp, WithFullComplianceGivesTheTorqueOfAControllerThatIgnoresTheExternalTorque) {
  for (const Arm& arm : Arms()) {
    ComplianceRig rig(arm.model, arm.tool, false);
    RandomStates random(arm.model, 11);
    rig.sim->Set(rig.qp->torque_limit, Unlimited(arm.model));
    rig.SetCompliance(1, 1);
    for (int k = 0; k < kProblems; ++k) {
      rig.SetState(random.q(), random.v());
      rig.Tick(JointTorque::Zero(arm.model.joints()));
      const JointTorque ignorant = rig.torque();
      const JointTorque tau_e = random.tau();
      rig.Tick(tau_e);
      const double size = (rig.d().M * rig.acceleration()).norm() + ignorant.norm() + tau_e.norm();
      ASSERT_EQ(rig.report().outcome, Outcome::Solved);
      ASSERT_LT((rig.torque() - ignorant).norm(), kRoundOff * size) << arm.name << ' ' << k;
    }
  }
}

TEST(ComplianceQp, WithoutComplianceAcceleratesAsIfNothingPushed) {
  for (const Arm& arm : Arms()) {
    ComplianceRig rig(arm.model, arm.tool);
    RandomStates random(arm.model, 12);
    rig.sim->Set(rig.qp->torque_limit, Unlimited(arm.model));
    int damped = 0;
    for (int k = 0; k < kProblems; ++k) {
      rig.SetState(Inside(arm.model, random, 0.0), random.v());
      rig.Tick(JointTorque::Zero(arm.model.joints()));
      const JointAcceleration free = rig.acceleration();
      damped += (rig.report().bound_multiplier.array() != 0).any();
      const JointTorque tau_e = random.tau();
      rig.Tick(tau_e);
      ASSERT_LT(RelativeError(rig.acceleration(), free), kRoundOff) << arm.name << ' ' << k;
      // EC (1) with (8): the pushed arm does what was asked for.
      const JointAcceleration moved = ForwardDynamics(rig.d(), rig.torque(), tau_e);
      ASSERT_LT(RelativeError(moved, free), kRoundOff) << arm.name << ' ' << k;
    }
    EXPECT_GT(damped, 100) << "dampers were to be active as well";
  }
}

TEST(ComplianceQp, ResistsAPushWhereADamperIsActiveEvenWithFullCompliance) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame");
  rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
  rig.SetCompliance(1, 1);
  rig.sim->Set(rig.pose->weight, 1e-9);
  JointPosition q = JointPosition::Zero(m.joints());
  q(1) = m.joint(1).upper - 0.02 * (m.joint(1).upper - m.joint(1).lower);
  rig.SetState(q, JointVelocity::Zero(m.joints()));
  JointTorque push = JointTorque::Zero(m.joints());
  push(1) = 200;
  rig.Tick(push);
  const double upper = rig.sim->Get(rig.damper->bounds).upper(1);
  EXPECT_NEAR(rig.acceleration()(1), upper, kRoundOff * upper);
  EXPECT_NEAR(ForwardDynamics(rig.d(), rig.torque(), push)(1), upper, kRoundOff * 1e3);
}

TEST(ComplianceQp, KeepsTheTorqueInsideItsLimitsWhateverPushes) {
  for (const Arm& arm : Arms()) {
    ComplianceRig rig(arm.model, arm.tool);
    RandomStates random(arm.model, 13);
    const PerJoint limit = 0.5 * arm.model.effort_limit();
    rig.sim->Set(rig.qp->torque_limit, limit);
    int at_limit = 0;
    for (int k = 0; k < kProblems; ++k) {
      rig.SetState(random.q(), 0.5 * random.v());
      rig.SetCompliance(k % 2, k % 3);
      const JointTorque tau_e = 5 * random.tau();
      rig.Tick(tau_e);
      const JointTorque tau = rig.torque();
      ASSERT_TRUE((tau.array().abs() <= limit.array()).all()) << tau.transpose();
      at_limit += (tau.array().abs() == limit.array()).any();
      if (rig.report().outcome == Outcome::Fallback) continue;
      const JointTorque asked = InverseDynamics(rig.d(), rig.acceleration()) - tau_e;  // EC (8)
      const double size = (rig.d().M.cwiseAbs() * rig.acceleration().cwiseAbs()).norm();
      // Limits that gave way leave room for 10⁻⁸ of what they are on.
      const double part = rig.report().outcome == Outcome::Relaxed ? 1e-8 : kRoundOff;
      ASSERT_LT((tau - asked).norm(), part * (size + asked.norm() + tau_e.norm()));
    }
    EXPECT_GT(at_limit, kProblems / 10);
  }
}

TEST(ComplianceQp, CountsAHelpingPushTowardsTheTorqueLimit) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame", false);
  RandomStates random(m, 14);
  int tried = 0;
  for (int k = 0; k < 100; ++k) {
    rig.SetState(random.q(), 0.3 * random.v());
    rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
    rig.Tick(JointTorque::Zero(m.joints()));
    const JointAcceleration free = rig.acceleration();
    const JointTorque tau = rig.torque();
    if (std::abs(tau(1)) < 5) continue;
    ++tried;
    PerJoint limit = Unlimited(m);
    limit(1) = std::abs(tau(1)) - 1;  // 1 N·m short of what the tasks need
    rig.sim->Set(rig.qp->torque_limit, limit);
    JointTorque push = JointTorque::Zero(m.joints());
    push(1) = std::copysign(1.5, tau(1));
    rig.Tick(push);  // EC (10): the environment delivers 1.5 N·m of it
    ASSERT_LT(RelativeError(rig.acceleration(), free), kRoundOff);
    rig.Tick(-push);
    ASSERT_GT(RelativeError(rig.acceleration(), free), 1e-4);
    ASSERT_NEAR(std::abs(rig.torque()(1)), limit(1), kRoundOff * limit(1));
  }
  EXPECT_GT(tried, 50);
}

/// ‖∇f − Σ multipliers of active limits‖ relative to ∇f's terms; HUGE_VAL if a multiplier pulls.
double Stationarity(ComplianceRig& rig, const JointTorque& tau_e, const PerJoint& limit,
                    int& active_limits) {
  const int n = rig.model.size();
  MatrixXd H = MatrixXd::Zero(n, n);
  VectorXd g = VectorXd::Zero(n);
  for (const Objective& t :
       {rig.sim->Get(rig.pose->objective), rig.sim->Get(rig.posture->objective)}) {
    const MatrixXd A = t.A;
    H += t.weight * A.transpose() * A;
    g -= t.weight * A.transpose() * t.b;
  }
  const AccelerationBounds& bounds = rig.sim->Get(rig.damper->bounds);
  const VectorXd x = rig.acceleration();
  const VectorXd tau = InverseDynamics(rig.d(), rig.acceleration()) - tau_e;
  const MatrixXd M = rig.d().M;
  std::vector<VectorXd> outward;
  for (int i = 0; i < n; ++i) {
    const double near = 1e-9 * (1 + x.cwiseAbs().maxCoeff());
    if (x(i) > bounds.upper(i) - near) outward.push_back(VectorXd::Unit(n, i));
    if (x(i) < bounds.lower(i) + near) outward.push_back(-VectorXd::Unit(n, i));
    if (tau(i) > limit(i) * (1 - 1e-9)) outward.push_back(M.row(i));
    if (tau(i) < -limit(i) * (1 - 1e-9)) outward.push_back(-M.row(i));
  }
  const VectorXd descent = -(H * x + g);  // = Σ λ outward, λ ≥ 0
  const double size = (H.cwiseAbs() * x.cwiseAbs() + g.cwiseAbs()).maxCoeff();
  active_limits += static_cast<int>(outward.size());
  if (outward.empty()) return descent.cwiseAbs().maxCoeff() / size;
  MatrixXd N(n, static_cast<Eigen::Index>(outward.size()));
  for (std::size_t i = 0; i < outward.size(); ++i) N.col(static_cast<Eigen::Index>(i)) = outward[i];
  const VectorXd lambda = N.colPivHouseholderQr().solve(descent);
  if (lambda.minCoeff() < -1e-9 * size) return HUGE_VAL;
  return (descent - N * lambda).cwiseAbs().maxCoeff() / size;
}

TEST(ComplianceQp, AnswersAreStationaryAndFeasible) {
  for (const Arm& arm : Arms()) {
    const int n = arm.model.size();
    ComplianceRig rig(arm.model, arm.tool);
    RandomStates random(arm.model, 15);
    const PerJoint limit = 0.6 * arm.model.effort_limit();
    rig.sim->Set(rig.qp->torque_limit, limit);
    int solved = 0, active = 0;
    for (int k = 0; k < kProblems; ++k) {
      rig.SetState(Inside(arm.model, random, 0.02), 0.7 * random.v());
      rig.sim->Set(rig.pose->compliance, RandomPsd(6, random));
      rig.sim->Set(rig.posture->compliance, RandomPsd(n, random));
      const JointTorque tau_e = random.tau();
      rig.Tick(tau_e);
      if (rig.report().outcome != Outcome::Solved) continue;
      ++solved;
      ASSERT_LT(Stationarity(rig, tau_e, limit, active), 1e-9) << arm.name << ' ' << k;
      const AccelerationBounds& bounds = rig.sim->Get(rig.damper->bounds);
      const PerJoint a = rig.acceleration();
      const double slack = 1e-9 * (1 + a.cwiseAbs().maxCoeff());
      ASSERT_TRUE((a.array() <= bounds.upper.array() + slack).all());
      ASSERT_TRUE((a.array() >= bounds.lower.array() - slack).all());
      ASSERT_EQ(rig.report().bound_slack, PerJoint::Zero(n));
    }
    EXPECT_GT(solved, kProblems / 2) << arm.name;
    EXPECT_GT(active, solved) << arm.name << ": limits were to be active";
  }
}

/// How far an acceleration is outside of the bounds, squared.
double Excess(const PerJoint& a, const AccelerationBounds& bounds) {
  return (bounds.lower - a).cwiseMax(a - bounds.upper).cwiseMax(0).squaredNorm();
}

TEST(ComplianceQp, RelaxesBoundsThatContradictTorqueLimitsByNoMoreThanItMust) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame");
  RandomStates random(m, 16);
  const PerJoint limit = 0.5 * m.effort_limit();
  rig.sim->Set(rig.qp->torque_limit, limit);
  int relaxed = 0;
  for (int k = 0; k < 200; ++k) {
    rig.SetState(Inside(m, random, 0.02), 2.5 * random.v());  // much too fast to brake in time
    const JointTorque tau_e = random.tau();
    rig.Tick(tau_e);
    const ComplianceQpReport report = rig.report();
    ASSERT_NE(report.outcome, Outcome::Fallback);
    if (report.outcome != Outcome::Relaxed) continue;
    ++relaxed;
    const AccelerationBounds bounds = rig.sim->Get(rig.damper->bounds);
    ASSERT_EQ(report.relaxed_priority, 1);
    ASSERT_TRUE((rig.torque().array().abs() <= limit.array()).all());
    const double excess = Excess(rig.acceleration(), bounds);
    ASSERT_NEAR(report.bound_slack.squaredNorm(), excess, 1e-12 * excess);
    for (int other = 0; other < 100; ++other) {
      JointTorque tau = limit.cwiseProduct(random.Uniform(1.0));
      if (other == 0) tau = rig.torque() * (1 - 1e-3);
      const JointAcceleration a = ForwardDynamics(rig.d(), tau, tau_e);
      ASSERT_GT(Excess(a, bounds), excess * (1 - 1e-3));  // a slack weighs 10⁶
    }
  }
  EXPECT_GT(relaxed, 50);
}

TEST(ComplianceQp, MeetsContradictingBoundsHalfWay) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame");
  rig.sim->Set(rig.qp->torque_limit, Unlimited(m));
  JointPosition q = JointPosition::Zero(m.joints());
  q(3) = m.joint(3).upper + 0.6;
  rig.SetState(q, JointVelocity::Zero(m.joints()));
  rig.Tick(JointTorque::Zero(m.joints()));
  const AccelerationBounds& bounds = rig.sim->Get(rig.damper->bounds);
  const double gap = bounds.lower(3) - bounds.upper(3);
  ASSERT_GT(gap, 0);
  EXPECT_EQ(rig.report().outcome, Outcome::Relaxed);
  EXPECT_EQ(rig.report().status, QpStatus::Infeasible);
  EXPECT_EQ(rig.report().relaxed_priority, 1);
  EXPECT_NEAR(rig.report().bound_slack(3), gap / 2, 1e-5 * gap);  // a slack weighs 10⁶
  EXPECT_EQ((rig.report().bound_slack.array() > 1e-9).count(), 1);
}

TEST(ComplianceQp, FallsBackToDampedGravityCompensationWithoutASolution) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame");
  RandomStates random(m, 17);
  const JointVelocity v = 0.5 * random.v();
  rig.SetState(Inside(m, random, 0.1), v);
  JointTorque broken = JointTorque::Zero(m.joints());
  broken(2) = kNaN;
  rig.Tick(broken);
  EXPECT_EQ(rig.report().outcome, Outcome::Fallback);
  EXPECT_EQ(rig.report().status, QpStatus::InvalidData);
  const JointAcceleration braking =
      ForwardDynamics(rig.d(), rig.torque(), JointTorque::Zero(m.joints()));
  EXPECT_EQ(rig.acceleration(), braking);
  const PerJoint limit = m.effort_limit();
  const PerJoint expected = (rig.d().gravity - 5 * v).cwiseMin(limit).cwiseMax(-limit);
  EXPECT_LT(RelativeError(rig.torque(), expected), 1e-15);

  rig.Tick(JointTorque::Zero(m.joints()));
  EXPECT_EQ(rig.report().outcome, Outcome::Solved) << "the next good tick is a good one";
}

TEST(ComplianceQp, CommandsFiniteTorquesInsideTheLimitsWhateverIsNoNumber) {
  const RobotModel m = Gen3();
  const PerJoint limit = m.effort_limit();
  RandomStates random(m, 18);
  for (const double bad : {kNaN, HUGE_VAL, -HUGE_VAL})
    for (int where = 0; where < 6; ++where) {
      ComplianceRig rig(m, "tool_frame");
      JointPosition q = random.q();
      JointVelocity v = random.v();
      JointTorque tau_e = random.tau();
      JointTorque torque_limit = limit;
      if (where == 0) q(1) = bad;
      if (where == 1) v(1) = bad;
      if (where == 2) tau_e(1) = bad;
      if (where == 3) torque_limit(1) = std::isnan(bad) ? bad : limit(1);
      if (where == 4) rig.sim->Set(rig.pose->weight, bad);
      if (where == 5) rig.sim->Set(rig.posture->stiffness, PerJoint::Constant(m.size(), bad));
      rig.SetState(q, v);
      rig.sim->Set(rig.qp->torque_limit, torque_limit);
      rig.Tick(tau_e);
      EXPECT_TRUE(rig.torque().allFinite()) << bad << " at " << where;
      EXPECT_TRUE((rig.torque().array().abs() <= limit.array()).all()) << bad << " at " << where;
    }
}

TEST(ComplianceQp, DoesNotLoseABoundThatIsNoNumber) {
  const RobotModel m = Gen3();
  const int n = m.size();
  const AccelerationBounds wide{PerJoint::Constant(n, -10), PerJoint::Constant(n, 10)};
  AccelerationBounds broken = wide;
  broken.upper(4) = kNaN;
  for (const bool first : {true, false}) {
    DiagramBuilder b;
    auto& q = b.Add<Constant<JointPosition>>(
        "q", {.space = m.joints(), .value = JointPosition::Zero(m.joints())});
    auto& v = b.Add<Constant<JointVelocity>>(
        "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m});
    auto& posture = b.Add<PostureTask>("posture", {.model = m,
                                                   .target = JointPosition::Zero(m.joints()),
                                                   .stiffness = PerJoint::Zero(n),
                                                   .damping = PerJoint::Zero(n)});
    auto& one = b.Add<Constant<AccelerationBounds>>(
        "one", {.space = m.joints(), .value = first ? broken : wide});
    auto& two = b.Add<Constant<AccelerationBounds>>(
        "two", {.space = m.joints(), .value = first ? wide : broken});
    auto& qp = b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms});
    b.Connect(q.y, dynamics.position);
    b.Connect(v.y, dynamics.velocity);
    b.Connect(dynamics.dynamics, posture.dynamics);
    b.Connect(dynamics.dynamics, qp.dynamics);
    b.Connect(posture.objective, qp.objectives);
    b.Connect(one.y, qp.bounds);
    b.Connect(two.y, qp.bounds);
    const Diagram diagram = b.Build();
    Simulator sim(diagram);
    sim.AdvanceThroughTick();
    EXPECT_EQ(sim.Get(qp.report).status, QpStatus::InvalidData) << "broken first: " << first;
  }
}

TEST(ComplianceQp, RepeatsARestoredRunBitForBitWithoutHeap) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame");
  rig.sim->Set(rig.qp->torque_limit, 0.4 * m.effort_limit());
  std::vector<JointTorque> torques;
  const auto run = [&](int ticks) {
    RandomStates random(m, 19);
    torques.assign(static_cast<std::size_t>(ticks), JointTorque::Zero(m.joints()));
    long allocations = 0;
    for (JointTorque& tau : torques) {
      const JointPosition q = Inside(m, random, 0.0);
      const JointVelocity v = 1.5 * random.v();
      const JointTorque tau_e = random.tau();
      const long before = Allocations();
      rig.SetState(q, v);
      rig.Tick(tau_e);
      tau = rig.torque();
      allocations += Allocations() - before;
    }
    return allocations;
  };
  run(37);  // leaves an active set to start from
  const Context snapshot = rig.sim->Snapshot();
  EXPECT_EQ(run(300), 0);
  const std::vector<JointTorque> first = torques;
  rig.sim->Restore(snapshot);
  run(300);
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(torques[i], first[i]) << i;
}

TEST(ComplianceQp, RefusesAFallbackDampingThatIsNone) {
  const RobotModel m = Gen3();
  EXPECT_EQ(ErrorOf([&] { ComplianceQp({.model = m, .period = 1ms, .fallback_damping = -1}); }),
            "fallback_damping must be finite and >= 0, got -1");
}

}  // namespace
}  // namespace pliant
