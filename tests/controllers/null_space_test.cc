#include "pliant/controllers/null_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "pliant/controllers/null_space_impedance.h"
#include "pliant/controllers/null_space_reaction.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const JointPosition kStart{0, 2 * std::numbers::pi / 9,  0, -std::numbers::pi / 2,
                           0, 5 * std::numbers::pi / 18, 0};

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m, {"end_effector_link"});
  ComputeDynamics(m, q, v, d);
  return d;
}

NullSpace SpaceOf(const FrameDynamics& tool, double damped_below = 0.05) {
  BlockTester<NullSpaceProjector> t(
      NullSpaceProjector::Options{.joints = Lwr().joints(), .damped_below = damped_below});
  t.Set(t->frame, tool);
  return t.Get(t->null_space);
}

/// A frame with a Jacobian of given singular values.
FrameDynamics WithSingularValues(RandomStates& random, const Vector6& sigma) {
  const auto orthogonal = [&](int rows) {
    const MatrixXd any = MatrixXd::NullaryExpr(rows, rows, [&] { return random.Uniform(1)(0); });
    return MatrixXd(any.householderQr().householderQ());
  };
  FrameDynamics frame;
  frame.J = orthogonal(6) * sigma.asDiagonal() * orthogonal(7).topRows(6);
  return frame;
}

TEST(NullSpaceProjector, IsTheOrthogonalProjectorAwayFromSingularities) {
  const RobotModel m = Lwr();
  RandomStates random(m, 41);
  int regular = 0;
  for (int i = 0; i < 200; ++i) {
    const FrameDynamics tool = At(m, random.q(), random.v()).frame[0];
    const NullSpace of = SpaceOf(tool);
    const MatrixXd J = tool.J, N = of.projector, inverse = of.inverse;
    EXPECT_NEAR(of.least_singular, J.jacobiSvd().singularValues()(5), 1e-8);  // √ε
    EXPECT_LT((N - N.transpose()).norm(), 1e-13);                             // round-off of W Wᵀ
    if (of.least_singular < 0.05) continue;
    ++regular;
    // Round-off, of eigenvalues of J Jᵀ that are at least 0.05².
    EXPECT_LT((N * N - N).norm(), 1e-11);
    EXPECT_LT((J * N).norm(), 1e-11);
    EXPECT_LT((N * inverse).norm(), 1e-10);
    EXPECT_LT((J * inverse - MatrixXd::Identity(6, 6)).norm(), 1e-10);
    EXPECT_LT((inverse - J.completeOrthogonalDecomposition().pseudoInverse()).norm(), 1e-9);
    EXPECT_NEAR(N.trace(), 1, 1e-11);
  }
  EXPECT_GT(regular, 100);
}

TEST(NullSpaceProjector, IsRegularWhereThePaperStarts) {
  EXPECT_GT(SpaceOf(At(Lwr(), kStart, JointVelocity::Zero(Lwr().joints())).frame[0]).least_singular,
            0.1);
}

TEST(NullSpaceProjector, FreesALostDirectionSmoothly) {
  RandomStates random(Lwr(), 42);
  const double s0 = 0.05;
  double before = 0;
  for (double s = s0; s >= 0; s -= s0 / 64) {
    Vector6 sigma;
    sigma << 1.5, 1.2, 0.9, 0.5, 0.2, s;
    const FrameDynamics frame = WithSingularValues(random, sigma);
    const NullSpace of = SpaceOf(frame, s0);
    const Eigen::JacobiSVD<MatrixXd> svd(MatrixXd(frame.J), Eigen::ComputeThinV);
    const VectorXd lost = svd.matrixV().col(5);
    const double expected = (s0 * s0 - s * s) / (s0 * s0 + 3 * s * s);
    EXPECT_NEAR(lost.dot(of.projector * lost), expected, 1e-10) << s;
    EXPECT_GE(expected, before);
    EXPECT_LE(expected - before, 0.06);  // its steepest slope, 2.5/s₀, times the step
    before = expected;
    const MatrixXd N = of.projector;
    const VectorXd eigen = N.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_GE(eigen.minCoeff(), -1e-12);
    EXPECT_LE(eigen.maxCoeff(), 1 + 1e-12);
    EXPECT_LE(MatrixXd(of.inverse).jacobiSvd().singularValues()(0),
              2 / (std::sqrt(3) * s0) * (1 + 1e-12));
  }
  EXPECT_NEAR(before, 1, 1e-12);
}

