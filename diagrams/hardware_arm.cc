#include "pliant/diagrams/hardware_arm.h"

namespace pliant {

HardwareArm::HardwareArm(const Options& o)
    : mode{this, "mode"},
      position_command{this, "position_command", o.model.joints()},
      torque_command{this, "torque_command", o.model.joints()},
      current_command{this, "current_command", o.model.joints()},
      measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      measured_current{this, "measured_current", o.model.joints()},
      temperature{this, "temperature", o.model.joints()},
      wrench{this, "wrench", Frame(o.wrist_frame)},
      wrench_valid{this, "wrench_valid"},
      wrench_status{this, "wrench_status"},
      status{this, "status"},
      report{this, "report"} {
  auto& gen3 = Add<Gen3Hardware>("gen3", {.joints = o.model.joints(),
                                          .position = o.position,
                                          .arm = o.hardware.arm,
                                          .period = o.period});
  auto& wrist = Add<HardwareWrench>("wrist", {.source = o.hardware.wrist,
                                              .frame = o.wrist_frame,
                                              .period = o.period,
                                              .bias = o.hardware.wrist_bias,
                                              .range = o.wrist_range});

  Connect(mode, gen3.mode);
  Connect(position_command, gen3.position_command);
  Connect(torque_command, gen3.torque_command);
  Connect(current_command, gen3.current_command);
  Connect(gen3.measured_position, measured_position);
  Connect(gen3.measured_velocity, measured_velocity);
  Connect(gen3.measured_torque, measured_torque);
  Connect(gen3.measured_current, measured_current);
  Connect(gen3.temperature, temperature);
  Connect(gen3.status, status);
  Connect(gen3.report, report);
  Connect(wrist.wrench, wrench);
  Connect(wrist.valid, wrench_valid);
  Connect(wrist.status, wrench_status);
}

}  // namespace pliant
