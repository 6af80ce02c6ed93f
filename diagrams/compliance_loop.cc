#include "pliant/diagrams/compliance_loop.h"

#include "pliant/systems/constant.h"

namespace pliant {

namespace {

/// Of the controller: that of the arm's interface.
Duration PeriodOf(const ComplianceLoop::Options& o) {
  return o.arm.interface_period == Duration{} ? o.arm.period : o.arm.interface_period;
}

/// A push that changes at the controller's ticks only, so that the true torque is what acts.
Push::Options Sampled(Push::Options push, const ComplianceLoop::Options& o) {
  push.period = PeriodOf(o);
  return push;
}

}  // namespace

ComplianceLoop::ComplianceLoop(const Options& o) : diagram{Make(o, *this)} {}

Diagram ComplianceLoop::Make(const Options& o, ComplianceLoop& parts) {
  const Joints& joints = o.model.joints();
  const int n = o.model.size();
  const std::vector<std::string> frames{o.tool};
  RobotDynamics start(o.model, frames);
  ComputeDynamics(o.model, o.arm.position, JointVelocity::Zero(joints), start);
  const Duration period = PeriodOf(o);
  const PerJoint rotors = o.arm.actuators.reflected_inertia();

  Require(!o.arm.firmware.compensated,
          "the arm must not carry its own weight: the controller commands gravity; reset "
          "arm.firmware.compensated");
  DiagramBuilder b;
  for (std::size_t i = 0; i < o.pushes.size(); ++i)
    parts.pushes.push_back(&b.Add<Push>("push_" + std::to_string(i + 1), Sampled(o.pushes[i], o)));
  auto& arm = b.Add<SimulatedArm>("arm", o.arm);
  auto& dynamics = b.Add<ModelDynamics>(
      "dynamics", {.model = o.model, .frames = frames, .rotor_inertia = rotors});
  auto& link_dynamics = b.Add<ModelDynamics>("link_dynamics", {.model = o.model});
  auto& true_torque = b.Add<ContactTorque>("true_torque", {.model = o.model});
  auto& observer = b.Add<MomentumObserver>(
      "observer",
      {.joints = joints, .gain = PerJoint::Constant(n, o.observer_gain), .period = period});
  auto& external = b.Add<ExternalAcceleration>("external", {.joints = joints});
  auto& pose =
      b.Add<FrameTask>("pose", {.model = o.model,
                                .frame = o.tool,
                                .target = start.frame[0].pose,
                                .stiffness = TaskVector::Constant(6, o.pose_stiffness),
                                .damping = TaskVector::Constant(6, o.pose_damping),
                                .weight = o.pose_weight,
                                .compliance = o.pose_compliance * TaskMatrix::Identity(6, 6)});
  auto& posture = b.Add<PostureTask>(
      "posture", {.model = o.model,
                  .target = o.arm.position,
                  .stiffness = PerJoint::Constant(n, o.posture_stiffness),
                  .damping = PerJoint::Constant(n, o.posture_damping),
                  .weight = o.posture_weight,
                  .compliance = o.posture_compliance * JointMatrix::Identity(n, n)});
  auto& damper = b.Add<JointDamper>("damper", o.damper);
  auto& qp = b.Add<ComplianceQp>("qp", {.model = o.model, .period = period});

  auto& logger = b.Add<Logger>("logger", {.period = period, .capacity = o.log_rows});

  for (Push* push : parts.pushes) {
    b.Connect(push->force, logger.in);
    b.Connect(push->force, arm.contacts);
    b.Connect(push->force, true_torque.contacts);
  }
  b.Connect(arm.measured_position, dynamics.position);
  b.Connect(arm.measured_velocity, dynamics.velocity);
  b.Connect(dynamics.dynamics, true_torque.dynamics);
  b.Connect(arm.measured_position, link_dynamics.position);
  b.Connect(arm.measured_velocity, link_dynamics.velocity);
  b.Connect(link_dynamics.dynamics, observer.dynamics);
  b.Connect(arm.measured_torque, observer.torque);
  b.Connect(dynamics.dynamics, external.dynamics);
  b.Connect(dynamics.dynamics, pose.dynamics);
  b.Connect(dynamics.dynamics, posture.dynamics);
  b.Connect(dynamics.dynamics, damper.dynamics);
  b.Connect(dynamics.dynamics, qp.dynamics);
  if (o.estimate != TorqueEstimate::Zero) {
    const Output<JointTorque>& estimate =
        o.estimate == TorqueEstimate::True ? true_torque.torque : observer.residual;
    b.Connect(estimate, external.external_torque);
    b.Connect(estimate, qp.external_torque);
    b.Connect(external.acceleration, pose.external_acceleration);
    b.Connect(external.acceleration, posture.external_acceleration);
  }
  b.Connect(pose.objective, qp.objectives);
  b.Connect(posture.objective, qp.objectives);
  b.Connect(damper.bounds, qp.bounds);
  if (o.low_level) {
    auto& low_level = b.Add<LowLevelTorque>("low_level", *o.low_level);
    auto& mode = b.Add<Constant<ControlMode>>("mode", {.value = ControlMode::Current});
    b.Connect(mode.y, arm.mode);
    b.Connect(qp.torque, low_level.torque);
    b.Connect(qp.acceleration, low_level.acceleration);
    b.Connect(arm.measured_velocity, low_level.measured_velocity);
    b.Connect(arm.measured_torque, low_level.measured_torque);
    b.Connect(low_level.current, arm.current_command);
    parts.low_level = &low_level;
  } else {
    b.Connect(qp.torque, arm.torque_command);
  }
  b.Connect(arm.measured_position, logger.in);
  b.Connect(arm.measured_velocity, logger.in);
  b.Connect(true_torque.torque, logger.in);
  b.Connect(observer.residual, logger.in);
  b.Connect(pose.error, logger.in);
  b.Connect(pose.error_rate, logger.in);
  b.Connect(qp.torque, logger.in);
  b.Connect(qp.report, logger.in);

  parts.arm = &arm;
  parts.dynamics = &dynamics;
  parts.link_dynamics = &link_dynamics;
  parts.true_torque = &true_torque;
  parts.observer = &observer;
  parts.pose = &pose;
  parts.posture = &posture;
  parts.damper = &damper;
  parts.qp = &qp;
  parts.logger = &logger;
  return b.Build();
}

}  // namespace pliant
