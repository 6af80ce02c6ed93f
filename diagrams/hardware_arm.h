#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pliant/controllers/operator_panel.h"
#include "pliant/diagrams/fault_order.h"
#include "pliant/plants/friction_file.h"
#include "pliant/plants/gen3_hardware.h"
#include "pliant/plants/hardware_wrench.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// A wrist sensor that sends RDT records over UDP.
struct RdtWrist {
  static constexpr const char* kTag = "Rdt";

  std::string host;
  int port = 49152;
  double counts_per_newton = 1e6;
  double counts_per_newton_meter = 1e6;

  template <class F>
  void Parameters(F&& f) {
    f("host", host);
    f("port", port, "", Between(1, 65535));
    f("counts_per_newton", counts_per_newton, "1/N", kPositive);
    f("counts_per_newton_meter", counts_per_newton_meter, "1/(N·m)", kPositive);
  }
};

/// A Bota sensor at a serial port.
struct BotaWrist {
  static constexpr const char* kTag = "Bota";

  std::string device;  ///< such as /dev/ttyUSB0

  template <class F>
  void Parameters(F&& f) {
    f("device", device);
  }
};

/// A Kinova Gen3 that is there, or an emulated one.
struct Gen3Station {
  static constexpr const char* kTag = "Gen3";

  std::string address = "192.168.1.10";  ///< HOST[:TCP[,UDP]]
  std::optional<std::variant<RdtWrist, BotaWrist>> wrist = {};
  std::vector<IdentifiedFriction> friction = {};  ///< instead of that of the model's file
  bool clear_faults = false;                      ///< before the start
  bool lock_step = false;                         ///< an emulator that waits for each frame
  int frozen_after = 50;                          ///< as Gen3Arm has it
  /// q at the start [rad]: a run measures it and writes it down.
  JointPosition position = {};

  template <class F>
  void Parameters(F&& f) {
    f("address", address);
    f("wrist", wrist);
    f("friction", friction);
    f("clear_faults", clear_faults);
    f("lock_step", lock_step);
    f("frozen_after", frozen_after, "", Between(0, 1e6));
    f("position", position, "rad");
  }
};

/// What a diagram is connected to, where it runs an arm. All null: a diagram to draw, to check or
/// to replay.
struct Hardware {
  std::shared_ptr<Gen3Arm> arm = {};
  std::shared_ptr<WrenchSource> wrist = {};
  Wrench wrist_bias = {};  ///< what the sensor shows beside the weight of what hangs on it
  std::shared_ptr<const TickTimes> times = {};
  std::shared_ptr<OperatorPanel> panel = {};
  std::vector<FaultOrder> faults = {};  ///< of our own side: command_faults.h
};

/// An arm that is there, behind the ports of SimulatedArm:
///
///   mode, commands ─▶ gen3 ─▶ measured_…, status
///                     wrist ─▶ wrench, wrench_valid
class HardwareArm final : public Composite {
 public:
  struct Options {
    RobotModel model;
    JointPosition position;        ///< at the start [rad]
    std::string wrist_frame = {};  ///< of the wrist sensor; empty: there is none
    Wrench wrist_range = {};       ///< largest reading; 0: any
    Hardware hardware = {};
    Duration period = 1ms;
  };

  explicit HardwareArm(const Options& o);

  Input<ControlMode> mode;
  Input<JointPosition> position_command;
  Input<JointTorque> torque_command;
  Input<MotorCurrent> current_command;

  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;
  Output<MotorCurrent> measured_current;
  Output<JointTemperature> temperature;
  Output<Wrench> wrench;  ///< in the wrist sensor's frame; 0 without one
  Output<bool> wrench_valid;
  Output<WrenchStatus> wrench_status;
  Output<ArmStatus> status;
  Output<Gen3Report> report;
};

}  // namespace pliant
