#include "pliant/controllers/frame_force.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

RobotDynamics At(const RobotModel& m, const JointPosition& q) {
  RobotDynamics d(m, {"tool_frame"});
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  return d;
}

/// The eigenvalues of J M⁻¹ Jᵀ, in order.
Vector6 Mobilities(const RobotDynamics& d) {
  const Eigen::MatrixXd J = d.frame[0].J, K = J * d.M.llt().solve(J.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
}

TEST(FrameForce, IsTheForceAtTheFrame) {
  const RobotModel m = Gen3();
  RandomStates random(m, 11);
  int tried = 0;
  for (int k = 0; k < 200; ++k) {
    const RobotDynamics d = At(m, random.q());
    const Vector6 mobility = Mobilities(d);
    if (mobility(0) < 0.01) continue;  // k₀
    ++tried;
    const Vector6 F = random.Uniform(20).head<6>();
    const JointAcceleration qdd = d.M.llt().solve(d.frame[0].J.transpose() * F);
    // round-off of J q̈_e, a few ε each time it is made, grown by the condition
    EXPECT_LT((FrameForce(d, d.frame[0], qdd) - F).norm(),
              1e-14 * F.norm() * mobility(5) / mobility(0))
        << k;
  }
  EXPECT_GT(tried, 50);
}

TEST(FrameForce, DoesNotSeeWhatMovesTheArmAndNotTheFrame) {
  const RobotModel m = Gen3();
  RandomStates random(m, 12);
  for (int k = 0; k < 50; ++k) {
    const RobotDynamics d = At(m, random.q());
    const Eigen::MatrixXd J = d.frame[0].J;
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(J);
    const JointAcceleration null_space = PerJoint(lu.kernel().col(0));
    EXPECT_LT(FrameForce(d, d.frame[0], null_space).norm(), 200 * 1e-13) << k;  // L ε
  }
}

TEST(FrameForce, NeverNeedsMoreThanTheLimitOfInertia) {
  const RobotModel m = Gen3();
  RandomStates random(m, 13);
  for (const double limit : {20.0, 200.0, 2000.0})
    for (int k = 0; k < 50; ++k) {
      // stretched out, and anywhere
      const RobotDynamics d = At(m, k == 0 ? JointPosition(PerJoint::Zero(7)) : random.q());
      const JointAcceleration qdd = random.a();
      const Vector6 pushed = d.frame[0].J * qdd;
      EXPECT_LE(FrameForce(d, d.frame[0], qdd, limit).norm(), limit * pushed.norm() * (1 + 1e-12));
    }
}

}  // namespace
}  // namespace pliant
