#include "pliant/diagrams/stations.h"

#include <algorithm>

#include "pliant/plants/model_file.h"

namespace pliant {

namespace {

/// Rubber that a joint at its largest speed presses in by some hundredths of a radian; it takes
/// about half the speed.
JointStops::Options Stops(const RobotModel& model) {
  return {.model = model,
          .stiffness = PerJoint::Constant(model.size(), 2e4),
          .damping = PerJoint::Constant(model.size(), 0.5)};
}

SimulatedArm::Options Station(const RobotModel& model, const StationOptions& o,
                              const std::string& actuators) {
  SimulatedArm::Options station{.model = model, .position = o.position, .engine = o.engine};
  station.actuators = ArmActuators::Read(ModelFile(actuators), model.joints());
  if (o.ideal)
    station.actuators = ArmActuators::Ideal(model.joints(), station.actuators.reflected_inertia());
  else
    station.stops = Stops(model);
  return station;
}

/// Torque offsets as in recordings of an LWR4+ (kjyv/FloBaRoID, data/KUKA/HW); noise of a Franka
/// Panda, since none of this arm is published.
JointSensors::Options LwrJointSensors(const Joints& joints, Duration period, std::uint64_t seed) {
  JointSensors::Options sensors = Gen3JointSensors(joints, period, seed);
  sensors.torque_bias = JointTorque{0.85, 0.67, -0.10, -0.34, -0.66, 0.57, -0.10};
  return sensors;
}

bool HasLink(const RobotModel& model, std::string_view name) {
  return std::ranges::any_of(model.links(), [&](const Link& link) { return link.name == name; });
}

}  // namespace

SimulatedArm::Options SimulatedGen3(const RobotModel& model, const StationOptions& o) {
  SimulatedArm::Options station = Station(model, o, "gen3/actuators.yaml");
  if (!o.ideal) station.sensors = Gen3JointSensors(model.joints(), station.period, o.seed);
  if (HasLink(model, "FT_sensor_wrench")) {
    station.wrist = SensOne(model, o.seed);
    if (o.ideal)
      for (Wrench* error : {&station.wrist->noise, &station.wrist->bias}) error->setZero();
  }
  return station;
}

SimulatedArm::Options SimulatedLwr(const RobotModel& model, const StationOptions& o) {
  SimulatedArm::Options station = Station(model, o, "lwr/actuators.yaml");
  if (!o.ideal) station.sensors = LwrJointSensors(model.joints(), station.period, o.seed);
  station.firmware.compensated = model;
  station.interface_period = 5ms;
  return station;
}

LowLevelTorque::Options LowLevelTorqueOf(const ArmActuators& actuators, const RobotModel& model,
                                         Duration period) {
  const auto figure = [&](double FrictionParameters::*member) {
    PerJoint all(model.size());
    for (int j = 0; j < model.size(); ++j)
      all(j) = actuators.joint[static_cast<std::size_t>(j)].friction.*member;
    return all;
  };
  return {.joints = model.joints(),
          .torque_per_ampere = actuators.torque_per_ampere(),
          .reflected_inertia = actuators.reflected_inertia(),
          .friction = {.joints = model.joints(),
                       .coulomb = figure(&FrictionParameters::coulomb),
                       .viscous = figure(&FrictionParameters::viscous),
                       .stiction = figure(&FrictionParameters::stiction)},
          .leak_limit = 0.05 * model.effort_limit(),
          .period = period};
}

}  // namespace pliant
