#include "pliant/diagrams/stations.h"

#include "pliant/plants/model_file.h"

namespace pliant {

namespace {

SimulatedArm::Options Station(const RobotModel& model, const StationOptions& o,
                              const std::string& actuators) {
  SimulatedArm::Options station{.model = model, .position = o.position, .engine = o.engine};
  station.actuators = ArmActuators::Read(ModelFile(actuators), model.joints());
  if (o.ideal)
    station.actuators = ArmActuators::Ideal(model.joints(), station.actuators.reflected_inertia());
  return station;
}

}  // namespace

SimulatedArm::Options SimulatedGen3(const RobotModel& model, const StationOptions& o) {
  return Station(model, o, "gen3/actuators.yaml");
}

SimulatedArm::Options SimulatedLwr(const RobotModel& model, const StationOptions& o) {
  SimulatedArm::Options station = Station(model, o, "lwr/actuators.yaml");
  station.firmware.compensated = model;
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
