#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pliant/analysis/replay.h"
#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/diagrams/simulated_arm.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/sine.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/recording_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;

TEST(ReplayOfAnArm, FeedsAnObserverThroughTheModelItReads) {
  // The dynamics are not in the log; they follow from the measured position and velocity.
  const RobotModel model = Gen3();
  const auto make = [&](double gain) {
    LoggedDiagram whole;
    DiagramBuilder& b = whole.builder;
    auto& arm = b.Add<SimulatedArm>("arm", {.model = model,
                                            .position = {0.1, 0.3, 0.2, -1.2, 0.3, 0.8, 0.1},
                                            .engine = SimbodyPlant::Engine::Recursive});
    auto& drive =
        b.Add<Sine<JointTorque>>("drive", {.space = model.joints(),
                                           .amplitude = JointTorque(PerJoint::Constant(7, 2)),
                                           .frequency_hz = 1});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = model});
    auto& observer = b.Add<MomentumObserver>(
        "observer", {.joints = model.joints(), .gain = PerJoint::Constant(7, gain), .period = 1ms});
    auto& logger = b.Add<Logger>("logger", {.period = 1ms});
    b.Connect(drive.y, arm.torque_command);
    b.Connect(arm.measured_position, dynamics.position);
    b.Connect(arm.measured_velocity, dynamics.velocity);
    b.Connect(dynamics.dynamics, observer.dynamics);
    b.Connect(arm.measured_torque, observer.torque);
    b.Connect(arm.measured_position, logger.in);
    b.Connect(arm.measured_velocity, logger.in);
    b.Connect(arm.measured_torque, logger.in);
    b.Connect(observer.residual, logger.in);
    whole.logger = &logger;
    return whole;
  };
  const Recording recorded = RecordingOf(make(50), 0.2);
  const ReplayResult same = Replay(make(50).builder, "observer", recorded);
  EXPECT_TRUE(same.identical()) << same.text();
  EXPECT_THAT(same.compared, ElementsAre("observer.residual"));
  EXPECT_THAT(same.along, ElementsAre("dynamics"));
  EXPECT_EQ(same.rows, 201u);

  // r_0 = 0 whatever the gain: it acts from the second sample on
  const ReplayResult other = Replay(make(60).builder, "observer", recorded);
  ASSERT_EQ(other.differences.size(), 7u);
  for (const SignalDifference& d : other.differences) EXPECT_EQ(d.first_time, 1e-3) << d.element;
}

TEST(ReplayOfAnArm, RunsAControllerWithItsTasksFromMeasuredJoints) {
  // Dynamics, objectives and accelerations are not in the log; the QP starts warm at every tick.
  const RobotModel model = Gen3();
  const auto make = [&](double stiffness) {
    LoggedDiagram whole;
    DiagramBuilder& b = whole.builder;
    const JointPosition start{0.1, 0.3, 0.2, -1.2, 0.3, 0.8, 0.1};
    const std::string tool = "tool_frame";
    RobotDynamics at_start(model, {tool});
    ComputeDynamics(model, start, JointVelocity::Zero(model.joints()), at_start);
    Pose target = at_start.frame[0].pose;
    target.position.x() += 0.02;
    auto& arm = b.Add<SimulatedArm>(
        "arm", {.model = model, .position = start, .engine = SimbodyPlant::Engine::Recursive});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = model, .frames = {tool}});
    auto& pose = b.Add<FrameTask>("pose", {.model = model,
                                           .frame = tool,
                                           .target = target,
                                           .stiffness = TaskVector::Constant(6, stiffness),
                                           .damping = TaskVector::Constant(6, 40),
                                           .weight = 1e4});
    auto& posture = b.Add<PostureTask>("posture", {.model = model,
                                                   .target = start,
                                                   .stiffness = PerJoint::Zero(7),
                                                   .damping = PerJoint::Constant(7, 5)});
    auto& qp = b.Add<ComplianceQp>("qp", {.model = model, .period = 1ms});
    auto& logger = b.Add<Logger>("logger", {.period = 1ms});
    b.Connect(arm.measured_position, dynamics.position);
    b.Connect(arm.measured_velocity, dynamics.velocity);
    b.Connect(dynamics.dynamics, pose.dynamics);
    b.Connect(dynamics.dynamics, posture.dynamics);
    b.Connect(dynamics.dynamics, qp.dynamics);
    b.Connect(pose.objective, qp.objectives);
    b.Connect(posture.objective, qp.objectives);
    b.Connect(qp.torque, arm.torque_command);
    b.Connect(arm.measured_position, logger.in);
    b.Connect(arm.measured_velocity, logger.in);
    b.Connect(qp.torque, logger.in);
    b.Connect(qp.report, logger.in);
    whole.logger = &logger;
    return whole;
  };
  const Recording recorded = RecordingOf(make(400), 0.2);
  const ReplayResult same = Replay(make(400).builder, "qp", recorded);
  EXPECT_TRUE(same.identical()) << same.text();
  EXPECT_THAT(same.compared, ElementsAre("qp.torque", "qp.report"));
  EXPECT_THAT(same.along, ElementsAre("dynamics", "pose", "posture"));
  EXPECT_EQ(same.rows, 201u);
  EXPECT_FALSE(Replay(make(500).builder, "qp", recorded).identical());
}

}  // namespace
}  // namespace pliant