TEST(NullSpaceImpedance, IsOnlyDampingAsPrinted) {
  const RobotModel m = Lwr();
  RandomStates random(m, 43);
  for (int i = 0; i < 100; ++i) {
    const JointVelocity v = random.v();
    const FrameDynamics tool = At(m, random.q(), v).frame[0];
    const NullSpace of = SpaceOf(tool);
    if (of.least_singular < 0.05) continue;
    const double alpha_d = 0.5 + std::abs(random.Uniform(1)(0));
    for (const double other : {0.0, 1.0, 7.0}) {  // α_f and d_n do nothing
      BlockTester<NullSpaceImpedance> t(NullSpaceImpedance::Options{.joints = m.joints(),
                                                                    .damping = 1 + other,
                                                                    .friction_gain = other,
                                                                    .damping_gain = alpha_d});
      t.Set(t->null_space, of);
      t.Set(t->desired, LinearVelocity(random.Uniform(1).head<3>()));
      t.Set(t->velocity, v);
      const VectorXd tau = t.Get(t->torque);
      EXPECT_LT((of.projector * t.Get(t->desired_velocity)).norm(), 1e-9);
      EXPECT_LT((tau + alpha_d * of.projector * v).norm(), 1e-8);  // N J† = 0 to round-off, × 57
      EXPECT_LE(tau.dot(v), 1e-9);
    }
  }
}

TEST(NullSpaceImpedance, WantsTheVelocityOfTheToolWithoutATurn) {
  const RobotModel m = Lwr();
  RandomStates random(m, 44);
  const FrameDynamics tool = At(m, kStart, random.v()).frame[0];
  BlockTester<NullSpaceImpedance> t(NullSpaceImpedance::Options{.joints = m.joints()});
  t.Set(t->null_space, SpaceOf(tool));
  t.Set(t->desired, {0.1, -0.2, 0.05});
  Vector6 expected;
  expected << 0, 0, 0, 0.1, -0.2, 0.05;
  EXPECT_LT((tool.J * t.Get(t->desired_velocity) - expected).norm(), 1e-12);
}

TEST(NullSpaceImpedance, CompensatesAsMuchFrictionAsIsAssumed) {
  const RobotModel m = Lwr();
  RandomStates random(m, 45);
  const PerJoint c = PerJoint::LinSpaced(7, 0, 0.6);
  const NullSpace of = SpaceOf(At(m, kStart, random.v()).frame[0]);
  NullSpaceImpedance::Options o{.joints = m.joints(),
                                .law = NullSpaceLaw::Meant,
                                .damping = 5,
                                .friction_gain = 0.8,
                                .damping_gain = 1.5,
                                .coulomb = c};
  BlockTester<NullSpaceImpedance> t(o);
  t.Set(t->null_space, of);
  t.Set(t->desired, {0, 0, 0});
  for (const double size : {1e-4, 0.1, 10.0}) {
    const JointVelocity v = random.Uniform(size);
    t.Set(t->velocity, v);
    VectorXd wanted = -1.5 * v;
    for (int j = 1; j < 7; ++j) wanted(j) += 0.8 * c(j) * std::tanh(5 * v(j) / c(j));
    EXPECT_LT((t.Get(t->torque) - of.projector * wanted).norm(), 1e-13 * (1 + size));
  }
  o.coulomb = PerJoint::Constant(7, kUnbounded);  // the friction of the paper's proof, d_n q̇
  BlockTester<NullSpaceImpedance> linear(o);
  const JointVelocity v = random.v();
  linear.Set(linear->null_space, of);
  linear.Set(linear->desired, {0, 0, 0});
  linear.Set(linear->velocity, v);
  EXPECT_LT((linear.Get(linear->torque) - (0.8 * 5 - 1.5) * of.projector * v).norm(), 1e-12);
}

/// τⁿ at a state, with gains.
JointTorque React(const NullSpaceReaction::Options& o, const RobotDynamics& d,
                  const JointTorque& tau_e) {
  BlockTester<NullSpaceReaction> t(o);
  t.Set(t->dynamics, d);
  t.Set(t->frame, d.frame[0]);
  t.Set(t->external_torque, tau_e);
  return t.Get(t->torque);
}

