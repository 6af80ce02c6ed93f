#include "pliant/controllers/contact_law.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>
#include <numbers>
#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/contact_rig.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Outcome = ContactLawReport::Outcome;

TaskMatrix Number(double x) { return TaskMatrix::Constant(1, 1, x); }

/// No inertia is too large, so no direction is damped.
ContactLaw::Settings Exact() { return {.inertia_limit = 1e9}; }

struct Rig {
  Rig(const RobotModel& m, int objectives, const ContactLaw::Settings& settings = Exact())
      : model{m},
        t{ContactLaw::Options{.model = m,
                              .period = 1ms,
                              .posture = JointPosition::Zero(m.joints()),
                              .settings = settings}} {
    for (int i = 0; i < objectives; ++i)
      joined.push_back(&t.Join(t->objectives, Objective::Zero(3, m.size())));
    t.Set(t->contacts, Contacts{});
  }
  const JointAcceleration& Accelerate(const RobotDynamics& d) {
    t.Set(t->dynamics, d);
    t.Tick();
    return t.Get(t->acceleration);
  }
  void Want(std::size_t i, const MatrixXd& A, const VectorXd& b) {
    t.Set(*joined[i], Objective{A, b, 1});
  }
  const ContactLawReport& report() { return t.Get(t->report); }

  RobotModel model;
  BlockTester<ContactLaw> t;
  std::vector<const Input<Objective>*> joined;
};

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

MatrixXd PointJacobian(const RobotModel& m, const RobotDynamics& d, int joint) {
  return PointDynamics(m, d, m.joint(joint).child, {0.02, 0.05, 0.1}).J.bottomRows<3>();
}

TEST(ContactLaw, IsTheFormulaOfTheInertiaWeightedInverse) {
  for (const RobotModel& m : {Lwr(), Gen3()}) {
    Rig rig(m, 2);
    RandomStates random(m, 101);
    for (int k = 0; k < 100; ++k) {
      const RobotDynamics d = At(m, random.q(), random.v());
      MatrixXd A(6, m.size());
      A << PointJacobian(m, d, 3), PointJacobian(m, d, 6);
      const VectorXd b = random.Uniform(3).head<6>();
      const bool both = k % 2 == 0;
      rig.Want(0, A.topRows(3), b.head(3));
      if (both)
        rig.Want(1, A.bottomRows(3), b.tail(3));
      else
        rig.t.Set(*rig.joined[1], Objective::Zero(3, m.size()));
      const Contacts touched =
          TouchedAt(m.joint(3).child, {0.02, 0.05, 0.1}, random.Uniform(30).head<3>());
      rig.t.Set(rig.t->contacts, touched);
      const VectorXd qdd = rig.Accelerate(d);

      const MatrixXd J = both ? A : MatrixXd(A.topRows(3));
      const VectorXd wanted = both ? b : VectorXd(b.head(3));
      const MatrixXd M = d.M, inverse = M.inverse();
      const MatrixXd K = J * inverse * J.transpose();
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(K, Eigen::EigenvaluesOnly);
      const double smallest = eigen.eigenvalues().minCoeff();
      EXPECT_NEAR(rig.report().smallest_mobility, smallest, 1e-9 * eigen.eigenvalues().maxCoeff());
      if (smallest < 1e-3) continue;  // both ways lose digits
      const MatrixXd pseudo = inverse * J.transpose() * K.inverse();
      const VectorXd qdd_0 = -20 * d.v;
      const VectorXd expected = pseudo * wanted + (MatrixXd::Identity(7, 7) - pseudo * J) * qdd_0;
      EXPECT_LT(RelativeError(qdd, expected), 1e-8);
      EXPECT_LT((J * qdd - wanted).norm(), 1e-8) << "all that is wanted comes about";
      const VectorXd tau =
          M * expected + d.coriolis + d.gravity - A.topRows(3).transpose() * touched.at[0].force;
      EXPECT_LT(RelativeError(rig.t.Get(rig.t->torque), tau), 1e-8);
      EXPECT_EQ(rig.report().outcome, Outcome::Contact);
      EXPECT_EQ(rig.report().rows, both ? 6 : 3);
    }
  }
}

