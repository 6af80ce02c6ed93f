#include "pliant/controllers/frame_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using Part = FrameTask::Part;

constexpr double kPi = std::numbers::pi;

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m, {"tool_frame"});
  ComputeDynamics(m, q, v, d);
  return d;
}

FrameTask::Options Options(const RobotModel& m, Part part = Part::Pose) {
  const int rows = part == Part::Pose ? 6 : 3;
  return {.model = m,
          .frame = "tool_frame",
          .part = part,
          .stiffness = TaskVector::LinSpaced(rows, 100, 400),
          .damping = TaskVector::LinSpaced(rows, 20, 40),
          .weight = 3};
}

/// The rotation vector of R as quaternions give it.
Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond r(R);
  const double s = r.vec().norm();
  return s == 0 ? Vector3d(Vector3d::Zero()) : Vector3d(2 * std::atan2(s, r.w()) / s * r.vec());
}

TEST(FrameTask, WantsWhatTheFormulaSays) {
  const RobotModel m = Gen3();
  RandomStates random(m, 21);
  for (const Part part : {Part::Pose, Part::Orientation, Part::Position}) {
    const int first = part == Part::Position ? 3 : 0;
    const int rows = part == Part::Pose ? 6 : 3;
    const FrameTask::Options o = Options(m, part);
    BlockTester<FrameTask> t(o);
    for (int k = 0; k < 100; ++k) {
      const RobotDynamics d = At(m, random.q(), random.v());
      const FrameDynamics& f = d.frame[0];
      const JointAcceleration pushed = random.a();
      const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
      const Pose target{
          random.Uniform(1).head<3>(),
          AngleAxisd(2 * random.Uniform(1)(0), axis).toRotationMatrix() * f.pose.rotation};
      const Twist twist = random.Uniform(1).head<6>(), feedforward = random.Uniform(5).head<6>();
      const Eigen::MatrixXd root =
          Eigen::MatrixXd::NullaryExpr(rows, rows, [&] { return random.Uniform(1)(0); });
      const TaskMatrix gamma = root * root.transpose();
      t.Set(t->dynamics, d);
      t.Set(t->external_acceleration, pushed);
      t.Set(t->target, target);
      t.Set(t->target_twist, twist);
      t.Set(t->target_acceleration, feedforward);
      t.Set(t->compliance, gamma);

      Vector6 error;
      error << Log(f.pose.rotation * target.rotation.transpose()),
          f.pose.position - target.position;
      const Eigen::VectorXd e = error.segment(first, rows);
      const Eigen::VectorXd edot = (f.J * d.v - twist).segment(first, rows);
      const Eigen::MatrixXd J = f.J.middleRows(first, rows);
      const Eigen::VectorXd wanted = -o.damping.cwiseProduct(edot) - o.stiffness.cwiseProduct(e);
      // ‖J q̈ + J̇ q̇ − ẍ° − ë* − Γ J q̈_e‖, EC (4) and (9)
      const Eigen::VectorXd b = feedforward.segment(first, rows) - f.Jdot_v.segment(first, rows) +
                                wanted + gamma * (J * pushed);
      EXPECT_LT(RelativeError(t.Get(t->error), e), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->error_rate), edot), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).A, J), 1e-13);
      EXPECT_LT(RelativeError(t.Get(t->objective).b, b), 1e-13);
      EXPECT_EQ(t.Get(t->objective).weight, 3);
    }
  }
}

TEST(FrameTask, PredictsTheAccelerationOfTheErrorAlongAMotion) {
  const RobotModel m = Gen3();
  RandomStates random(m, 22);
  BlockTester<FrameTask> t(Options(m));
  const double h = 1e-4;
  for (int k = 0; k < 50; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const Twist feedforward = random.Uniform(3).head<6>();
    const auto rate = [&](double s) {  // ė along q + s q̇ + s²/2 q̈, with V° = s V̇°
      t.Set(t->dynamics, At(m, q + s * v + 0.5 * s * s * a, v + s * a));
      t.Set(t->target_twist, s * feedforward);
      return Eigen::VectorXd(t.Get(t->error_rate));
    };
    const Eigen::VectorXd measured = (rate(h) - rate(-h)) / (2 * h);
    rate(0);
    t.Set(t->target_acceleration, feedforward);
    const Objective& o = t.Get(t->objective);
    // A q̈ − b = ë − ë*, so with e and ė of this instant:
    const Eigen::VectorXd ideal =
        -Options(m).damping.cwiseProduct(Eigen::VectorXd(t.Get(t->error_rate))) -
        Options(m).stiffness.cwiseProduct(Eigen::VectorXd(t.Get(t->error)));
    EXPECT_LT(RelativeError(o.A * a - o.b + ideal, measured), 1e-5);  // second order in h
  }
}

