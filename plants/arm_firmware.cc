#include "pliant/plants/arm_firmware.h"

#include <cmath>

#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/elements.h"

namespace pliant {

ArmFirmware::ArmFirmware(const Options& o)
    : mode{this, "mode", {}, o.mode},
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
      .From(state_, work_, mode, position_command, torque_command, current_command, position,
            motor_velocity, torque)
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
                                     const JointPosition& q_d, const JointTorque& tau_d,
                                     const MotorCurrent& i_d, const JointPosition& q,
                                     const JointVelocity& omega, const JointTorque& tau) const {
  State next = last;
  const bool changed = last.fresh || asked != last.mode;
  Lead(next, q_d);
  next.mode = asked;
  next.fresh = false;
  PerJoint g = PerJoint::Zero(q.size());
  if (o_.compensated && asked != ControlMode::Current) {
    ComputeDynamics(*o_.compensated, q, JointVelocity(PerJoint::Zero(q.size())), work);
    g = work.gravity;
  }
  const auto limited = [this](const PerJoint& x) {
    return PerJoint(x.cwiseMin(o_.torque_limit).cwiseMax(-o_.torque_limit));
  };

  PerJoint wanted = PerJoint::Zero(q.size());
  switch (asked) {
    case ControlMode::Position: {
      const double h = seconds(o_.period);
      const PerJoint error = next.reference - q;
      const PerJoint pd = o_.position_stiffness.cwiseProduct(error) +
                          o_.position_damping.cwiseProduct(next.step / h - omega);
      if (changed) next.integral = last.torque - g - pd;
      next.integral = limited(next.integral + h * o_.position_integral.cwiseProduct(error));
      wanted = pd + next.integral + g;
      break;
    }
    case ControlMode::Torque: {
      if (changed)
        for (PerJoint* memory : {&next.e1, &next.e2, &next.y1, &next.y2}) memory->setZero();
      const auto& [b0, b1, b2] = KinovaLag::b;
      const double a1 = KinovaLag::a[1], a2 = KinovaLag::a[2];
      const PerJoint e = tau_d + g - tau;
      const PerJoint y = b0 * e + b1 * next.e1 + b2 * next.e2 - a1 * next.y1 - a2 * next.y2;
      next.e2 = next.e1;
      next.e1 = e;
      next.y2 = next.y1;
      next.y1 = y;
      wanted = o_.torque_feedforward * tau_d + g + o_.torque_feedback * y;
      break;
    }
    case ControlMode::Current:
      wanted = o_.torque_per_ampere.cwiseProduct(i_d);
      break;
  }
  next.torque = limited(wanted);
  next.cut = 0;
  for (Eigen::Index j = 0; j < q.size(); ++j)
    if (std::abs(wanted(j)) > o_.torque_limit(j)) next.cut |= JointBits{1} << j;
  return next;
}

}  // namespace pliant
