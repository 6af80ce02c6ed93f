#include "pliant/controllers/compliance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <string>

#include "pliant/controllers/compliance_ramp.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/compliance_rig.h"
#include "pliant/tests/controllers/task_kinds.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Ramp = ComplianceRamp<TaskMatrix>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(RequireCompliance, SaysWhatIsWrong) {
  Eigen::Matrix3d gamma = Eigen::Matrix3d::Identity();
  const auto error = [&] { return ErrorOf([&] { RequireCompliance(gamma, 3); }); };
  EXPECT_EQ(error(), "no error");
  gamma = Eigen::Vector3d(1, 2, 3) * Eigen::RowVector3d(1, 2, 3);  // of rank 1
  EXPECT_EQ(error(), "no error");
  gamma(0, 1) += 0.5;
  EXPECT_EQ(error(), "compliance must be symmetric: |Γ − Γᵀ| must be 0, got 0.5");
  gamma = Eigen::Vector3d(1, -0.25, 1).asDiagonal();
  EXPECT_EQ(error(),
            "compliance must be positive semi-definite: every eigenvalue must be >= 0, got -0.25");
  gamma(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error(), "compliance must be finite");
}

TEST(IsCompliance, AgreesWithRequireCompliance) {
  RandomStates random(Gen3(), 41);
  int are = 0;
  for (int k = 0; k < 1000; ++k) {
    const int n = 1 + k % 6;
    Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.Uniform(1)(0); });
    if (k % 2 == 0) root.col(0).setZero();  // on the edge
    Eigen::MatrixXd gamma = root * root.transpose();
    if (k % 3 == 0) gamma -= 1e-3 * Eigen::MatrixXd::Identity(n, n);
    if (k % 5 == 0) gamma(0, n - 1) += 1e-3;
    const bool is = IsCompliance(gamma, n);
    ASSERT_EQ(is, ErrorOf([&] { RequireCompliance(gamma, n); }) == "no error") << gamma;
    are += is;
  }
  EXPECT_GT(are, 200);
  EXPECT_LT(are, 800);
  EXPECT_FALSE(IsCompliance(Eigen::Matrix3d::Identity(), 2));
  EXPECT_FALSE(IsCompliance(Eigen::Matrix3d::Constant(kNaN), 3));
}

TEST(InAxes, TurnsTheDirectionsOfACompliance) {
  RandomStates random(Gen3(), 42);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const TaskMatrix gamma = TaskVector::LinSpaced(6, 1, 6).asDiagonal();
  const TaskMatrix turned = InAxes(R, gamma);
  for (int i = 0; i < 6; ++i) {
    TaskVector direction = TaskVector::Zero(6);
    direction.segment<3>(i < 3 ? 0 : 3) = R.col(i % 3);
    EXPECT_LT((turned * direction - (i + 1) * direction).norm(), 1e-14);
  }
}

TEST(FrameTaskOptions, AreReadFromAFileAndWrittenBack) {
  const auto filled = [](const std::string& text) {
    FrameTask::Options o;
    ParameterFile::ReadText(text).Fill(o);
    return o;
  };
  const FrameTask::Options o = filled(
      "{frame: tool_frame, relative_to: forearm_link, part: position, axes: frame, "
      "basis: [0, 0.6, 0.8], stiffness: [100], damping: [20], compliance: 0.5, mobility: "
      "[[0.25]]}");
  EXPECT_EQ(o.relative_to, "forearm_link");
  EXPECT_EQ(o.part, FrameTask::Part::Position);
  EXPECT_EQ(o.axes, FrameTask::Axes::Frame);
  FrameTask::Options with_model = o;
  with_model.model = Gen3();
  BlockTester<FrameTask> t(with_model);
  EXPECT_EQ(t.Get(t->compliance), TaskMatrix::Constant(1, 1, 0.5));
  EXPECT_EQ(t.Get(t->mobility), TaskMatrix::Constant(1, 1, 0.25));
  const std::string text = ParametersText(o);
  EXPECT_EQ(ParametersText(filled(text)), text);
  for (const char* gamma : {"0.5", "[0.1, 0.2, 0.3]", "[[1, 0, 0], [0, 1, 0], [0, 0, 2]]"}) {
    FrameTask::Options one = filled("{frame: tool_frame, compliance: " + std::string(gamma) + "}");
    EXPECT_NE(ParametersText(one).find("compliance: " + std::string(gamma) + "\n"),
              std::string::npos)
        << ParametersText(one);
    EXPECT_NO_THROW(ComplianceOf<TaskMatrix>(one.compliance, 3));
  }
  EXPECT_EQ(ErrorOf([&] { filled("{part: position}"); }), "YAML:1:1: 'frame' is missing");
}

