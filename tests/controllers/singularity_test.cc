// A pose task driven through singularities of the Gen3, in closed loop on an ideal arm.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/pose_reference.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Pose ToolAt(const RobotModel& m, const JointPosition& q) {
  RobotDynamics d(m, {"tool_frame"});
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  return d.frame[0].pose;
}

/// reference ─▶ pose task, posture task ─▶ qp ─▶ arm ─▶ dynamics ─▶ tasks
///
/// Without limits q̈_d = b₀ + (w JᵀJ + w₀ I)⁻¹ w Jᵀ (b − J b₀), and w σ/(w σ² + w₀) ≤ ½ √(w/w₀) for
/// any singular value σ of J, so at every posture
///
///   ‖q̈_d‖ ≤ ‖b₀‖ + ½ √(w/w₀) ‖b − J b₀‖
///
struct Loop {
  Loop(const JointPosition& start, const std::vector<TimedPose>& way) {
    const int n = m.size();
    DiagramBuilder b;
    auto& arm = b.Add<SimbodyPlant>(
        "arm", {.model = m, .position = start, .engine = SimbodyPlant::Engine::Recursive});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m});
    auto& reference = b.Add<PoseWaypoints>("reference", {.waypoints = way});
    pose = &b.Add<FrameTask>("pose", {.model = m,
                                      .frame = "tool_frame",
                                      .stiffness = TaskVector::Constant(6, 100),
                                      .damping = TaskVector::Constant(6, 20),
                                      .weight = kWeight});
    posture = &b.Add<PostureTask>("posture", {.model = m,
                                              .target = start,
                                              .stiffness = PerJoint::Constant(n, 4),
                                              .damping = PerJoint::Constant(n, 4)});
    qp = &b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms});
    b.Connect(arm.position, dynamics.position);
    b.Connect(arm.velocity, dynamics.velocity);
    b.Connect(dynamics.dynamics, pose->dynamics);
    b.Connect(reference.pose, pose->target);
    b.Connect(reference.twist, pose->target_twist);
    b.Connect(reference.acceleration, pose->target_acceleration);
    b.Connect(dynamics.dynamics, posture->dynamics);
    b.Connect(dynamics.dynamics, qp->dynamics);
    b.Connect(pose->objective, qp->objectives);
    b.Connect(posture->objective, qp->objectives);
    b.Connect(qp->torque, arm.torque);
    this->dynamics = &dynamics;
    diagram = std::make_unique<Diagram>(b.Build());
    sim = std::make_unique<Simulator>(*diagram);
    sim->Set(qp->torque_limit, PerJoint::Constant(n, 1e9));
  }

  /// Runs, and holds every tick against the bound.
  void RunTo(double end) {
    while (sim->time() < end) {
      sim->AdvanceThroughTick();
      const Objective &o = sim->Get(pose->objective), &o0 = sim->Get(posture->objective);
      const MatrixXd J = o.A;
      const VectorXd b = o.b, b0 = o0.b;
      const double bound = b0.norm() + 0.5 * std::sqrt(kWeight) * (b - J * b0).norm();
      const RobotDynamics& d = sim->Get(dynamics->dynamics);
      const MatrixXd M = d.M;
      const JointTorque bias = d.coriolis + d.gravity;
      ASSERT_EQ(sim->Get(qp->report).outcome, ComplianceQpReport::Outcome::Solved);
      ASSERT_LE(sim->Get(qp->acceleration).norm(), bound * (1 + 1e-9) + 1e-9) << sim->time();
      ASSERT_LE(sim->Get(qp->torque).norm(),
                M.operatorNorm() * bound * (1 + 1e-9) + bias.norm() + 1e-9)
          << sim->time();
      const double smallest = Eigen::JacobiSVD<MatrixXd>(J).singularValues()(5);
      nearest = std::min(nearest, smallest);
    }
  }

  static constexpr double kWeight = 1e4;
  const RobotModel m = Gen3();
  FrameTask* pose;
  PostureTask* posture;
  ComplianceQp* qp;
  ModelDynamics* dynamics;
  std::unique_ptr<Diagram> diagram;
  std::unique_ptr<Simulator> sim;
  double nearest = 1;  // least singular value of J so far
};

// At rest the posture pulls the pose away by some w₀ λ₂₀ ‖Δq‖/(w λ₂ σ) = 10⁻⁴, and what swings at
// 2 rad/s with a damping ratio of 1 is over in seven seconds.
constexpr double kBack = 1e-2;

TEST(PoseTask, StaysBoundedBeyondTheReachOfTheArmAndComesBack) {
  const RobotModel m = Gen3();
  const JointPosition bent{0.2, 0.6, 0.1, -1.4, 0.1, -0.7, 0.3};
  const JointPosition straight{0.2, 0.9, 0.1, 0, 0.1, 0, 0.3};
  Pose beyond = ToolAt(m, straight);
  const Eigen::Vector3d shoulder(0, 0, 0.2848);
  beyond.position += 0.1 * (beyond.position - shoulder).normalized();
  Loop loop(bent, {{0.2, ToolAt(m, bent)}, {2, beyond}, {2.5, beyond}, {4.5, ToolAt(m, bent)}});
  loop.RunTo(2.5);
  EXPECT_GT(loop.sim->Get(loop.pose->error).tail<3>().norm(), 0.05) << "it was out of reach";
  EXPECT_LT(loop.nearest, 0.03) << "it was to be singular";
  loop.RunTo(12);
  EXPECT_LT(loop.sim->Get(loop.pose->error).norm(), kBack);
  EXPECT_LT(loop.sim->Get(loop.dynamics->dynamics).v.norm(), kBack);
}

TEST(PoseTask, StaysBoundedThroughTheWristSingularityAndComesOut) {
  const RobotModel m = Gen3();
  // With axes 5 and 7 in line a redundant arm is singular if joint 5 stands at a quarter turn too.
  const JointPosition before{0.2, 0.5, 0.1, -1.5, 1.5708, -0.4, 0.2};
  JointPosition behind = before;
  behind(5) = 0.4;
  Loop loop(before, {{0.2, ToolAt(m, before)}, {2, ToolAt(m, behind)}, {4, ToolAt(m, before)}});
  loop.RunTo(4);
  EXPECT_LT(loop.nearest, 0.1) << "it was to be near the singularity";
  loop.RunTo(12);
  EXPECT_LT(loop.sim->Get(loop.pose->error).norm(), kBack);
  EXPECT_LT(loop.sim->Get(loop.dynamics->dynamics).v.norm(), kBack);
}

}  // namespace
}  // namespace pliant
