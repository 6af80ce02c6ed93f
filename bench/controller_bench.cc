// What a tick of the compliance controller costs, through the framework: measurements in, torque
// out.

#include <benchmark/benchmark.h>

#include <numbers>
#include <string>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/joint_damper.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/joint_sensors.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

/// Tasks of several kinds, the plain pose first.
std::vector<FrameTask::Options> Tasks(const RobotModel& m, int count) {
  const auto gains = [&](FrameTask::Options o, int rows) {
    o.model = m;
    o.stiffness = TaskVector::Constant(rows, 400);
    o.damping = TaskVector::Constant(rows, 40);
    return o;
  };
  using Part = FrameTask::Part;
  using Axes = FrameTask::Axes;
  std::vector<FrameTask::Options> tasks{
      gains({.model = m, .frame = "tool_frame", .weight = 1e4}, 6),
      gains({.model = m, .frame = "forearm_link", .part = Part::Position}, 3),
      gains({.model = m, .frame = "bracelet_link", .part = Part::Orientation}, 3),
      gains({.model = m,
             .frame = "tool_frame",
             .part = Part::Orientation,
             .axes = Axes::Frame,
             .basis = TaskMatrix::Identity(2, 3)},
            2),
      gains({.model = m,
             .frame = "tool_frame",
             .relative_to = "forearm_link",
             .part = Part::Position,
             .axes = Axes::Frame},
            3),
      gains({.model = m,
             .frame = "tool_frame",
             .part = Part::Position,
             .basis = TaskMatrix::Identity(1, 3),
             .mobility = TaskMatrix::Constant(1, 1, 0.5)},
            1)};
  tasks.resize(static_cast<std::size_t>(count), tasks[0]);
  return tasks;
}

/// sensors → dynamics → observer → tasks and posture task, damper → QP, on an arm that sways.
void TickWith(benchmark::State& state, int tasks) {
  const RobotModel m = RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf");
  const Joints& joints = m.joints();
  const JointPosition posture{0, 0.2618, std::numbers::pi,    -2.2689,
                              0, 0.9599, std::numbers::pi / 2};
  const int n = m.size();
  int added = 0;
  RobotDynamics start(m);
  ComputeDynamics(m, posture, JointVelocity::Zero(joints), start);

  DiagramBuilder b;
  auto& q = b.Add<Constant<JointPosition>>("q", {.space = joints, .value = posture});
  auto& v =
      b.Add<Constant<JointVelocity>>("v", {.space = joints, .value = JointVelocity::Zero(joints)});
  auto& tau = b.Add<Constant<JointTorque>>("tau", {.space = joints, .value = start.gravity});
  auto& sensors = b.Add<JointSensors>("sensors", {.joints = joints, .period = 1ms});
  auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m});
  auto& observer = b.Add<MomentumObserver>(
      "observer", {.joints = joints, .gain = PerJoint::Constant(n, 50), .period = 1ms});
  auto& external = b.Add<ExternalAcceleration>("external", {.joints = joints});
  auto& task = b.Add<PostureTask>("posture", {.model = m,
                                              .target = posture,
                                              .stiffness = PerJoint::Zero(n),
                                              .damping = PerJoint::Constant(n, 5),
                                              .compliance = JointMatrix::Identity(n, n)});
  auto& damper = b.Add<JointDamper>("damper", {.model = m});
  auto& qp = b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms});
  b.Connect(q.y, sensors.position);
  b.Connect(v.y, sensors.velocity);
  b.Connect(tau.y, sensors.torque);
  b.Connect(sensors.measured_position, dynamics.position);
  b.Connect(sensors.measured_velocity, dynamics.velocity);
  b.Connect(dynamics.dynamics, observer.dynamics);
  b.Connect(sensors.measured_torque, observer.torque);
  b.Connect(dynamics.dynamics, external.dynamics);
  b.Connect(observer.residual, external.external_torque);
  b.Connect(dynamics.dynamics, task.dynamics);
  b.Connect(external.acceleration, task.external_acceleration);
  b.Connect(dynamics.dynamics, damper.dynamics);
  b.Connect(dynamics.dynamics, qp.dynamics);
  b.Connect(observer.residual, qp.external_torque);
  for (FrameTask::Options options : Tasks(m, tasks)) {
    RobotDynamics at(m, {options.frame});
    ComputeDynamics(m, posture, JointVelocity::Zero(joints), at);
    options.target = at.frame[0].pose;
    if (options.relative_to)
      options.target =
          LinkPose(m, at, m.link_index(*options.relative_to)).inverse() * options.target;
    const std::string name = added == 0 ? "pose" : "task_" + std::to_string(added);
    ++added;
    auto& frame = b.Add<FrameTask>(name, options);
    b.Connect(dynamics.dynamics, frame.dynamics);
    b.Connect(external.acceleration, frame.external_acceleration);
    b.Connect(frame.objective, qp.objectives);
  }
  b.Connect(task.objective, qp.objectives);
  b.Connect(damper.bounds, qp.bounds);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);

  JointPosition now = posture;
  int k = 0;
  for (auto _ : state) {
    now(3) = posture(3) + 1e-6 * (++k % 1000);
    sim.Set(q.value, now);
    sim.AdvanceThroughTick();
    benchmark::DoNotOptimize(sim.Get(qp.torque).data());
  }
  if (sim.Get(qp.report).outcome != ComplianceQpReport::Outcome::Solved)
    state.SkipWithError("the QP found no solution inside all limits");
}

void ControllerTick(benchmark::State& state) { TickWith(state, 1); }
BENCHMARK(ControllerTick)->Name("ControllerTick/Gen3");

void ControllerTickOfTasks(benchmark::State& state) {
  TickWith(state, static_cast<int>(state.range(0)));
}
BENCHMARK(ControllerTickOfTasks)->Name("ControllerTick/Gen3")->ArgName("tasks")->DenseRange(2, 6);

}  // namespace
}  // namespace pliant