TEST(FrameTask, NeedsNoHeapInAnyOfItsForms) {
  for (const TaskKind& kind : Kinds()) {
    BlockTester<FrameTask> t(kind.options);
    RandomStates random(kind.options.model, 44);
    RobotDynamics d(kind.options.model);
    ComputeDynamics(kind.options.model, random.q(), random.v(), d);
    const Eigen::Index rows = kind.options.stiffness.size();
    t.Set(t->dynamics, d);
    t.Set(t->external_acceleration, random.a());
    t.Get(t->objective);
    t.Set(t->mobility, TaskMatrix::Identity(rows, rows));
    t.Set(t->dynamics, d);
    const long before = Allocations();
    t.Get(t->objective);
    ASSERT_EQ(Allocations() - before, 0) << kind.name;
  }
}

TEST(ComplianceRamp, GoesStraightFromOneComplianceToAnotherInItsTime) {
  BlockTester<Ramp> t(Ramp::Options{
      .size = 3, .start = TaskMatrix::Constant(1, 1, 1), .time = 100ms, .period = 1ms});
  t.Tick();
  EXPECT_EQ(t.Get(t->compliance), TaskMatrix::Identity(3, 3));
  const Eigen::Vector3d d(1, 2, -1);
  const TaskMatrix goal = d * d.transpose();
  t.Set(t->wanted, goal);
  for (int k = 1; k <= 100; ++k) {
    t.Tick();
    const TaskMatrix expected = (1 - 0.01 * k) * TaskMatrix::Identity(3, 3) + 0.01 * k * goal;
    ASSERT_LT((t.Get(t->compliance) - expected).norm(), 1e-14) << k;
    ASSERT_TRUE(IsCompliance(t.Get(t->compliance), 3));
  }
  EXPECT_EQ(t.Get(t->compliance), goal) << "arrives to the bit";
  t.Tick();
  EXPECT_EQ(t.Get(t->compliance), goal);
  EXPECT_FALSE(t.Get(t->refused));
}

TEST(ComplianceRamp, RefusesWhatIsNoComplianceAndKeepsOnToTheLastThatWas) {
  BlockTester<Ramp> t(Ramp::Options{.size = 3, .time = 10ms, .period = 1ms});
  const TaskMatrix good = 2 * TaskMatrix::Identity(3, 3);
  TaskMatrix skew = good, indefinite = good, none = good;
  skew(0, 1) = 0.1;
  indefinite(2, 2) = -1e-3;
  none(1, 1) = kNaN;
  for (const TaskMatrix& bad : {skew, indefinite, none}) {
    t.Set(t->wanted, TaskMatrix::Zero(3, 3));
    for (int k = 0; k < 11; ++k) t.Tick();
    t.Set(t->wanted, good);
    t.Tick();
    t.Set(t->wanted, bad);
    const long before = Allocations();
    for (int k = 1; k < 10; ++k) {
      t.Tick();
      ASSERT_TRUE(t.Get(t->refused));
      ASSERT_LT((t.Get(t->compliance) - 0.1 * (k + 1) * good).norm(), 1e-14);
    }
    EXPECT_EQ(Allocations() - before, 0);
    t.Tick();
    EXPECT_EQ(t.Get(t->compliance), good);
    t.Set(t->wanted, good);
    t.Tick();
    EXPECT_FALSE(t.Get(t->refused));
    EXPECT_EQ(t.Get(t->compliance), good);
  }
}