TEST(FrameTask, TurnsTheShortWayBack) {
  const RobotModel m = Gen3();
  RandomStates random(m, 23);
  BlockTester<FrameTask> t(Options(m, Part::Orientation));
  const RobotDynamics d = At(m, random.q(), random.v());
  t.Set(t->dynamics, d);
  for (const double angle : {0.0, 1e-300, 1e-12, 1e-7, 1e-3, 1.0, 3.0, kPi - 1e-6, kPi - 1e-9})
    for (int k = 0; k < 20; ++k) {
      const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
      // R = exp(angle axis) R°
      t.Set(t->target, Pose{d.frame[0].pose.position, AngleAxisd(-angle, axis).toRotationMatrix() *
                                                          d.frame[0].pose.rotation});
      const Vector3d e = t.Get(t->error);
      // Round-off of R, and near π of the half angle: a few ε in all.
      EXPECT_LT((e - angle * axis).norm(), 5e-15) << angle;
    }
  // At half a turn both ways are as short.
  t.Set(t->target,
        Pose{d.frame[0].pose.position,
             AngleAxisd(kPi, Vector3d::UnitY()).toRotationMatrix() * d.frame[0].pose.rotation});
  EXPECT_NEAR(std::abs(t.Get(t->error)(1)), kPi, 1e-14);
  t.Set(t->target,
        Pose{d.frame[0].pose.position, AngleAxisd(kPi + 0.1, Vector3d::UnitY()).toRotationMatrix() *
                                           d.frame[0].pose.rotation});
  EXPECT_NEAR(t.Get(t->error)(1), kPi - 0.1, 1e-14);
}

TEST(FrameTask, ErrorTimesRateIsTheRateOfHalfTheSquaredErrorAtAnyError) {
  const RobotModel m = Gen3();
  RandomStates random(m, 24);
  BlockTester<FrameTask> t(Options(m));
  const double h = 1e-5;
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const Vector3d axis = Vector3d(random.Uniform(1).head<3>()).normalized();
    const Twist twist = random.Uniform(1).head<6>();
    const Pose target{random.Uniform(1).head<3>(), AngleAxisd(2.5, axis).toRotationMatrix() *
                                                       At(m, q, v).frame[0].pose.rotation};
    const auto energy = [&](double s) {
      const Vector3d turn = s * twist.head<3>();
      t.Set(t->dynamics, At(m, q + s * v, v));
      t.Set(t->target,
            Pose{target.position + s * twist.tail<3>(),
                 AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * target.rotation});
      return 0.5 * Eigen::VectorXd(t.Get(t->error)).squaredNorm();
    };
    const double measured = (energy(h) - energy(-h)) / (2 * h);
    t.Set(t->dynamics, At(m, q, v));
    t.Set(t->target, target);
    t.Set(t->target_twist, twist);
    EXPECT_NEAR(t.Get(t->error).dot(t.Get(t->error_rate)), measured, 1e-7);  // h² and ε/h
  }
}

TEST(FrameTask, GivesWayAlongTheAxesOfItsCompliance) {
  const RobotModel m = Gen3();
  RandomStates random(m, 25);
  FrameTask::Options o = Options(m, Part::Position);
  const Vector3d axis = Vector3d(1, 2, -0.5).normalized();
  o.compliance = 0.7 * axis * axis.transpose();
  BlockTester<FrameTask> t(o);
  for (int k = 0; k < 20; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    t.Set(t->dynamics, d);
    t.Set(t->external_acceleration, JointAcceleration::Zero(m.joints()));
    const Vector3d still = t.Get(t->objective).b;
    const JointAcceleration pushed = random.a();
    t.Set(t->external_acceleration, pushed);
    const Vector3d moved = Vector3d(t.Get(t->objective).b) - still;
    const Vector3d frame = d.frame[0].J.bottomRows<3>() * pushed;
    EXPECT_LT((moved - 0.7 * axis.dot(frame) * axis).norm(), 1e-12);
  }
}

TEST(FrameTask, FindsAnyLink) {
  const RobotModel m = Gen3();
  RandomStates random(m, 26);
  FrameTask::Options o = Options(m);
  o.frame = "forearm_link";
  BlockTester<FrameTask> t(o);
  const RobotDynamics d = At(m, random.q(), random.v());  // which asked for the tool's frame only
  t.Set(t->dynamics, d);
  const int forearm = m.link_index("forearm_link");
  EXPECT_EQ(t.Get(t->frame).pose.position, LinkPose(m, d, forearm).position);
  EXPECT_EQ(t.Get(t->objective).A, PointDynamics(m, d, forearm, {0, 0, 0}).J);
}

TEST(FrameTask, RefusesOptionsThatMakeNoTask) {
  const RobotModel m = Gen3();
  const auto error = [&](auto change) {
    FrameTask::Options o = Options(m, Part::Position);
    change(o);
    return ErrorOf([&] { FrameTask task(o); });
  };
  using O = FrameTask::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness = TaskVector(); }), "stiffness has 3 elements, got 0");
  EXPECT_EQ(error([](O& o) { o.damping(1) = -1; }), "damping[y] must be >= 0 1/s, got -1");
  EXPECT_EQ(error([](O& o) { o.weight = 0; }), "weight must be finite and > 0, got 0");
  EXPECT_THAT(error([](O& o) { o.frame = "tool_fram"; }), testing::HasSubstr("tool_frame"));
  EXPECT_THAT(error([](O& o) { o.target.rotation(0, 0) = 2; }),
              testing::HasSubstr("target rotation must be a rotation"));
  EXPECT_THAT(error([](O& o) { o.target.rotation(0, 0) = -1; }),
              testing::HasSubstr("target rotation must be a rotation"));
  EXPECT_EQ(error([](O& o) { o.compliance = TaskMatrix::Identity(6, 6); }),
            "compliance must be 3 x 3, got 6 x 6");
}

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

}  // namespace
}  // namespace pliant