TEST(ContactLaw, ProjectsTheRestWithoutTouchingWhatIsWanted) {
  const RobotModel m = Lwr();
  Rig rig(m, 1);
  RandomStates random(m, 102);
  for (int k = 0; k < 30; ++k) {
    RobotDynamics d = At(m, random.q(), JointVelocity::Zero(m.joints()));
    const MatrixXd A = PointJacobian(m, d, 2 + k % 5);
    rig.Want(0, A, VectorXd::Zero(3));
    MatrixXd P(7, 7);
    for (int i = 0; i < 7; ++i) {  // q̈_0 = −K_N q̇ is a unit vector
      d.v = -VectorXd::Unit(7, i) / 20;
      P.col(i) = rig.Accelerate(d);
    }
    if (rig.report().smallest_mobility < 1e-3) continue;  // round-off times the largest inertia
    const MatrixXd M = d.M;
    EXPECT_LT((P * P - P).norm(), 1e-8);
    EXPECT_LT((A * P).norm(), 1e-8);
    EXPECT_LT((P * M.inverse() * A.transpose()).norm(), 1e-8) << "forces at the contact";
    EXPECT_LT((M * P - P.transpose() * M).norm(), 1e-8) << "orthogonal in the metric M";
  }
}

TEST(ContactLaw, OfTheNaturalInertiaDoesNotDependOnTheForce) {
  for (const RobotModel& m : {Lwr(), Gen3()}) {
    const ContactImpedance::Gains gains{.damping = Number(80), .stiffness = Number(500)};
    ContactRig pushed(m, gains, Exact()), told_nothing(m, gains, Exact());
    RandomStates random(m, 103);
    for (const int joint : {0, 1, 2, 4, 6}) {  // of rank 1 and 2, too
      const int link = m.joint(joint).child;
      const Vector3d point(0.02, 0.05, 0.1);
      for (int k = 0; k < 30; ++k) {
        const JointPosition q = random.q();
        const JointVelocity v = 0.2 * random.v();
        const VectorXd with = pushed.Torque(q, v, TouchedAt(link, point, {15, -20, 10}));
        const VectorXd without = told_nothing.Torque(q, v, TouchedAt(link, point, {0, 0, 0}));
        const double k_min = pushed.Get(pushed.law->report).smallest_mobility;
        if (k_min > 1e-9 && k_min < 1e-3) continue;  // round-off times the largest inertia
        EXPECT_LT(RelativeError(with, without), 1e-7) << joint;
      }
    }
  }
}

TEST(ContactLaw, DoesNothingToAnArmThatRestsWhereItIsToBe) {
  const RobotModel m = Lwr();
  ContactRig rig(m, ContactImpedance::Gains{
                        .inertia = Number(5), .damping = Number(80), .stiffness = Number(500)});
  RandomStates random(m, 104);
  for (int k = 0; k < 30; ++k) {
    const JointPosition q = random.q();
    const JointVelocity rest = JointVelocity::Zero(m.joints());
    rig.Torque(q, rest, Contacts{});
    const VectorXd tau = rig.Torque(q, rest, TouchedAt(m.joint(5).child, {0, 0, 0.1}, {0, 0, 0}));
    EXPECT_LT((tau - rig.At(q, rest).gravity).norm(), 1e-9);
    // The anchor stays where the first of these contacts began, unless another one comes between.
    rig.Torque(q, rest, TouchedAt(m.joint(3).child, {0, 0, 0}, {0, 0, 0}));
  }
}

