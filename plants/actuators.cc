#include "pliant/plants/actuators.h"

#include <algorithm>

#include "pliant/plants/joint_friction.h"
#include "pliant/plants/transmission.h"
#include "pliant/systems/sum.h"

namespace pliant {

namespace {

/// P = τ_mᵀ ω
class MotorPower final : public Block {
 public:
  explicit MotorPower(const Joints& joints)
      : torque{this, "torque", joints}, velocity{this, "velocity", joints}, power{this, "power"} {
    Compute(power)
        .From(torque, velocity)
        .As([](const JointTorque& tau, const JointVelocity& omega) { return tau.dot(omega); });
  }

  Input<JointTorque> torque;
  Input<JointVelocity> velocity;
  Output<double> power;
};

}  // namespace

Actuators::Actuators(const Options& o)
    : command{this, "command", o.joints},
      position{this, "position", o.joints},
      velocity{this, "velocity", o.joints},
      acceleration{this, "acceleration", o.joints},
      torque{this, "torque", o.joints},
      joint_torque{this, "joint_torque", o.joints},
      current{this, "current", o.joints},
      motor_torque{this, "motor_torque", o.joints},
      motor_velocity{this, "motor_velocity", o.joints},
      friction{this, "friction", o.joints},
      saturated{this, "saturated"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      power{this, "power"} {
  const std::vector<ActuatorParameters>& parameters = o.parameters.joint;
  MotorCurrent carrying;
  if (o.load.size() > 0) {
    RequireOneForEach(o.joints, "load", o.load.size());
    carrying = o.load.cwiseQuotient(
        FiguresOf(Checked(o.joints, parameters), &ActuatorParameters::torque_per_ampere));
  }
  std::vector<FrictionParameters> dry(parameters.size());
  std::ranges::transform(parameters, dry.begin(), &ActuatorParameters::friction);

  auto& drive = Add<MotorDrive>(
      "drive",
      {.joints = o.joints, .parameters = parameters, .current = carrying, .period = o.period});
  auto& rub = Add<JointFriction>(
      "friction", {.joints = o.joints, .law = o.parameters.friction, .parameters = dry});
  auto& energies = Add<Sum<double>>("energies", {});
  auto& losses = Add<Sum<double>>("losses", {});
  auto& motors = Add<MotorPower>("motors", o.joints);
  Connect(command, drive.command);
  Connect(rub.energy, energies.plus);
  Connect(rub.dissipation, losses.plus);
  Connect(drive.torque, motors.torque);

  if (o.parameters.transmission == Transmission::Rigid) {
    auto& gear =
        Add<RigidTransmission>("transmission", {.joints = o.joints, .parameters = parameters});
    Connect(velocity, rub.velocity);
    Connect(velocity, motors.velocity);
    Connect(drive.torque, gear.motor_torque);
    Connect(rub.torque, gear.friction);
    Connect(acceleration, gear.acceleration);
    Connect(gear.torque, torque);
    Connect(gear.joint_torque, joint_torque);
    Connect(velocity, motor_velocity);
  } else {
    auto& gear = Add<ElasticTransmission>("transmission", {.joints = o.joints,
                                                           .parameters = parameters,
                                                           .position = o.position,
                                                           .velocity = o.velocity,
                                                           .load = o.load});
    Connect(gear.motor_velocity, rub.velocity);
    Connect(gear.motor_velocity, motors.velocity);
    Connect(drive.torque, gear.motor_torque);
    Connect(rub.torque, gear.friction);
    Connect(position, gear.position);
    Connect(velocity, gear.velocity);
    Connect(gear.joint_torque, torque);
    Connect(gear.joint_torque, joint_torque);
    Connect(gear.motor_velocity, motor_velocity);
    Connect(gear.energy, energies.plus);
    Connect(gear.dissipation, losses.plus);
  }
  Connect(drive.current, current);
  Connect(drive.torque, motor_torque);
  Connect(rub.torque, friction);
  Connect(drive.saturated, saturated);
  Connect(energies.y, energy);
  Connect(losses.y, dissipation);
  Connect(motors.power, power);
}

}  // namespace pliant
