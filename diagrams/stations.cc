#include "pliant/diagrams/stations.h"

#include <algorithm>

#include "pliant/plants/shared_file.h"
#include "pliant/systems/nearest_name.h"

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
                              const ArmActuators& actuators) {
  SimulatedArm::Options station{.model = model, .position = o.position, .engine = o.engine};
  station.actuators = actuators;
  if (!o.friction.empty())
    station.actuators =
        WithFriction(station.actuators, model.joints(), FrictionOf(o.friction, model));
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

/// Gains for a triple pole with the largest inertia the joints carry without a payload, of at most
/// 50 rad/s and of a k_d that the rotors bear (simulated_arm.cc); stable with the rated payload,
/// k_d k_p > k_i I.
ArmFirmware::Options PositionGains(const PerJoint& inertia, const PerJoint& pole) {
  ArmFirmware::Options firmware;
  firmware.position_stiffness = 3 * inertia.array() * pole.array().square();
  firmware.position_damping = 3 * inertia.cwiseProduct(pole);
  firmware.position_integral = inertia.array() * pole.array().cube();
  return firmware;
}

PerJoint Figures(std::initializer_list<double> figures) { return JointTorque(figures); }

/// Kinova does not publish its position loop. k_p is two thirds of the gears' stiffness K: a link
/// behind a spring, damped at its rotor, is stable for k_p < K. k_d is what the rotors bear
/// (simulated_arm.cc). ∫ takes a constant load over within k_p/k_i = 0.5 s.
///
/// Chosen once, on the mass drop of Muraccioli et al. 2025 (RSS) in their posture, 1.25 kg by 25 cm
/// on a rope of 2 kN/m and 20 N·s/m: peak 5.8 mm, at rest to 0.5 mm 0.85 s after the release. RSS
/// has 5.632 ± 1.820 mm and 0.842 ± 0.220 s, its rope and band unpublished; that much scatter a
/// simulated drop does not have. The rope counts as much as the gains: with 1, 3 and 10 kN/m the
/// peak is 4.0, 8.4 and 14 mm, the last one with all gains that were tried: torques are cut.
ArmFirmware::Options Gen3PositionGains() {
  ArmFirmware::Options firmware;
  firmware.position_stiffness = Figures({16e3, 16e3, 16e3, 16e3, 4e3, 4e3, 4e3});
  firmware.position_damping = Figures({200, 200, 200, 200, 110, 110, 110});
  firmware.position_integral = 2 * firmware.position_stiffness;
  return firmware;
}

bool HasLink(const RobotModel& model, std::string_view name) {
  return std::ranges::any_of(model.links(), [&](const Link& link) { return link.name == name; });
}

}  // namespace

FrictionFile FrictionOf(const std::vector<IdentifiedFriction>& joints, const RobotModel& model) {
  for (const IdentifiedFriction& of : joints) {
    model.joint_index(of.joint);
    Require(std::ranges::count(joints, of.joint, &IdentifiedFriction::joint) == 1,
            "friction has each joint once, got '" + of.joint + "' twice");
  }
  return {.sources = {}, .model = {}, .loss = {}, .directions = {}, .joints = joints};
}

ArmActuators StationActuators::Of(const Joints& of) const {
  ArmActuators arm{.transmission = transmission, .friction = friction, .joint = {}};
  std::vector<std::string> names;
  for (int j = 0; j < of.size(); ++j) names.push_back(of[j]);
  for (const JointActuator& actuator : joints) {
    if (std::ranges::find(names, actuator.joint) == names.end())
      throw Error("actuators: the robot has no joint '" + actuator.joint + "'" +
                  DidYouMean(actuator.joint, names));
    Require(std::ranges::count(joints, actuator.joint, &JointActuator::joint) == 1,
            "actuators has each joint once, got '" + actuator.joint + "' twice");
  }
  for (const std::string& name : names) {
    const auto found = std::ranges::find(joints, name, &JointActuator::joint);
    Require(found != joints.end(), "actuators: joint '" + name + "' is missing");
    arm.joint.push_back(found->figures);
  }
  return arm;
}

SimulatedArm::Options SimulatedOther(const RobotModel& model, const StationOptions& o) {
  if (o.actuators) return Station(model, o, o.actuators->Of(model.joints()));
  Require(o.friction.empty(),
          "friction is that of actuators, and the station has none; give "
          "station.actuators, or leave friction out");
  StationOptions ideal = o;
  ideal.ideal = true;
  return Station(model, ideal, ArmActuators::Ideal(model.joints()));
}

SimulatedArm::Options SimulatedGen3(const RobotModel& model, const StationOptions& o) {
  SimulatedArm::Options station =
      Station(model, o, ArmActuators::Read(ModelFile("gen3/actuators.yaml"), model.joints()));
  station.firmware = Gen3PositionGains();
  if (!o.ideal) station.sensors = Gen3JointSensors(model.joints(), station.period, o.seed);
  if (HasLink(model, "FT_sensor_wrench")) {
    station.wrist = SensOne(model, o.seed);
    if (o.ideal)
      for (Wrench* error : {&station.wrist->noise, &station.wrist->bias}) error->setZero();
  }
  return station;
}

SimulatedArm::Options SimulatedLwr(const RobotModel& model, const StationOptions& o) {
  SimulatedArm::Options station =
      Station(model, o, ArmActuators::Read(ModelFile("lwr/actuators.yaml"), model.joints()));
  if (!o.ideal) station.sensors = LwrJointSensors(model.joints(), station.period, o.seed);
  station.firmware = PositionGains(Figures({3.7, 3.7, 1, 1, 0.22, 0.14, 0.14}),
                                   Figures({40, 40, 50, 50, 50, 50, 50}));
  station.firmware.compensated = model;
  station.interface_period = 5ms;
  return station;
}

LowLevelTorque::Options LowLevelTorqueOf(const ArmActuators& actuators, const RobotModel& model,
                                         Duration period) {
  Checked(model.joints(), actuators.joint);
  const auto figure = [&](double FrictionParameters::*member) {
    return FiguresOf(actuators.joint,
                     [member](const ActuatorParameters& p) { return p.friction.*member; });
  };
  return {.joints = model.joints(),
          .torque_per_ampere = actuators.torque_per_ampere(),
          .reflected_inertia = actuators.reflected_inertia(),
          .current_limit = FiguresOf(actuators.joint, &ActuatorParameters::current_limit),
          .friction = {.joints = model.joints(),
                       .coulomb = figure(&FrictionParameters::coulomb),
                       .viscous = figure(&FrictionParameters::viscous),
                       .stiction = figure(&FrictionParameters::stiction)},
          .leak_limit = 0.05 * model.effort_limit(),
          .period = period};
}

}  // namespace pliant
