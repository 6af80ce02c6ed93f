#include "pliant/plants/motor_drive.h"

#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

MotorDrive::MotorDrive(const Options& o)
    : command{this, "command", o.joints},
      current{this, "current", o.joints},
      torque{this, "torque", o.joints},
      saturated{this, "saturated"},
      i_max_{FiguresOf(Checked(o.joints, o.parameters), &ActuatorParameters::current_limit)},
      tau_max_{FiguresOf(o.parameters, &ActuatorParameters::torque_limit)},
      theta_{FiguresOf(o.parameters, &ActuatorParameters::current_time_constant)},
      per_ampere_{FiguresOf(o.parameters, &ActuatorParameters::torque_per_ampere)},
      start_{this, "start", {}, AtRest(o)} {
  Every(o.period)
      .Update(start_)
      .From(current, command, clock)
      .As([](const MotorCurrent& i, const MotorCurrent& c, double t) {
        return Start{i, c, t};
      });
  Compute(current).From(clock, start_).As(&MotorDrive::Flow);
  Compute(torque).From(current).As(&MotorDrive::Turn);
  Compute(saturated).From(start_, current).As(&MotorDrive::Cut);
}

MotorDrive::Start MotorDrive::AtRest(const Options& o) {
  const MotorCurrent i = EachInRangeOr0("current", o.current, "A", kAnyNumber, o.joints);
  return {i, i, 0};
}

MotorCurrent MotorDrive::Flow(double t, const Start& start) const {
  MotorCurrent i = start.c.cwiseMin(i_max_).cwiseMax(-i_max_);
  double left = 0;
  for (Eigen::Index j = 0; j < i.size(); ++j) {
    if (theta_(j) == 0) continue;
    if (j == 0 || theta_(j) != theta_(j - 1)) left = std::exp(-(t - start.t) / theta_(j));
    i(j) += left * (start.i(j) - i(j));
  }
  return i;
}

JointTorque MotorDrive::Turn(const MotorCurrent& i) const {
  return i.cwiseProduct(per_ampere_).cwiseMin(tau_max_).cwiseMax(-tau_max_);
}

JointBits MotorDrive::Cut(const Start& start, const MotorCurrent& i) const {
  JointBits bits = 0;
  for (Eigen::Index j = 0; j < i.size(); ++j)
    if (std::abs(start.c(j)) > i_max_(j) || std::abs(i(j) * per_ampere_(j)) > tau_max_(j))
      bits |= JointBits{1} << j;
  return bits;
}

}  // namespace pliant
