#include "pliant/diagrams/compliance_control.h"

#include "pliant/systems/constant.h"

namespace pliant {

namespace {

/// A task's error and its rate as what they are of a pose.
class PoseErrors final : public Block {
 public:
  PoseErrors() {
    Compute(error).From(task_error).As([](const TaskVector& e) { return PoseError(e); });
    Compute(rate).From(task_error_rate).As([](const TaskVector& e) { return Twist(e); });
  }
  Input<TaskVector> task_error{this, "task_error"};
  Input<TaskVector> task_error_rate{this, "task_error_rate"};
  Output<PoseError> error{this, "error"};
  Output<Twist> rate{this, "rate"};
};

}  // namespace

ComplianceControl::ComplianceControl(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      true_torque{this, "true_torque", o.model.joints(), JointTorque::Zero(o.model.joints())},
      torque{this, "torque", o.model.joints()},
      current{this, "current", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      residual{this, "residual", o.model.joints()},
      pose_error{this, "pose_error"},
      pose_error_rate{this, "pose_error_rate"},
      posture_error{this, "posture_error", o.model.joints()},
      report{this, "report"} {
  const Joints& joints = o.model.joints();
  const int n = o.model.size();
  const std::vector<std::string> frames{o.tool};
  RequireOneForEach(joints, "position", o.position.size());
  RobotDynamics start(o.model, frames);
  ComputeDynamics(o.model, o.position, JointVelocity::Zero(joints), start);

  auto& dynamics = Add<ModelDynamics>(
      "dynamics", {.model = o.model, .frames = frames, .rotor_inertia = o.rotor_inertia});
  auto& observer =
      Add<MomentumObserver>("observer", {.joints = joints,
                                         .gain = PerJoint::Constant(n, o.observer_gain),
                                         .period = o.period,
                                         .rotor_inertia = o.rotor_inertia});
  auto& external = Add<ExternalAcceleration>("external", {.joints = joints});
  auto& pose =
      Add<FrameTask>("pose", {.model = o.model,
                              .frame = o.tool,
                              .target = start.frame[0].pose,
                              .stiffness = TaskVector::Constant(6, o.pose.stiffness),
                              .damping = TaskVector::Constant(6, o.pose.damping),
                              .weight = o.pose.weight,
                              .compliance = o.pose.compliance * TaskMatrix::Identity(6, 6)});
  auto& posture = Add<PostureTask>(
      "posture", {.model = o.model,
                  .target = o.position,
                  .stiffness = PerJoint::Constant(n, o.posture.stiffness),
                  .damping = PerJoint::Constant(n, o.posture.damping),
                  .weight = o.posture.weight,
                  .compliance = o.posture.compliance * JointMatrix::Identity(n, n)});
  JointDamper::Options limits = o.damper;
  limits.model = o.model;
  auto& damper = Add<JointDamper>("damper", limits);
  auto& qp = Add<ComplianceQp>("qp", {.model = o.model, .period = o.period});

  Connect(measured_position, dynamics.position);
  Connect(measured_velocity, dynamics.velocity);
  Connect(dynamics.dynamics, observer.dynamics);
  Connect(measured_torque, observer.torque);
  Connect(dynamics.dynamics, external.dynamics);
  Connect(dynamics.dynamics, pose.dynamics);
  Connect(dynamics.dynamics, posture.dynamics);
  Connect(dynamics.dynamics, damper.dynamics);
  Connect(dynamics.dynamics, qp.dynamics);
  if (o.estimate != TorqueEstimate::Zero) {
    const auto estimate_from = [&](const auto& estimate) {
      Connect(estimate, external.external_torque);
      Connect(estimate, qp.external_torque);
    };
    if (o.estimate == TorqueEstimate::True)
      estimate_from(true_torque);
    else
      estimate_from(observer.residual);
    Connect(external.acceleration, pose.external_acceleration);
    Connect(external.acceleration, posture.external_acceleration);
  }
  Connect(pose.objective, qp.objectives);
  Connect(posture.objective, qp.objectives);
  Connect(damper.bounds, qp.bounds);
  Connect(qp.torque, torque);
  Connect(qp.acceleration, acceleration);
  Connect(observer.residual, residual);
  auto& errors = Add<PoseErrors>("pose_errors");
  Connect(pose.error, errors.task_error);
  Connect(pose.error_rate, errors.task_error_rate);
  Connect(errors.error, pose_error);
  Connect(errors.rate, pose_error_rate);
  Connect(posture.error, posture_error);
  Connect(qp.report, report);
  if (o.low_level) {
    auto& low_level = Add<LowLevelTorque>("low_level", *o.low_level);
    Connect(qp.torque, low_level.torque);
    Connect(qp.acceleration, low_level.acceleration);
    Connect(measured_velocity, low_level.measured_velocity);
    Connect(measured_torque, low_level.measured_torque);
    Connect(low_level.current, current);
  } else {
    auto& none = Add<Constant<MotorCurrent>>(
        "low_level", {.space = joints, .value = MotorCurrent::Zero(joints)});
    Connect(none.y, current);
  }
}

}  // namespace pliant
