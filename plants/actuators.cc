#include "pliant/plants/actuators.h"

#include <algorithm>

#include "pliant/plants/joint_friction.h"
#include "pliant/plants/transmission.h"

namespace pliant {

namespace {

/// Energies and powers of the parts, added up.
class Sums final : public Block {
 public:
  explicit Sums(const Joints& joints)
      : torque{this, "torque", joints},
        velocity{this, "velocity", joints},
        energies{this, "energies"},
        dissipations{this, "dissipations"},
        energy{this, "energy"},
        dissipation{this, "dissipation"},
        power{this, "power"} {
    const auto sum = [](const Joined<double>& parts) {
      double all = 0;
      for (int i = 0; i < parts.size(); ++i) all += parts[i];
      return all;
    };
    Compute(energy).From(energies).As(sum);
    Compute(dissipation).From(dissipations).As(sum);
    Compute(power)
        .From(torque, velocity)
        .As([](const JointTorque& tau, const JointVelocity& omega) { return tau.dot(omega); });
  }

  Input<JointTorque> torque;
  Input<JointVelocity> velocity;
  InputList<double> energies, dissipations;
  Output<double> energy, dissipation, power;
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
  if (o.load.size() > 0) carrying = o.load.cwiseQuotient(o.parameters.torque_per_ampere());
  std::vector<FrictionParameters> dry(parameters.size());
  std::ranges::transform(parameters, dry.begin(), &ActuatorParameters::friction);

  auto& drive = Add<MotorDrive>(
      "drive",
      {.joints = o.joints, .parameters = parameters, .current = carrying, .period = o.period});
  auto& rub = Add<JointFriction>(
      "friction", {.joints = o.joints, .law = o.parameters.friction, .parameters = dry});
  auto& sums = Add<Sums>("sums", o.joints);
  Connect(command, drive.command);
  Connect(rub.energy, sums.energies);
  Connect(rub.dissipation, sums.dissipations);
  Connect(drive.torque, sums.torque);

  if (o.parameters.transmission == Transmission::Rigid) {
    auto& gear =
        Add<RigidTransmission>("transmission", {.joints = o.joints, .parameters = parameters});
    Connect(velocity, rub.velocity);
    Connect(velocity, sums.velocity);
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
    Connect(gear.motor_velocity, sums.velocity);
    Connect(drive.torque, gear.motor_torque);
    Connect(rub.torque, gear.friction);
    Connect(position, gear.position);
    Connect(velocity, gear.velocity);
    Connect(gear.joint_torque, torque);
    Connect(gear.joint_torque, joint_torque);
    Connect(gear.motor_velocity, motor_velocity);
    Connect(gear.energy, sums.energies);
    Connect(gear.dissipation, sums.dissipations);
  }
  Connect(drive.current, current);
  Connect(drive.torque, motor_torque);
  Connect(rub.torque, friction);
  Connect(drive.saturated, saturated);
  Connect(sums.energy, energy);
  Connect(sums.dissipation, dissipation);
  Connect(sums.power, power);
}

}  // namespace pliant