TEST(ComplianceRamp, LeadsTheMatrixOfAPostureToo) {
  using JointRamp = ComplianceRamp<JointMatrix>;
  BlockTester<JointRamp> t(JointRamp::Options{.size = 7, .time = 4ms, .period = 1ms});
  t.Set(t->wanted, JointMatrix::Identity(7, 7));
  t.Tick();
  const long before = Allocations();
  t.Tick();
  EXPECT_EQ(t.Get(t->compliance), 0.5 * JointMatrix::Identity(7, 7));
  t.Set(t->wanted, 3 * JointMatrix::Identity(7, 7));
  t.Tick();
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(ComplianceRamp, RefusesOptionsThatMakeNoRamp) {
  const auto error = [](const Ramp::Options& o) { return ErrorOf([&] { Ramp ramp(o); }); };
  EXPECT_EQ(error({.size = 7, .time = 1s, .period = 1ms}), "size must be from 1 to 6, got 7");
  EXPECT_EQ(error({.size = 3, .time = 1ms, .period = 2ms}),
            "time must be at least the period, 2 ms, got 1 ms");
  EXPECT_EQ(error({.size = 3, .start = -TaskMatrix::Identity(3, 3), .time = 1s, .period = 1ms}),
            "start must be positive semi-definite: every eigenvalue must be >= 0, got -1");
}

// With no limit active q̈_d = H⁻¹ (w Jᵀ Γ J q̈_e + what does not depend on Γ), so a tick changes the
// torque by at most ‖M H⁻¹ w Jᵀ‖ ‖Γ_b − Γ_a‖ (h/T) ‖J q̈_e‖.
TEST(ComplianceRamp, BoundsTheChangeOfTorquePerTick) {
  const RobotModel m = Gen3();
  ComplianceRig rig(m, "tool_frame", false);
  rig.sim->Set(rig.qp->torque_limit, PerJoint::Constant(m.size(), 1e9));
  RandomStates random(m, 43);
  BlockTester<Ramp> ramp(Ramp::Options{.size = 6, .time = 50ms, .period = 1ms});
  ramp.Tick();
  const Eigen::MatrixXd root =
      Eigen::MatrixXd::NullaryExpr(6, 6, [&] { return random.Uniform(1)(0); });
  const TaskMatrix goal = root * root.transpose();
  rig.SetState(random.q(), random.v());
  const JointTorque tau_e = random.tau();
  rig.Tick(tau_e);
  JointTorque last = rig.torque();
  const JointTorque first = last;

  const Eigen::MatrixXd J = rig.sim->Get(rig.pose->objective).A, M = rig.d().M;
  const double w = rig.sim->Get(rig.pose->objective).weight;
  const Eigen::MatrixXd H = w * J.transpose() * J + Eigen::MatrixXd::Identity(m.size(), m.size());
  const double gain = (M * H.inverse() * w * J.transpose()).operatorNorm();
  const double bound = gain * Eigen::MatrixXd(goal).operatorNorm() / 50 *
                       (J * rig.sim->Get(rig.external->acceleration)).norm();
  ramp.Set(ramp->wanted, goal);
  double most = 0;
  for (int k = 0; k < 60; ++k) {
    ramp.Tick();
    rig.sim->Set(rig.pose->compliance, ramp.Get(ramp->compliance));
    rig.Tick(tau_e);
    const double change = (rig.torque() - last).norm();
    ASSERT_LT(change, bound * (1 + 1e-9) + 1e-9 * last.norm()) << k;
    most = std::max(most, change);
    last = rig.torque();
  }
  EXPECT_GT(most, 0.01 * bound);
  EXPECT_GT((last - first).norm(), 40 * most) << "all at once it would have been this";
}

}  // namespace
}  // namespace pliant
