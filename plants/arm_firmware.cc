#include "pliant/plants/arm_firmware.h"

#include <algorithm>
#include <cmath>

#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/elements.h"

namespace pliant {

ArmFirmware::ArmFirmware(const Options& o)
    : mode{this, "mode", {}, o.mode},
      joint_modes{this, "joint_modes", {}, JointModes{}},
      position_command{this, "position_command", o.joints, JointPosition::Zero(o.joints)},
      torque_command{this, "torque_command", o.joints, JointTorque::Zero(o.joints)},
      current_command{this, "current_command", o.joints, MotorCurrent::Zero(o.joints)},
      position{this, "position", o.joints},
      motor_velocity{this, "motor_velocity", o.joints},
      torque{this, "torque", o.joints},
      current{this, "current", o.joints},
      active{this, "active"},
      cut{this, "cut"},
      o_{o},
      steps_{o.command_period == Duration{}
                 ? 1
                 : static_cast<int>(std::lround(seconds(o.command_period) / seconds(o.period)))},
      state_{this, "state", {}, AtRest(o)},
      work_{this, "work", o.compensated ? RobotDynamics(*o.compensated) : RobotDynamics()} {
  RequireEachInRange("torque_per_ampere", o.torque_per_ampere, "N·m/A", kPositive, o.joints);
  RequireEachInRange("position_stiffness", o.position_stiffness, "N·m/rad", kNotNegative, o.joints);
  RequireEachInRange("position_damping", o.position_damping, "N·m·s/rad", kNotNegative, o.joints);
  RequireEachInRange("position_integral", o.position_integral, "N·m/(rad·s)", kNotNegative,
                     o.joints);
  RequireEachInRange("torque_limit", o.torque_limit, "N·m", kLimit, o.joints);
  RequireInRange("", "torque_feedforward", o.torque_feedforward, "", kNotNegative);
  RequireInRange("", "torque_feedback", o.torque_feedback, "", kNotNegative);
  RequireInRange("", "torque_damping", o.torque_damping, "N·m·s/rad", kNotNegative);
  Require(o.torque_feedback == 0 || o.period == KinovaLag::period,
          "period must be " + KinovaLag::period.text() +
              " where torque_feedback is > 0: H is made for it",
          o.period.text());
  Require(!o.compensated || o.compensated->joints() == o.joints,
          "compensated must be a model of the arm's joints");
  Require(steps_ >= 1 && Duration::Nanoseconds(o.period.Times(steps_)) ==
                             (o.command_period == Duration{} ? o.period : o.command_period),
          "command_period must be a multiple of period = " + o.period.text(),
          o.command_period.text());

  Every(o.period)
      .Compute(state_)
      .From(state_, work_, mode, joint_modes, position_command, torque_command, current_command,
            position, motor_velocity, torque)
      .As(&ArmFirmware::Next);
  Compute(current).From(state_).As(&ArmFirmware::Current);
  Compute(active).From(state_).As([](const State& s) { return s.mode; });
  Compute(cut).From(state_).As([](const State& s) { return s.cut; });
}

ArmFirmware::State ArmFirmware::AtRest(const Options& o) {
  const PerJoint none = PerJoint::Zero(o.joints.size());
  return {.mode = o.mode,
          .torque = EachInRangeOr0("load", o.load, "N·m", kAnyNumber, o.joints),
          .integral = none,
          .position_command = none,
          .reference = none,
          .step = none,
          .e1 = none,
          .e2 = none,
          .y1 = none,
          .y2 = none};
}

/// r, on its way from one command to the next.
void ArmFirmware::Lead(State& next, const JointPosition& q_d) const {
  if (next.fresh) {
    next.reference = q_d;
    next.step.setZero();
  } else if (q_d != next.position_command) {
    next.step = (q_d - next.reference) / steps_;
    next.steps = steps_;
  }
  next.position_command = q_d;
  if (next.steps == 0) {
    next.step.setZero();
    return;
  }
  --next.steps;
  if (next.steps == 0)
    next.reference = q_d;
  else
    next.reference += next.step;
}

ArmFirmware::State ArmFirmware::Next(const State& last, RobotDynamics& work, ControlMode asked,
                                     const JointModes& own, const JointPosition& q_d,
                                     const JointTorque& tau_d, const MotorCurrent& i_d,
                                     const JointPosition& q, const JointVelocity& omega,
                                     const JointTorque& tau) const {
  State next = last;
  Lead(next, q_d);
  next.mode = asked;
  next.fresh = false;
  next.cut = 0;
  PerJoint g = PerJoint::Zero(q.size());
  if (o_.compensated) {
    ComputeDynamics(*o_.compensated, q, JointVelocity(PerJoint::Zero(q.size())), work);
    g = work.gravity;
  }
  const double h = seconds(o_.period);
  const auto& [b0, b1, b2] = KinovaLag::b;
  const double a1 = KinovaLag::a[1], a2 = KinovaLag::a[2];
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const auto limited = [limit = o_.torque_limit(j)](double x) {
      return std::max(std::min(x, limit), -limit);
    };
    ControlMode& mode = next.joint_mode[static_cast<std::size_t>(j)];
    const bool changed = last.fresh || own.Of(static_cast<int>(j), asked) != mode;
    mode = own.Of(static_cast<int>(j), asked);
    double wanted = 0;
    switch (mode) {
      case ControlMode::Position: {
        const double error = next.reference(j) - q(j);
        const double pd = o_.position_stiffness(j) * error +
                          o_.position_damping(j) * (next.step(j) / h - omega(j));
        double& integral = next.integral(j);
        if (changed) integral = last.torque(j) - g(j) - pd;
        integral = limited(integral + h * (o_.position_integral(j) * error));
        wanted = pd + integral + g(j);
        break;
      }
      case ControlMode::Torque:
      case ControlMode::TorqueHighVelocity: {
        double &e1 = next.e1(j), &e2 = next.e2(j), &y1 = next.y1(j), &y2 = next.y2(j);
        if (changed) e1 = e2 = y1 = y2 = 0;
        const double e = tau_d(j) + g(j) - tau(j);
        const double y = b0 * e + b1 * e1 + b2 * e2 - a1 * y1 - a2 * y2;
        e2 = e1;
        e1 = e;
        y2 = y1;
        y1 = y;
        wanted = o_.torque_feedforward * tau_d(j) + g(j) + o_.torque_feedback * y;
        if (mode == ControlMode::Torque) wanted -= o_.torque_damping * omega(j);
        break;
      }
      case ControlMode::Current:
        wanted = o_.torque_per_ampere(j) * i_d(j);
        break;
    }
    next.torque(j) = limited(wanted);
    if (std::abs(wanted) > o_.torque_limit(j)) next.cut |= JointBits{1} << j;
  }
  return next;
}

}  // namespace pliant
