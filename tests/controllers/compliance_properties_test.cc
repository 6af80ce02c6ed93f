// What compliance and mobility mean for the motion of the arm, for tasks of all kinds.

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pliant/tests/controllers/compliance_rig.h"
#include "pliant/tests/controllers/task_kinds.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// cond(H) is at most w ‖J‖² / w₀, some 10⁶ here, so round-off in q̈ and τ is some 10⁻¹⁰ of their
// size.
constexpr double kRoundOff = 1e-8;
constexpr int kStates = 50;

/// Every kind of task in a controller without limits.
struct Bench {
  explicit Bench(const TaskKind& kind, double weight = 1e4)
      : rig{Weighed(kind.options, weight), false}, random{kind.options.model, 51} {
    rig.sim->Set(rig.qp->torque_limit, PerJoint::Constant(kind.options.model.size(), 1e9));
  }
  static FrameTask::Options Weighed(FrameTask::Options o, double weight) {
    o.weight = weight;
    o.inertia_limit = 1e9;
    return o;
  }
  JointTorque nothing() const { return JointTorque::Zero(rig.model.joints()); }
  void Place() {
    rig.SetState(random.q(), random.v());
    rig.Tick(nothing());
    A = rig.sim->Get(rig.pose->objective).A;
    const MatrixXd M = rig.d().M;
    inverse_inertia = A * M.inverse() * A.transpose();
  }
  /// How much more the task accelerates under a force of its rows.
  VectorXd MovedBy(const VectorXd& force) {
    rig.Tick(nothing());
    const JointAcceleration still = rig.acceleration();
    rig.Tick(JointTorque(A.transpose() * force));
    return A * (rig.acceleration() - still);
  }
  /// w (A q̈ − b) is what w₀ holds against it: with Γ₀ = 0 it takes w₀/(w σ²) off, where σ² is the
  /// least eigenvalue of A Aᵀ.
  double Yielding() const {
    const double least =
        Eigen::SelfAdjointEigenSolver<MatrixXd>(A * A.transpose()).eigenvalues().minCoeff();
    return 1 / (rig.sim->Get(rig.pose->weight) * std::max(least, 0.0));
  }

  mutable ComplianceRig rig;
  RandomStates random;
  MatrixXd A, inverse_inertia;
};

TEST(Compliance, OfOneEverywhereGivesTheTorqueOfAControllerThatIgnoresTheExternalTorque) {
  for (const TaskKind& kind : Kinds()) {
    Bench bench(kind);
    bench.rig.SetCompliance(1, 1);
    for (int k = 0; k < kStates; ++k) {
      bench.Place();
      const JointTorque ignorant = bench.rig.torque(), tau_e = bench.random.tau();
      bench.rig.Tick(tau_e);
      const double size =
          (bench.rig.d().M * bench.rig.acceleration()).norm() + ignorant.norm() + tau_e.norm();
      ASSERT_LT((bench.rig.torque() - ignorant).norm(), kRoundOff * size) << kind.name;
    }
  }
}

TEST(Compliance, OfZeroMakesTheMotionIndependentOfTheExternalTorque) {
  for (const TaskKind& kind : Kinds()) {
    Bench bench(kind);
    for (int k = 0; k < kStates; ++k) {
      bench.Place();
      const JointAcceleration free = bench.rig.acceleration();
      const JointTorque tau_e = bench.random.tau();
      bench.rig.Tick(tau_e);
      ASSERT_EQ(bench.rig.acceleration(), free) << kind.name;
      const JointAcceleration moved = ForwardDynamics(bench.rig.d(), bench.rig.torque(), tau_e);
      ASSERT_LT(RelativeError(moved, free), kRoundOff) << kind.name;
    }
  }
}

TEST(Compliance, ThatCommutesWithTheInertiaIsTheRatioOfNaturalToApparentInertia) {
  int tried = 0;
  for (const TaskKind& kind : Kinds()) {
    Bench bench(kind, 1e6);
    const Eigen::Index m = kind.options.stiffness.size();
    for (int k = 0; k < kStates; ++k) {
      bench.Place();
      const double yielding = bench.Yielding();
      if (!(yielding < 1e-3)) continue;  // too near to a singularity to be told from the posture
      ++tried;
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(bench.inverse_inertia);
      const MatrixXd U = eigen.eigenvectors();
      const VectorXd gamma = VectorXd::LinSpaced(m, 0.1, 2);
      bench.rig.sim->Set(bench.rig.pose->compliance,
                         TaskMatrix(U * gamma.asDiagonal() * U.transpose()));
      const Eigen::Index i = k % m;
      const VectorXd moved = bench.MovedBy(10 * U.col(i));
      // F = Λ/γ ẍ, with Λ of that direction 1/eigenvalue
      const VectorXd expected = 10 * gamma(i) * eigen.eigenvalues()(i) * U.col(i);
      ASSERT_LT((moved - expected).norm(),
                (yielding + 1e-6) * expected.norm() + kRoundOff * eigen.eigenvalues().maxCoeff())
          << kind.name;
    }
  }
  EXPECT_GT(tried, 1000);
}

TEST(Mobility, IsTheInverseOfTheApparentInertiaAlongItsDirection) {
  int tried = 0;
  for (const TaskKind& kind : Kinds()) {
    Bench bench(kind, 1e6);
    const Eigen::Index m = kind.options.stiffness.size();
    for (int k = 0; k < kStates; ++k) {
      bench.Place();
      const double yielding = bench.Yielding();
      if (!(yielding < 1e-3)) continue;
      ++tried;
      VectorXd n(m);
      for (double& x : n) x = bench.random.Uniform(1)(0);
      n.normalize();
      const double y = 0.2 + 0.1 * k;
      bench.rig.sim->Set(bench.rig.pose->mobility, TaskMatrix(y * n * n.transpose()));
      const VectorXd moved = bench.MovedBy(10 * n);
      ASSERT_LT((moved - 10 * y * n).norm(), (yielding + 1e-6) * 10 * y) << kind.name;
    }
  }
  EXPECT_GT(tried, 1000);
}

}  // namespace
}  // namespace pliant