TEST(ContactLaw, MovesTheArmWhereItCanAndStaysSmallWhereItCannot) {
  const RobotModel m = Lwr();
  // At 5 cm from the first axis the arm shows up to 3.7 kg·m² as 1300 kg.
  Rig base(m, 2, {.inertia_limit = 1e4});
  RandomStates random(m, 105);
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = At(m, random.q(), JointVelocity::Zero(m.joints()));
    const MatrixXd A = PointJacobian(m, d, 0);  // one joint, three numbers
    const Vector3d b = random.Uniform(3).head<3>();
    base.Want(0, A, b);
    base.Want(1, A, b);  // and twice
    const VectorXd qdd = base.Accelerate(d);
    EXPECT_EQ(base.report().rows, 6);
    const Vector3d way = A.col(0).normalized();
    // The eigenvalues of round-off, 1e-17 1/kg, count as 1e-17 L² of b.
    EXPECT_LT((A * qdd - way * way.dot(b)).norm(), 1e-8);
  }
  Rig rig(m, 2, {.inertia_limit = 200});
  // Stretched out, the arm cannot move its tool along itself.
  for (const double bend : {0.0, 1e-6, 1e-4, 1e-2, 0.1}) {
    const RobotDynamics d =
        At(m, JointPosition{0, 0.4, 0, bend, 0, 0, 0}, JointVelocity::Zero(m.joints()));
    const MatrixXd A = PointJacobian(m, d, 5);
    rig.Want(0, A, Vector3d(1, 1, 1));
    rig.t.Set(*rig.joined[1], Objective::Zero(3, m.size()));
    const VectorXd qdd = rig.Accelerate(d);
    // ‖q̈‖_M ≤ √L ‖b‖
    const double energy = qdd.dot(MatrixXd(d.M) * qdd);
    EXPECT_LT(energy, 200 * 3 * (1 + 1e-9)) << bend;
  }
}

TEST(ContactLaw, HoldsThePostureOfTheStartAndLaterThatInWhichTheLastObjectiveEnded) {
  const RobotModel m = Gen3();
  Rig rig(m, 1);
  const JointVelocity v = 0.1 * JointVelocity(PerJoint::Ones(7));
  const JointPosition q = 0.3 * JointPosition(PerJoint::Ones(7));
  EXPECT_LT((rig.Accelerate(At(m, q, v)) + 100 * q + 20 * v).norm(), 1e-12);
  EXPECT_EQ(rig.report().outcome, Outcome::Posture);

  rig.Want(0, PointJacobian(m, At(m, q, v), 5), Vector3d(0, 0, 0));
  rig.Accelerate(At(m, q, v));
  EXPECT_EQ(rig.report().outcome, Outcome::Contact);
  rig.t.Set(*rig.joined[0], Objective::Zero(3, m.size()));
  const JointPosition left = 0.5 * JointPosition(PerJoint::Ones(7));
  EXPECT_LT((rig.Accelerate(At(m, left, v)) + 20 * v).norm(), 1e-12);
  EXPECT_LT((rig.Accelerate(At(m, q, v)) - 100 * (left - q) + 20 * v).norm(), 1e-12);

  // Continuous joints take the short way.
  JointPosition turned = left;
  turned(0) += 2 * std::numbers::pi;
  EXPECT_LT((rig.Accelerate(At(m, turned, v)) + 20 * v).norm(), 1e-9);
}

TEST(ContactLaw, KeepsItsPostureWhereTheArmSaysNoneWhenTheLastObjectiveEnds) {
  const RobotModel m = Lwr();
  Rig rig(m, 1);
  const JointVelocity rest = JointVelocity::Zero(m.joints());
  const JointPosition q = 0.3 * JointPosition(PerJoint::Ones(7));
  rig.Want(0, PointJacobian(m, At(m, q, rest), 5), Vector3d(0, 0, 0));
  rig.Accelerate(At(m, q, rest));
  rig.t.Set(*rig.joined[0], Objective::Zero(3, m.size()));
  RobotDynamics none = At(m, q, rest);
  none.q.setConstant(std::numeric_limits<double>::quiet_NaN());
  rig.Accelerate(none);
  EXPECT_EQ(rig.report().outcome, Outcome::Fallback);
  EXPECT_TRUE(rig.t.Get(rig.t->torque).allFinite());
  EXPECT_LT((rig.Accelerate(At(m, q, rest)) + 100 * q).norm(), 1e-12) << "that of the start";
  EXPECT_EQ(rig.report().outcome, Outcome::Posture);
}

TEST(ContactLaw, DoesNotCountAnObjectiveThatNoJointMoves) {
  const RobotModel m = Lwr();
  Rig rig(m, 2);
  const JointVelocity rest = JointVelocity::Zero(m.joints());
  const JointPosition q = 0.3 * JointPosition(PerJoint::Ones(7));
  const RobotDynamics d = At(m, q, rest);
  rig.Want(0, MatrixXd::Zero(3, 7), Vector3d(1, 2, 3));
  rig.t.Set(*rig.joined[1], Objective::Zero(3, m.size()));
  EXPECT_LT((rig.Accelerate(d) + 100 * q).norm(), 1e-12) << "the posture is held";
  EXPECT_EQ(rig.report().outcome, Outcome::Posture);
  EXPECT_EQ(rig.report().rows, 0);
  const MatrixXd A = PointJacobian(m, d, 5);
  rig.Want(1, A, Vector3d(1, 2, 3));
  const VectorXd qdd = rig.Accelerate(d);
  EXPECT_EQ(rig.report().outcome, Outcome::Contact);
  EXPECT_EQ(rig.report().rows, 3);
  EXPECT_LT((A * qdd - Vector3d(1, 2, 3)).norm(), 1e-8);
}

