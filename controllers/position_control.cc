#include "pliant/controllers/position_control.h"

#include <algorithm>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

PerJoint Clamped(const PerJoint& x, const PerJoint& most) {
  return x.cwiseMin(most).cwiseMax(-most);
}

}  // namespace

PositionControl::PositionControl(const Options& o)
    : reference{this, "reference", o.joints},
      reference_velocity{this, "reference_velocity", o.joints, JointVelocity::Zero(o.joints)},
      reference_acceleration{this, "reference_acceleration", o.joints,
                             JointAcceleration::Zero(o.joints)},
      dynamics{this, "dynamics", o.joints},
      acceleration{this, "acceleration", o.joints},
      torque{this, "torque", o.joints},
      saturated{this, "saturated"},
      o_{o},
      h_{seconds(o.period)},
      demand_{this, "demand", o.joints},
      asked_{this, "asked", o.joints},
      I_{this, "I", o.joints} {
  RequireEachInRange("stiffness", o.stiffness, "1/s²", kNotNegative, o.joints);
  RequireEachInRange("damping", o.damping, "1/s", kNotNegative, o.joints);
  RequireEachInRange("integral", o.integral, "1/s³", kNotNegative, o.joints);
  RequireEachInRange("acceleration_limit", o.acceleration_limit, "rad/s²", kLimit, o.joints);
  RequireEachInRange("torque_limit", o.torque_limit, "N·m", kLimit, o.joints);

  const PeriodicEvent tick = Every(o.period);
  tick.Compute(demand_)
      .From(reference, reference_velocity, reference_acceleration, dynamics, I_)
      .As(&PositionControl::Demand);
  tick.Compute(acceleration).From(demand_).As(&PositionControl::Bounded);
  tick.Compute(asked_).From(dynamics, acceleration).As(&InverseDynamics);
  tick.Compute(torque).From(asked_).As(&PositionControl::Deliverable);
  tick.Compute(saturated).From(demand_, asked_).As(&PositionControl::Cut);
  tick.Update(I_).From(I_, reference, dynamics, demand_, asked_).As(&PositionControl::Integrate);
}

JointAcceleration PositionControl::Demand(const JointPosition& r, const JointVelocity& r_dot,
                                          const JointAcceleration& a_r, const RobotDynamics& d,
                                          const JointAcceleration& I) const {
  return a_r + o_.stiffness.cwiseProduct(r - d.q) + o_.damping.cwiseProduct(r_dot - d.v) + I;
}

JointAcceleration PositionControl::Bounded(const JointAcceleration& demand) const {
  return Clamped(demand, o_.acceleration_limit);
}

JointTorque PositionControl::Deliverable(const JointTorque& asked) const {
  return Clamped(asked, o_.torque_limit);
}

JointAcceleration PositionControl::Integrate(const JointAcceleration& I, const JointPosition& r,
                                             const RobotDynamics& d,
                                             const JointAcceleration& demand,
                                             const JointTorque& asked) const {
  const auto winds_up = [](double e, double x, double most) {
    return std::abs(x) > most && x * e > 0;
  };
  JointAcceleration next = I;
  for (Eigen::Index j = 0; j < I.size(); ++j) {
    const double e = r(j) - d.q(j), a_max = o_.acceleration_limit(j);
    if (!std::isfinite(e)) continue;  // else one bad sample would stay for good
    if (winds_up(e, demand(j), a_max) || winds_up(e, asked(j), o_.torque_limit(j))) continue;
    next(j) = std::clamp(I(j) + h_ * o_.integral(j) * e, -a_max, a_max);
  }
  return next;
}

JointBits PositionControl::Cut(const JointAcceleration& demand, const JointTorque& asked) const {
  JointBits cut = 0;
  for (Eigen::Index j = 0; j < demand.size(); ++j)
    if (std::abs(demand(j)) > o_.acceleration_limit(j) || std::abs(asked(j)) > o_.torque_limit(j))
      cut |= JointBits{1} << j;
  return cut;
}

}  // namespace pliant