TEST(NullSpaceReaction, DoesNotAccelerateTheToolByWhatIsForTheNullSpace) {
  const RobotModel m = Lwr();
  RandomStates random(m, 46);
  for (int i = 0; i < 100; ++i) {
    const RobotDynamics d = At(m, random.q(), random.v());
    if (SpaceOf(d.frame[0]).least_singular < 0.1) continue;
    const NullSpaceReaction::Options o{
        .joints = m.joints(), .null_space_gain = 1, .damping = 2, .inertia_limit = 1e5};
    const JointTorque tau = React(o, d, random.tau());
    const VectorXd moved = d.M.llt().solve(tau);
    EXPECT_LT((d.frame[0].J * moved).norm(), 1e-9 * (1 + moved.norm()));
  }
}

TEST(NullSpaceReaction, TakesOffWhatAPushDoesToTheTool) {
  const RobotModel m = Lwr();
  RandomStates random(m, 47);
  for (int i = 0; i < 100; ++i) {
    const RobotDynamics d = At(m, random.q(), JointVelocity::Zero(m.joints()));
    if (SpaceOf(d.frame[0]).least_singular < 0.1) continue;
    const NullSpaceReaction::Options o{.joints = m.joints(),
                                       .null_space_gain = 0,
                                       .tool_gain = 1,
                                       .damping = 0,
                                       .inertia_limit = 1e5};
    const JointTorque tau_e = random.tau();
    const VectorXd moved = d.M.llt().solve(PerJoint(React(o, d, tau_e) + PerJoint(tau_e)));
    const VectorXd pushed = d.M.llt().solve(PerJoint(tau_e));
    EXPECT_LT((d.frame[0].J * moved).norm(), 1e-9 * (1 + pushed.norm()));
    EXPECT_GT((d.frame[0].J * pushed).norm(), 1e-3);
  }
}

TEST(NullSpaceReaction, DampsMotionThatDoesNotMoveTheToolAndNoOther) {
  const RobotModel m = Lwr();
  RandomStates random(m, 48);
  const JointTorque none = JointTorque::Zero(m.joints());
  for (int i = 0; i < 50; ++i) {
    const JointPosition q = random.q();
    RobotDynamics d = At(m, q, random.v());
    if (SpaceOf(d.frame[0]).least_singular < 0.1) continue;
    const NullSpaceReaction::Options o{.joints = m.joints(), .damping = 3, .inertia_limit = 1e5};
    EXPECT_LE(React(o, d, none).dot(d.v), 1e-9);
    // M⁻¹ Jᵀ F is the motion of which q̇_n has nothing.
    const JointVelocity of_tool =
        d.M.llt().solve(PerJoint(d.frame[0].J.transpose() * Vector6(random.Uniform(1).head<6>())));
    d = At(m, q, of_tool);
    EXPECT_LT(React(o, d, none).norm(), 1e-8 * (1 + of_tool.norm()));
    const NullSpace of = SpaceOf(d.frame[0]);
    const JointVelocity inside = of.projector * random.v();
    d = At(m, q, inside);
    EXPECT_NEAR(React(o, d, none).dot(inside), -3 * inside.squaredNorm(), 1e-8);
  }
}

TEST(NullSpaceReaction, PullsBackToThePostureWithoutMovingTheTool) {
  const RobotModel m = Lwr();
  RandomStates random(m, 50);
  const JointTorque none = JointTorque::Zero(m.joints());
  int away = 0;
  for (int i = 0; i < 50; ++i) {
    const RobotDynamics d = At(m, random.q(), JointVelocity::Zero(m.joints()));
    if (SpaceOf(d.frame[0]).least_singular < 0.1) continue;
    ++away;
    NullSpaceReaction::Options o{.joints = m.joints(), .stiffness = 7, .inertia_limit = 1e5};
    o.posture = d.q + random.Uniform(0.3);
    const JointTorque tau = React(o, d, none);
    const VectorXd moved = d.M.llt().solve(PerJoint(tau));
    EXPECT_LT((d.frame[0].J * moved).norm(), 1e-9 * (1 + moved.norm()));
    // M⁻¹ P is symmetric and ⪰ 0: the pull accelerates the joints towards q_0, if at all.
    EXPECT_GE(moved.dot(o.posture - d.q), -1e-9);
    // P leaves out of a torque what is Jᵀ F, and of a motion in the null space takes it all.
    const VectorXd inside = SpaceOf(d.frame[0]).projector * random.v();
    EXPECT_NEAR(tau.dot(inside), 7 * inside.dot(o.posture - d.q), 1e-8);
    o.posture = d.q;
    EXPECT_EQ(React(o, d, none).norm(), 0);
  }
  EXPECT_GT(away, 10);
}