TEST(ContactLaw, CutsTheTorqueAndSaysOfWhichJoints) {
  const RobotModel m = Lwr();
  Rig rig(m, 1);
  const RobotDynamics d =
      At(m, JointPosition{0, 0.5, 0, -1, 0, 1, 0}, JointVelocity::Zero(m.joints()));
  rig.Want(0, PointJacobian(m, d, 5), Vector3d(0, 0, 1e4));
  rig.Accelerate(d);
  EXPECT_NE(rig.report().saturated, 0U);
  for (int i = 0; i < 7; ++i) {
    const double tau = std::abs(rig.t.Get(rig.t->torque)(i));
    EXPECT_LE(tau, m.effort_limit()(i));
    EXPECT_EQ(tau == m.effort_limit()(i), (rig.report().saturated >> i & 1U) != 0);
  }
}

TEST(ContactLaw, FallsBackToDampedGravityCompensationWhereTheArmIsNone) {
  const RobotModel m = Lwr();
  Rig rig(m, 1);
  RobotDynamics d = At(m, JointPosition{0, 0.5, 0, -1, 0, 1, 0}, JointVelocity(PerJoint::Ones(7)));
  rig.Want(0, PointJacobian(m, d, 5), Vector3d(0, 0, 1));
  d.M.setZero();
  rig.Accelerate(d);
  EXPECT_EQ(rig.report().outcome, Outcome::Fallback);
  EXPECT_LT((rig.t.Get(rig.t->torque) - d.gravity + 5 * d.v).norm(), 1e-12);
}

TEST(ContactLaw, SaysWhenThereAreMoreObjectivesThanItHasRoomFor) {
  const RobotModel m = Lwr();
  Rig rig(m, 4);
  const RobotDynamics d =
      At(m, JointPosition{0, 0.5, 0, -1, 0, 1, 0}, JointVelocity::Zero(m.joints()));
  for (std::size_t i = 0; i < 4; ++i)
    rig.Want(i, PointJacobian(m, d, 3 + static_cast<int>(i)), Vector3d(0, 0, 0));
  rig.Accelerate(d);
  EXPECT_EQ(rig.report().outcome, Outcome::LeftOut);
  EXPECT_EQ(rig.report().rows, 9);
}

TEST(ContactLaw, RefusesSettingsThatAreNone) {
  const RobotModel m = Lwr();
  const auto error = [&](auto change) {
    ContactLaw::Options o{
        .model = m, .period = 1ms, .posture = JointPosition::Zero(m.joints()), .settings = {}};
    change(o);
    return ErrorOf([&] { ContactLaw law(o); });
  };
  EXPECT_EQ(error([](auto& o) { o.settings.null_damping = -1; }),
            "null_damping must be >= 0 1/s, got -1");
  EXPECT_EQ(error([](auto& o) { o.settings.inertia_limit = 0; }),
            "inertia_limit must be > 0 kg, got 0");
  EXPECT_EQ(error([](auto& o) {
              o.posture = JointPosition{0.0, 0.0};
            }),
            "posture has an element for each of the 7 joints, got 2");
  EXPECT_EQ(error([](auto& o) { o.fallback_damping = -5; }),
            "fallback_damping must be >= 0 N·m·s/rad, got -5");
}

TEST(ContactLaw, HoldsTheLaws) {
  const RobotModel m = Lwr();
  BlockTester<ContactLaw> t(ContactLaw::Options{
      .model = m, .period = 1ms, .posture = JointPosition::Zero(m.joints()), .settings = {}});
  t.Set(t->dynamics, RobotDynamics(m));
  for (int i = 0; i < 4; ++i) t.Join(t->objectives, Objective::Zero(3, m.size()));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
