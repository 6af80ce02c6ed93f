#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/plants/actuators.h"
#include "pliant/plants/arm_firmware.h"
#include "pliant/plants/joint_sensors.h"
#include "pliant/plants/joint_stops.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/plants/wrist_sensor.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// A simulated arm behind the ports of a real one: a mode and commands in; samples of its sensors
/// out.
///
///   mode, commands ─▶ firmware ─▶ actuators ─▶ plant ─▶ sensors ─▶ measured_…
///                        ▲            ▲          │ ▲        │
///                        │            └──────────┘ └─ contacts, loads
///                        └──────────────────────────────────┘
///
/// The commands of tick k act from tick k to tick k + 1, so the sensors of tick k see those of tick
/// k − 1. With `actuators` left out they are ideal: in torque mode, which is the one at first, the
/// torque command acts on the links.
class SimulatedArm final : public Composite {
 public:
  struct Options {
    RobotModel model;
    JointPosition position;              ///< q at the start [rad]
    JointVelocity velocity = {};         ///< v at the start [rad/s]; empty: at rest
    PerJoint damping = {};               ///< of the links' bearings [N·m·s/rad]; empty: none
    ArmActuators actuators = {};         ///< without joints: ideal, without rotors
    JointSensors::Options sensors = {};  ///< joints and period are filled in
    ArmFirmware::Options firmware = {};  ///< as above, also κ, limits, load and gains left empty
    std::optional<WristSensor::Options> wrist = {};  ///< none: `wrench` stays zero
    std::optional<JointStops::Options> stops = {};   ///< none: joints turn beyond their limits
    std::vector<std::string> frames = {};  ///< links shown by `motion`, at most kMaxFrames
    SimbodyPlant::Engine engine = SimbodyPlant::Engine::Simbody;
    Duration period = 1ms;           ///< of firmware and sensors
    Duration interface_period = {};  ///< of commands and measurements outside; 0: the same
  };

  explicit SimulatedArm(const Options& o);

  Input<ControlMode> mode;
  Input<JointModes> joint_modes;
  Input<JointPosition> position_command;
  Input<JointTorque> torque_command;
  Input<MotorCurrent> current_command;
  InputList<ContactForce> contacts;
  InputList<JointTorque> loads;  ///< on the links

  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;
  Output<MotorCurrent> measured_current;
  Output<Wrench> wrench;  ///< in the wrist sensor's frame
  Output<bool> wrench_valid;
  Output<ArmStatus> status;

  Output<JointPosition> position;  ///< what the plant does, not what sensors say of it
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Output<RobotDynamics> motion;
  Output<JointTorque> joint_torque;
  Output<double> energy;       ///< of links, rotors, springs and bristles [J]
  Output<double> dissipation;  ///< [W]
  Output<double> power;        ///< of the motors [W]
};

}  // namespace pliant
