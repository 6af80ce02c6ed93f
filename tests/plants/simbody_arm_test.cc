#include "pliant/plants/simbody_arm.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

class SimbodyArmLaws : public ::testing::TestWithParam<RobotModel (*)()> {
 protected:
  std::vector<ContactForce> Forces() {
    std::vector<ContactForce> forces(3);
    for (ContactForce& F : forces) {
      F.link = static_cast<int>(random.random() % model.links().size());
      F.point = random.Uniform(0.3).head<3>();
      F.force = random.Uniform(20).head<3>();
      F.moment = random.Uniform(5).head<3>();
    }
    forces.push_back({.link = -1, .force = {1, 1, 1}});
    return forces;
  }

  RobotModel model = GetParam()();
  RandomStates random{model};
  SimbodyArm arm{model};
  SimbodyArm::Workspace workspace;
};

TEST_P(SimbodyArmLaws, MovesAsTheForcesOfTheEnvironmentAndTheRotorsSay) {
  // (M + B) v̇ + C v + g = τ + Σ Jᵀ F, with the kernel's M, C v, g and J and Simbody's v̇.
  RobotDynamics d(model);
  for (int k = 0; k < 300; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointTorque tau = random.tau();
    const std::vector<ContactForce> forces = Forces();
    const PerJoint B = PerJoint::Constant(model.size(), k % 2 == 0 ? 0 : 0.3);
    const JointAcceleration a = arm.ForwardDynamics(q, v, tau, forces, B, workspace);
    ComputeDynamics(model, q, v, d);
    PerJoint tau_e = PerJoint::Zero(model.size());
    for (const ContactForce& F : forces) {
      if (F.link < 0) continue;
      Vector6 wrench;
      wrench << F.moment, F.force;
      tau_e += PointDynamics(model, d, F.link, F.point).J.transpose() * wrench;
    }
    const PerJoint residual = InverseDynamics(d, a) + B.cwiseProduct(a) - tau - tau_e;
    const double scale = (d.M.norm() + B.norm()) * a.norm() + tau.norm() + tau_e.norm();
    ASSERT_LT(residual.norm(), 1e-12 * scale) << "state " << k;
  }
}

TEST_P(SimbodyArmLaws, AgreesWithTheKernel) {
  // v̇ = M⁻¹ (…): the condition number of M, up to 1e4, times rounding.
  RobotDynamics d(model);
  for (int k = 0; k < 300; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointTorque tau = random.tau();
    const std::vector<ContactForce> forces = Forces();
    ComputeDynamics(model, q, v, d);
    const JointAcceleration expected = ForwardDynamics(d, tau, ExternalTorque(model, d, forces));
    const JointAcceleration a = arm.ForwardDynamics(q, v, tau, forces, {}, workspace);
    ASSERT_LT(RelativeError(a, expected), 1e-11) << "state " << k;
  }
}

TEST_P(SimbodyArmLaws, ComputesTheMomentaOfTheKernel) {
  RobotDynamics d(model), e(model);
  for (int k = 0; k < 300; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    ComputeDynamics(model, q, v, d);
    arm.ComputeDynamics(q, v, e, workspace);
    ASSERT_LT(RelativeError(e.p, d.p), 1e-12);
    ASSERT_LT((e.coriolis_transposed - d.coriolis_transposed).norm(),
              1e-13 * d.M.norm() * v.squaredNorm());
  }
}

TEST_P(SimbodyArmLaws, ResultsDoNotDependOnTheWorkspace) {
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  const JointTorque tau = random.tau();
  const JointAcceleration a = arm.ForwardDynamics(q, v, tau, {}, {}, workspace);
  arm.ForwardDynamics(random.q(), random.v(), tau, Forces(), PerJoint::Ones(model.size()),
                      workspace);
  SimbodyArm::Workspace copy = workspace, fresh;
  EXPECT_EQ(arm.ForwardDynamics(q, v, tau, {}, {}, workspace), a);
  EXPECT_EQ(arm.ForwardDynamics(q, v, tau, {}, {}, copy), a);
  EXPECT_EQ(arm.ForwardDynamics(q, v, tau, {}, {}, fresh), a);
}

TEST_P(SimbodyArmLaws, WorkspaceServesAnotherArm) {
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  const JointTorque tau = random.tau();
  const JointAcceleration a = arm.ForwardDynamics(q, v, tau, {}, {}, workspace);
  const SimbodyArm weightless(model.WithGravity(Eigen::Vector3d::Zero()));
  EXPECT_NE(weightless.ForwardDynamics(q, v, tau, {}, {}, workspace), a);
  EXPECT_EQ(arm.ForwardDynamics(q, v, tau, {}, {}, workspace), a);
}

TEST_P(SimbodyArmLaws, ArmIsSharedByThreads) {
  constexpr int kStates = 2000;
  std::vector<JointPosition> q;
  std::vector<JointVelocity> v;
  std::vector<JointTorque> tau;
  std::vector<JointAcceleration> expected;
  const std::vector<ContactForce> forces = Forces();
  for (int k = 0; k < kStates; ++k) {
    q.push_back(random.q());
    v.push_back(random.v());
    tau.push_back(random.tau());
    expected.push_back(arm.ForwardDynamics(q.back(), v.back(), tau.back(), forces, {}, workspace));
  }
  std::atomic<int> wrong = 0;
  const auto run = [&](int first) {
    SimbodyArm::Workspace own;
    for (int k = 0; k < kStates; ++k) {
      const std::size_t i = static_cast<std::size_t>((first + k) % kStates);
      if (arm.ForwardDynamics(q[i], v[i], tau[i], forces, {}, own) != expected[i]) ++wrong;
    }
  };
  std::thread other(run, kStates / 2);
  run(0);
  other.join();
  EXPECT_EQ(wrong, 0);
}

TEST_P(SimbodyArmLaws, AnswersNotANumberWithNotANumber) {
  JointPosition q = random.q();
  q(0) = std::numeric_limits<double>::quiet_NaN();
  const JointAcceleration a = arm.ForwardDynamics(q, random.v(), random.tau(), {}, {}, workspace);
  ASSERT_EQ(a.size(), model.size());
  EXPECT_TRUE(a.hasNaN());
}

INSTANTIATE_TEST_SUITE_P(Arms, SimbodyArmLaws, ::testing::Values(&Gen3, &Lwr, &Tree),
                         [](const auto& test) { return test.param().name(); });

}  // namespace
}  // namespace pliant
