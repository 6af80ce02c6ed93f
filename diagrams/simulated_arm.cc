#include "pliant/diagrams/simulated_arm.h"

#include "pliant/systems/constant.h"
#include "pliant/systems/hold.h"
#include "pliant/systems/sum.h"

namespace pliant {

namespace {

/// What the arm did with the commands of the tick before.
class StatusSensor final : public Block {
 public:
  StatusSensor(ControlMode before, Duration period)
      : mode{this, "mode"},
        saturated{this, "saturated"},
        cut{this, "cut"},
        stopped{this, "stopped", {}, 0},
        status{this, "status", {}, {.mode = before}},
        last_{this, "last", {}, {.mode = before}} {
    Every(period)
        .Update(last_)
        .From(mode, saturated, cut, stopped)
        .As([](ControlMode m, JointBits of_drives, JointBits of_firmware, int stops) {
          return ArmStatus{.mode = m, .saturated = of_drives | of_firmware, .stopped = stops};
        });
    Every(period).Compute(status).From(last_).As([](const ArmStatus& s) { return s; });
  }
  Input<ControlMode> mode;
  Input<JointBits> saturated, cut;
  Input<int> stopped;
  Output<ArmStatus> status;

 private:
  Discrete<ArmStatus> last_;
};

JointPosition StartOf(const SimulatedArm::Options& o) {
  RequireOneForEach(o.model.joints(), "position", o.position.size());
  return o.position;
}

/// Gains that are not given: those of a triple pole at up to 50 rad/s for the arm's inertia at the
/// start. Behind a spring k_d turns the rotor alone, half a period and a current loop late: it
/// stays below half of B over that delay.
ArmFirmware::Options Firmware(const SimulatedArm::Options& o, const ArmActuators& actuators,
                              const RobotDynamics& start) {
  ArmFirmware::Options firmware = o.firmware;
  firmware.joints = o.model.joints();
  firmware.period = o.period;
  firmware.command_period = o.interface_period;
  firmware.torque_per_ampere = actuators.torque_per_ampere();
  firmware.torque_limit = actuators.torque_limit();
  firmware.load = start.gravity;
  const PerJoint B = actuators.reflected_inertia(), inertia = start.M.diagonal() + B;
  PerJoint pole = PerJoint::Constant(o.model.size(), 50);  // [rad/s]
  if (actuators.transmission == Transmission::Elastic)
    for (int j = 0; j < o.model.size(); ++j) {
      const double delay = seconds(o.period) / 2 +
                           actuators.joint[static_cast<std::size_t>(j)].current_time_constant;
      pole(j) = std::min(pole(j), 0.5 * B(j) / (3 * delay * inertia(j)));
    }
  const auto fill = [&](PerJoint& gain, double factor, int power) {
    if (gain.size() == 0) gain = factor * inertia.array() * pole.array().pow(power);
  };
  fill(firmware.position_stiffness, 3, 2);
  fill(firmware.position_damping, 3, 1);
  fill(firmware.position_integral, 1, 3);
  return firmware;
}

}  // namespace

SimulatedArm::SimulatedArm(const Options& o)
    : mode{this, "mode", {}, o.firmware.mode},
      joint_modes{this, "joint_modes", {}, JointModes{}},
      position_command{this, "position_command", o.model.joints(), StartOf(o)},
      torque_command{this, "torque_command", o.model.joints(), JointTorque::Zero(o.model.joints())},
      current_command{this, "current_command", o.model.joints(),
                      MotorCurrent::Zero(o.model.joints())},
      contacts{this, "contacts"},
      loads{this, "loads", o.model.joints()},
      measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      measured_current{this, "measured_current", o.model.joints()},
      wrench{this, "wrench", o.wrist ? Frame(o.wrist->frame) : Frame()},
      wrench_valid{this, "wrench_valid"},
      status{this, "status"},
      position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      motion{this, "motion", o.model.joints()},
      joint_torque{this, "joint_torque", o.model.joints()},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      power{this, "power"} {
  const Joints& joints = o.model.joints();
  const Duration outside = o.interface_period == Duration{} ? o.period : o.interface_period;
  Require(!(outside < o.period), "interface_period must be >= period = " + o.period.text(),
          outside.text());
  if (o.wrist)
    Require(!(o.wrist->period < o.period),
            "wrist.period must be >= period = " + o.period.text() + ", the rate of the arm",
            o.wrist->period.text());
  const ArmActuators parameters =
      o.actuators.joint.empty() ? ArmActuators::Ideal(joints) : o.actuators;
  RequireOneForEach(joints, "actuators", std::ssize(parameters.joint));
  const PerJoint rotors = parameters.reflected_inertia();

  SimbodyPlant::Options body{.model = o.model,
                             .position = o.position,
                             .velocity = o.velocity,
                             .damping = o.damping,
                             .frames = o.frames,
                             .engine = o.engine};
  if (parameters.transmission == Transmission::Rigid && (rotors.array() > 0).any())
    body.rotor_inertia = rotors;
  auto& plant = Add<SimbodyPlant>("plant", body);

  // The brakes have just let go: motors and springs carry the arm's weight.
  RobotDynamics start(o.model);
  ComputeDynamics(o.model, o.position, JointVelocity::Zero(joints), start);
  auto& actuators = Add<Actuators>("actuators", {.joints = joints,
                                                 .parameters = parameters,
                                                 .position = o.position,
                                                 .velocity = o.velocity,
                                                 .period = o.period,
                                                 .load = start.gravity});
  auto& firmware = Add<ArmFirmware>("firmware", Firmware(o, parameters, start));
  JointSensors::Options sampled = o.sensors;
  sampled.joints = joints;
  sampled.period = o.period;
  auto& sensors = Add<JointSensors>("sensors", sampled);
  auto& status_sensor = Add<StatusSensor>("status", o.firmware.mode, o.period);
  auto& energies = Add<Sum<double>>("energies", {});
  auto& losses = Add<Sum<double>>("losses", {});
  const auto pass = [&]<class S>(const std::string& name, const auto& from, auto& to,
                                 const S& before,
                                 const typename internal::SpaceOf<S>::type& space) {
    if (outside == o.period) {
      Connect(from, to);
    } else {
      auto& hold = Add<Hold<S>>(name, {.space = space, .before = before, .period = outside});
      Connect(from, hold.u);
      Connect(hold.y, to);
    }
  };
  if (o.wrist) {
    auto& wrist = Add<WristSensor>("wrist", *o.wrist);
    Connect(plant.motion, wrist.motion);
    Connect(plant.acceleration, wrist.acceleration);
    Connect(contacts, wrist.contacts);
    pass("measured_wrench", wrist.wrench, wrench, Wrench(), Frame(o.wrist->frame));
  } else {
    auto& none = Add<Constant<Wrench>>("wrist", {.value = Wrench()});
    Connect(none.y, wrench);
  }
  auto& senses = Add<Constant<bool>>("senses", {.value = o.wrist.has_value()});
  Connect(senses.y, wrench_valid);
  if (o.stops) {
    auto& stops = Add<JointStops>("stops", *o.stops);
    Connect(plant.position, stops.position);
    Connect(plant.velocity, stops.velocity);
    Connect(stops.torque, plant.loads);
    Connect(stops.stopped, status_sensor.stopped);
    Connect(stops.energy, energies.plus);
    Connect(stops.dissipation, losses.plus);
  }

  pass("mode", mode, firmware.mode, o.firmware.mode, {});
  pass("joint_modes", joint_modes, firmware.joint_modes, JointModes{}, {});
  pass("position_command", position_command, firmware.position_command, o.position, joints);
  pass("torque_command", torque_command, firmware.torque_command, JointTorque::Zero(joints),
       joints);
  pass("current_command", current_command, firmware.current_command, MotorCurrent::Zero(joints),
       joints);
  Connect(firmware.current, actuators.command);
  Connect(actuators.torque, plant.torque);
  Connect(contacts, plant.contacts);
  Connect(loads, plant.loads);
  Connect(plant.position, actuators.position);
  Connect(plant.velocity, actuators.velocity);
  Connect(plant.acceleration, actuators.acceleration);

  Connect(plant.position, sensors.position);
  Connect(plant.velocity, sensors.velocity);
  Connect(actuators.joint_torque, sensors.torque);
  Connect(actuators.current, sensors.current);
  Connect(sensors.measured_position, firmware.position);
  Connect(actuators.motor_velocity, firmware.motor_velocity);
  Connect(sensors.measured_torque, firmware.torque);
  Connect(firmware.active, status_sensor.mode);
  Connect(actuators.saturated, status_sensor.saturated);
  Connect(firmware.cut, status_sensor.cut);
  Connect(plant.energy, energies.plus);
  Connect(actuators.energy, energies.plus);
  Connect(plant.dissipation, losses.plus);
  Connect(actuators.dissipation, losses.plus);

  pass("measured_position", sensors.measured_position, measured_position, o.position, joints);
  pass("measured_velocity", sensors.measured_velocity, measured_velocity,
       JointVelocity::Zero(joints), joints);
  pass("measured_torque", sensors.measured_torque, measured_torque, JointTorque::Zero(joints),
       joints);
  pass("measured_current", sensors.measured_current, measured_current, MotorCurrent::Zero(joints),
       joints);
  pass("measured_status", status_sensor.status, status, ArmStatus{.mode = o.firmware.mode}, {});
  Connect(plant.position, position);
  Connect(plant.velocity, velocity);
  Connect(plant.acceleration, acceleration);
  Connect(plant.motion, motion);
  Connect(actuators.joint_torque, joint_torque);
  Connect(energies.y, energy);
  Connect(losses.y, dissipation);
  Connect(actuators.power, power);
}

}  // namespace pliant
