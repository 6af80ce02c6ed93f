#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pliant/controllers/low_level_torque.h"
#include "pliant/diagrams/simulated_arm.h"
#include "pliant/plants/friction_file.h"

namespace pliant {

/// The actuator of a joint.
struct JointActuator {
  std::string joint;
  ActuatorParameters figures = {};

  template <class F>
  void Parameters(F&& f) {
    f("joint", joint);
    figures.Parameters(f);
  }
};

/// The actuators of an arm, joint by joint.
struct StationActuators {
  Transmission transmission = Transmission::Elastic;
  FrictionLaw friction = FrictionLaw::ElastoPlastic;
  std::vector<JointActuator> joints = {};  ///< each of the robot's once

  template <class F>
  void Parameters(F&& f) {
    f("transmission", transmission);
    f("friction", friction);
    f("joints", joints);
  }

  /// In the order of the joints; throws Error if they are others.
  ArmActuators Of(const Joints& joints) const;
};

/// Where a station starts, and how much of a real arm it has.
struct StationOptions {
  static constexpr const char* kTag = "SimulatedArm";

  JointPosition position = {};  ///< q at the start [rad]
  /// Torque sources whose rotors turn with the links, exact joint sensors, no hard stops. What is
  /// left of a wrist sensor is its delay and range, of the LWR its interface.
  bool ideal = false;
  std::optional<StationActuators> actuators = {};  ///< of an arm that does not come with pliant
  std::vector<IdentifiedFriction> friction = {};   ///< instead of that of the actuators
  std::uint64_t seed = 1;                          ///< of the sensors' noise and bias
  SimbodyPlant::Engine engine = SimbodyPlant::Engine::Simbody;

  template <class F>
  void Parameters(F&& f) {
    f("position", position, "rad");
    f("ideal", ideal);
    f("actuators", actuators);
    f("friction", friction);
    f("engine", engine);
  }
};

/// What was identified of joints of the model; throws Error for one it does not have, or twice.
FrictionFile FrictionOf(const std::vector<IdentifiedFriction>& joints, const RobotModel& model);

/// Kinova Gen3, 7 joints, with models/gen3/actuators.yaml: motors, friction, elastic gears, noisy
/// sensors, hard stops, and the wrist sensor if the model has one. 1 kHz. The model is any of the
/// Gen3, such as one with a payload.
SimulatedArm::Options SimulatedGen3(const RobotModel& model, const StationOptions& o);

/// KUKA LWR IV+ with models/lwr/actuators.yaml and hard stops. It carries its own weight in torque
/// and position mode. Its interface passes commands and measurements on every 5 ms; inside it runs
/// at 1 kHz.
SimulatedArm::Options SimulatedLwr(const RobotModel& model, const StationOptions& o);

/// Any arm with the actuators of the options, hard stops and exact joint sensors, 1 kHz; without
/// them it is ideal.
SimulatedArm::Options SimulatedOther(const RobotModel& model, const StationOptions& o);

/// The torque loop of Muraccioli et al. 2025 (RSS) for these actuators, friction known: λ = 5,
/// K_I = 10, θ = 2 s, thresholds 0.1 rad/s and 1 rad/s², leak clamped to 5 % of the torque limits,
/// currents cut where the motors' are.
LowLevelTorque::Options LowLevelTorqueOf(const ArmActuators& actuators, const RobotModel& model,
                                         Duration period);

}  // namespace pliant