TEST(NullSpaceBlocks, StayFiniteAndOffTheHeapAtSingularPostures) {
  const RobotModel m = Lwr();
  RandomStates random(m, 49);
  BlockTester<NullSpaceProjector> project(NullSpaceProjector::Options{.joints = m.joints()});
  BlockTester<NullSpaceReaction> react(NullSpaceReaction::Options{.joints = m.joints()});
  for (auto law : {NullSpaceLaw::Printed, NullSpaceLaw::Meant}) {
    BlockTester<NullSpaceImpedance> damp(NullSpaceImpedance::Options{
        .joints = m.joints(), .law = law, .coulomb = PerJoint::Constant(7, 0.3)});
    damp.Set(damp->desired, {0.1, 0.1, 0.1});
    const auto run = [&](const JointPosition& q, const JointVelocity& v) {
      const RobotDynamics d = At(m, q, v);
      project.Set(project->frame, d.frame[0]);
      react.Set(react->dynamics, d);
      react.Set(react->frame, d.frame[0]);
      react.Set(react->external_torque, random.tau());
      damp.Set(damp->velocity, v);
      const long before = Allocations();
      const NullSpace& of = project.Get(project->null_space);
      const JointTorque& reaction = react.Get(react->torque);
      const long after = Allocations();
      damp.Set(damp->null_space, of);
      const long then = Allocations();
      const JointTorque& torque = damp.Get(damp->torque);
      EXPECT_TRUE(of.projector.allFinite() && reaction.allFinite() && torque.allFinite());
      return after - before + Allocations() - then;
    };
    run(kStart, JointVelocity::Zero(m.joints()));                    // builds the diagrams
    EXPECT_EQ(run(JointPosition::Zero(m.joints()), random.v()), 0);  // straight up
    EXPECT_EQ(run({0, 1.5, 0, 0, 0, 0, 0}, random.v()), 0);          // stretched out
    for (int i = 0; i < 20; ++i) EXPECT_EQ(run(random.q(), random.v()), 0);
  }
}

TEST(NullSpaceBlocks, RefuseOptionsOutOfRange) {
  using testing::HasSubstr;
  const Joints joints = Lwr().joints();
  EXPECT_THAT(ErrorOf([&] { NullSpaceProjector block({.joints = joints, .damped_below = 0}); }),
              HasSubstr("damped_below must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceImpedance block({.joints = joints, .damping = 0}); }),
              HasSubstr("damping must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceImpedance block({.joints = joints, .friction_gain = -1}); }),
              HasSubstr("friction_gain must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceImpedance block({.joints = joints, .damping_gain = -1}); }),
              HasSubstr("damping_gain must be"));
  EXPECT_THAT(ErrorOf([&] {
                NullSpaceImpedance block({.joints = joints, .coulomb = PerJoint::Constant(3, 1)});
              }),
              HasSubstr("coulomb has an element for each of the 7 joints, got 3"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .null_space_gain = -1}); }),
              HasSubstr("null_space_gain must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .tool_gain = -1}); }),
              HasSubstr("tool_gain must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .damping = -1}); }),
              HasSubstr("damping must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .stiffness = -1}); }),
              HasSubstr("stiffness must be"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .stiffness = 1}); }),
              HasSubstr("posture has an element for each of the 7 joints, got 0"));
  EXPECT_THAT(ErrorOf([&] { NullSpaceReaction block({.joints = joints, .inertia_limit = 0}); }),
              HasSubstr("inertia_limit must be"));
}

}  // namespace
}  // namespace pliant
