#include "pliant/plants/motor_drive.h"

#include <algorithm>

namespace pliant {

MotorDrive::MotorDrive(const Options& o)
    : command{this, "command", o.joints},
      current{this, "current", o.joints},
      torque{this, "torque", o.joints},
      saturated{this, "saturated"} {
  const int n = o.joints.size();
  RequireOneForEach(o.joints, "parameters", std::ssize(o.parameters));
  for (PerJoint* figure : {&i_max_, &tau_max_, &theta_, &per_ampere_}) figure->resize(n);
  for (int j = 0; j < n; ++j) {
    const ActuatorParameters& p = o.parameters[static_cast<std::size_t>(j)];
    RequireInRange(o.joints[j], p);
    i_max_(j) = p.current_limit;
    tau_max_(j) = p.torque_limit;
    theta_(j) = p.current_time_constant;
    per_ampere_(j) = p.torque_per_ampere();
  }

  if ((theta_.array() > 0).any()) {
    i_.emplace(this, "i", o.joints,
               o.current.size() > 0 ? o.current : MotorCurrent::Zero(o.joints));
    Derivative(*i_).From(*i_, command).As(&MotorDrive::Follow);
    Compute(current).From(*i_, command).As(&MotorDrive::Flowing);
  } else {
    Compute(current).From(command).As(&MotorDrive::Clamp);
  }
  Compute(torque).From(current).As(&MotorDrive::Turn);
  Compute(saturated).From(command, current).As(&MotorDrive::Cut);
}

MotorCurrent MotorDrive::Clamp(const MotorCurrent& asked) const {
  return asked.cwiseMin(i_max_).cwiseMax(-i_max_);
}

MotorCurrentRate MotorDrive::Follow(const MotorCurrent& i, const MotorCurrent& asked) const {
  const MotorCurrent within = Clamp(asked);
  MotorCurrentRate rate;
  rate.resize(i.size());
  for (Eigen::Index j = 0; j < i.size(); ++j)
    rate(j) = theta_(j) > 0 ? (within(j) - i(j)) / theta_(j) : 0;
  return rate;
}

MotorCurrent MotorDrive::Flowing(const MotorCurrent& i, const MotorCurrent& asked) const {
  const MotorCurrent within = Clamp(asked);
  MotorCurrent flowing = i;
  for (Eigen::Index j = 0; j < i.size(); ++j)
    if (theta_(j) == 0) flowing(j) = within(j);
  return flowing;
}

JointTorque MotorDrive::Turn(const MotorCurrent& i) const {
  return i.cwiseProduct(per_ampere_).cwiseMin(tau_max_).cwiseMax(-tau_max_);
}

JointBits MotorDrive::Cut(const MotorCurrent& asked, const MotorCurrent& i) const {
  JointBits bits = 0;
  for (Eigen::Index j = 0; j < i.size(); ++j)
    if (std::abs(asked(j)) > i_max_(j) || std::abs(i(j) * per_ampere_(j)) > tau_max_(j))
      bits |= JointBits{1} << j;
  return bits;
}

}  // namespace pliant
