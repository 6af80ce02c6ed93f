#include "pliant/controllers/posture_task.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

PostureTask::Options Options(const RobotModel& m) {
  return {.model = m,
          .target = JointPosition::Zero(m.joints()),
          .stiffness = PerJoint::LinSpaced(m.size(), 1, 7),
          .damping = PerJoint::LinSpaced(m.size(), 5, 11),
          .weight = 2};
}

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

TEST(PostureTask, WantsWhatTheFormulaSays) {
  const RobotModel m = Lwr();  // no joint of it turns for ever
  const int n = m.size();
  RandomStates random(m, 31);
  const PostureTask::Options o = Options(m);
  BlockTester<PostureTask> t(o);
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q(), target = random.q();
    const JointVelocity v = random.v(), target_velocity = random.v();
    const JointAcceleration feedforward = random.a(), pushed = random.a();
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.Uniform(1)(0); });
    const JointMatrix gamma = root * root.transpose();
    t.Set(t->dynamics, At(m, q, v));
    t.Set(t->external_acceleration, pushed);
    t.Set(t->target, target);
    t.Set(t->target_velocity, target_velocity);
    t.Set(t->target_acceleration, feedforward);
    t.Set(t->compliance, gamma);
    const Eigen::VectorXd wanted = Eigen::VectorXd(feedforward) -
                                   o.damping.cwiseProduct(v - target_velocity) -
                                   o.stiffness.cwiseProduct(q - target);
    EXPECT_LT(RelativeError(t.Get(t->objective).b, wanted + gamma * pushed), 1e-13);
    EXPECT_EQ(t.Get(t->objective).A, Eigen::MatrixXd::Identity(n, n));
    EXPECT_EQ(t.Get(t->objective).weight, 2);
  }
}

TEST(PostureTask, ComparesContinuousJointsTheShortWayRound) {
  const RobotModel m = Gen3();  // joints 1, 3, 5, 7 turn for ever
  BlockTester<PostureTask> t(Options(m));
  JointPosition q = JointPosition::Zero(m.joints());
  q(0) = 3 * kTurn + 0.2;
  q(1) = 2.2;
  q(2) = kTurn - 0.3;
  q(6) = -0.75 * kTurn;
  t.Set(t->dynamics, At(m, q, JointVelocity::Zero(m.joints())));
  const JointPosition e = t.Get(t->error);
  EXPECT_NEAR(e(0), 0.2, 1e-14);
  EXPECT_EQ(e(1), 2.2);
  EXPECT_NEAR(e(2), -0.3, 1e-14);
  EXPECT_NEAR(e(6), 0.25 * kTurn, 1e-14);
}

TEST(PostureTask, RefusesOptionsThatMakeNoTask) {
  const RobotModel m = Gen3();
  const auto error = [&](auto change) {
    PostureTask::Options o = Options(m);
    change(o);
    return ErrorOf([&] { PostureTask task(o); });
  };
  using O = PostureTask::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness = PerJoint::Ones(3); }),
            "stiffness has an element for each of the 7 joints, got 3");
  EXPECT_EQ(error([](O& o) { o.damping = PerJoint::Constant(7, -1); }),
            "damping[joint_1] must be >= 0 1/s, got -1");
  EXPECT_EQ(error([](O& o) { o.weight = -2; }), "weight must be finite and > 0, got -2");
  EXPECT_EQ(error([](O& o) { o.compliance = JointMatrix::Identity(6, 6); }),
            "compliance must be 7 x 7, got 6 x 6");
}

}  // namespace
}  // namespace pliant
