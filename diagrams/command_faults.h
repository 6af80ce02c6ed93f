#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "pliant/diagrams/fault_order.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/tick_timing.h"

namespace pliant {

/// Faults of our own side, for drills: what goes from a controller to its supervisor passes through
/// here, and is spoilt at the times that are ordered, in seconds of the diagram's clock.
///
///   nan_command    all commands are no number
///   command_jump   torques and currents are off by their limits, positions by 0.1 rad
///   divergence     the estimate of the external torque is off by twice the torque limits
///   overruns       a tick is missed at each tick
class CommandFaults final : public Block {
 public:
  struct Options {
    RobotModel model;            ///< of the controller: torque limits
    JointPosition position;      ///< at the start [rad]
    MotorCurrent current_limit;  ///< [A]
    std::vector<FaultOrder> faults = {};
    Duration period = 1ms;
  };

  explicit CommandFaults(const Options& o)
      : position_command{this, "position_command", o.model.joints(), o.position},
        torque_command{this, "torque_command", o.model.joints()},
        current_command{this, "current_command", o.model.joints()},
        external_torque{this, "external_torque", o.model.joints(),
                        JointTorque::Zero(o.model.joints())},
        timing{this, "timing"},
        spoilt_position{this, "position", o.model.joints()},
        spoilt_torque{this, "torque", o.model.joints()},
        spoilt_current{this, "current", o.model.joints()},
        spoilt_estimate{this, "estimate", o.model.joints()},
        spoilt_timing{this, "spoilt_timing"},
        faults_{o.faults},
        torque_limit_{o.model.effort_limit()},
        current_limit_{o.current_limit},
        period_{seconds(o.period)} {
    const auto rules = Every(o.period);
    rules.Compute(spoilt_position).From(clock, position_command).As(&CommandFaults::Position);
    rules.Compute(spoilt_torque).From(clock, torque_command).As(&CommandFaults::Torque);
    rules.Compute(spoilt_current).From(clock, current_command).As(&CommandFaults::Current);
    rules.Compute(spoilt_estimate).From(clock, external_torque).As(&CommandFaults::Estimate);
    rules.Compute(spoilt_timing).From(clock, timing).As(&CommandFaults::Timing);
  }

  static std::vector<FaultOrder::Kind> Kinds() {
    return {{"nan_command"}, {"command_jump"}, {"divergence"}, {"overruns"}};
  }

  Input<JointPosition> position_command;  ///< the start if not connected
  Input<JointTorque> torque_command;
  Input<MotorCurrent> current_command;
  Input<JointTorque> external_torque;  ///< estimated; 0 if not connected
  Input<TickTiming> timing;

  Output<JointPosition> spoilt_position;
  Output<JointTorque> spoilt_torque;
  Output<MotorCurrent> spoilt_current;
  Output<JointTorque> spoilt_estimate;
  Output<TickTiming> spoilt_timing;

 private:
  static constexpr double kPositionJump = 0.1;  // [rad]

  template <class X>
  X Spoilt(double t, const X& x, const PerJoint& jump) const {
    if (Shows(faults_, "nan_command", t))
      return X(PerJoint::Constant(x.size(), std::numeric_limits<double>::quiet_NaN()));
    return Shows(faults_, "command_jump", t) ? X(x + jump) : x;
  }
  JointPosition Position(double t, const JointPosition& q) const {
    return Spoilt(t, q, PerJoint::Constant(q.size(), kPositionJump));
  }
  JointTorque Torque(double t, const JointTorque& tau) const {
    return Spoilt(t, tau, torque_limit_);
  }
  MotorCurrent Current(double t, const MotorCurrent& i) const {
    return Spoilt(t, i, current_limit_);
  }
  JointTorque Estimate(double t, const JointTorque& tau) const {
    return Shows(faults_, "divergence", t) ? JointTorque(tau + 2 * torque_limit_) : tau;
  }
  TickTiming Timing(double t, const TickTiming& timing) const {
    TickTiming spoilt = timing;
    for (const FaultOrder& fault : faults_)
      if (fault.kind == "overruns" && t >= fault.start_s) {
        const double s = std::min(t - fault.start_s, fault.duration_s);
        spoilt.missed += 1 + static_cast<std::int64_t>(std::llround(s / period_));
      }
    return spoilt;
  }

  const std::vector<FaultOrder> faults_;
  const PerJoint torque_limit_, current_limit_;
  const double period_;
};

}  // namespace pliant
