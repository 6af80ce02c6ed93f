#include "pliant/plants/arm_firmware.h"

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
      o_{o},
      state_{this,
             "state",
             {},
             State{.mode = o.mode,
                   .torque = EachInRangeOr0("load", o.load, "N·m", kAnyNumber, o.joints),
                   .integral = JointTorque::Zero(o.joints),
                   .position_command = JointPosition::Zero(o.joints),
                   .e1 = PerJoint::Zero(o.joints.size()),
                   .e2 = PerJoint::Zero(o.joints.size()),
                   .y1 = PerJoint::Zero(o.joints.size()),
                   .y2 = PerJoint::Zero(o.joints.size())}},
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

  Every(o.period)
      .Update(state_)
      .From(state_, work_, mode, position_command, torque_command, current_command, position,
            motor_velocity, torque)
      .As(&ArmFirmware::Next);
  Compute(current).From(state_).As(&ArmFirmware::Current);
  Compute(active).From(state_).As([](const State& s) { return s.mode; });
}

void ArmFirmware::Next(State& next, const State& last, RobotDynamics& work, ControlMode asked,
                       const JointPosition& q_d, const JointTorque& tau_d, const MotorCurrent& i_d,
                       const JointPosition& q, const JointVelocity& omega,
                       const JointTorque& tau) const {
  next = last;
  next.mode = asked;
  next.fresh = false;
  next.position_command = q_d;
  const auto limited = [this](const PerJoint& x) {
    return PerJoint(x.cwiseMin(o_.torque_limit).cwiseMax(-o_.torque_limit));
  };
  const bool changed = last.fresh || asked != last.mode;
  PerJoint g = PerJoint::Zero(q.size());
  if (o_.compensated && asked != ControlMode::Current) {
    ComputeDynamics(*o_.compensated, q, JointVelocity(PerJoint::Zero(q.size())), work);
    g = work.gravity;
  }

  switch (asked) {
    case ControlMode::Position: {
      const double h = seconds(o_.period);
      const PerJoint error = q_d - q;
      if (changed) next.integral = last.torque - g;
      next.integral = limited(next.integral + h * o_.position_integral.cwiseProduct(error));
      PerJoint velocity_command = PerJoint::Zero(q.size());
      if (!changed) velocity_command = (q_d - last.position_command) / h;
      next.torque = o_.position_stiffness.cwiseProduct(error) +
                    o_.position_damping.cwiseProduct(velocity_command - omega) + next.integral + g;
      break;
    }
    case ControlMode::Torque: {
      if (changed)
        for (PerJoint* memory : {&next.e1, &next.e2, &next.y1, &next.y2}) memory->setZero();
      const PerJoint e = tau_d + g - tau;
      const auto& [b0, b1, b2] = KinovaLag::b;
      const double a1 = KinovaLag::a[1], a2 = KinovaLag::a[2];
      const PerJoint y = b0 * e + b1 * next.e1 + b2 * next.e2 - a1 * next.y1 - a2 * next.y2;
      next.e2 = next.e1;
      next.e1 = e;
      next.y2 = next.y1;
      next.y1 = y;
      next.torque = o_.torque_feedforward * tau_d + g + o_.torque_feedback * y;
      break;
    }
    case ControlMode::Current:
      next.torque = o_.torque_per_ampere.cwiseProduct(i_d);
      break;
  }
  next.torque = limited(next.torque);
}

}  // namespace pliant
