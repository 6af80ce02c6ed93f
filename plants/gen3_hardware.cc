#include "pliant/plants/gen3_hardware.h"

#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

Gen3Sample Before(const Gen3Hardware::Options& o) {
  if (o.arm) return o.arm->start();
  return {.position = o.position,
          .velocity = JointVelocity::Zero(o.joints),
          .torque = JointTorque::Zero(o.joints),
          .current = MotorCurrent::Zero(o.joints),
          .temperature = JointTemperature::Zero(o.joints),
          .status = {},
          .report = {}};
}

}  // namespace

Gen3Hardware::Gen3Hardware(const Options& o)
    : mode{this, "mode"},
      position_command{this, "position_command", o.joints},
      torque_command{this, "torque_command", o.joints},
      current_command{this, "current_command", o.joints},
      measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints},
      measured_current{this, "measured_current", o.joints},
      temperature{this, "temperature", o.joints},
      status{this, "status"},
      report{this, "report"},
      arm_{o.arm},
      sample_{this, "sample", o.joints, Before(o)} {
  Require(o.joints.size() == kGen3Joints, "joints must be the 7 of a Gen3", o.joints.size());
  RequireOneForEach(o.joints, "position", o.position.size());
  Every(o.period).Compute(sample_).From(sample_).As(&Gen3Hardware::Receive);
  const auto show = [this](const auto& output, auto pick) {
    Compute(output).From(sample_).As(pick);
  };
  show(measured_position, [](const Gen3Sample& s) { return s.position; });
  show(measured_velocity, [](const Gen3Sample& s) { return s.velocity; });
  show(measured_torque, [](const Gen3Sample& s) { return s.torque; });
  show(measured_current, [](const Gen3Sample& s) { return s.current; });
  show(temperature, [](const Gen3Sample& s) { return s.temperature; });
  show(status, [](const Gen3Sample& s) { return s.status; });
  show(report, [](const Gen3Sample& s) { return s.report; });
  Every(o.period)
      .Publish()
      .From(mode, position_command, torque_command, current_command)
      .As(&Gen3Hardware::Send);
}

void Gen3Hardware::Send(const ControlMode& mode, const JointPosition& q_d, const JointTorque& tau_d,
                        const MotorCurrent& i_d) const {
  if (arm_) arm_->Command(mode, q_d, tau_d, i_d);
}

}  // namespace pliant
