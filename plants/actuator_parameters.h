#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/plants/friction.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// What is between a motor and its link: nothing that gives way, or a spring.
enum class Transmission { Rigid, Elastic };

inline const std::vector<std::string>& Words(Transmission) {
  static const std::vector<std::string> words{"rigid", "elastic"};
  return words;
}

/// The actuator of one joint. All but K_T, G_r, J and the current is behind the gear.
struct ActuatorParameters {
  double gear_ratio = kToBeGiven;       ///< G_r
  double torque_constant = kToBeGiven;  ///< K_T [N·m/A]
  double efficiency = 1;                ///< η, of the gear
  double rotor_inertia = kToBeGiven;    ///< J [kg·m²]
  double current_limit = kToBeGiven;    ///< [A]
  double torque_limit = kToBeGiven;     ///< [N·m]
  double current_time_constant = 0;     ///< θ of the current loop [s]; 0: follows at once
  double stiffness = kToBeGiven;        ///< K of the transmission [N·m/rad]
  double damping = 0;                   ///< D of the transmission [N·m·s/rad]
  FrictionParameters friction;

  template <class F>
  void Parameters(F&& f) {
    f("gear_ratio", gear_ratio, "", kPositive);
    f("torque_constant", torque_constant, "N·m/A", kPositive);
    f("efficiency", efficiency, "", Range{.least = 0, .most = 1, .without_least = true});
    f("rotor_inertia", rotor_inertia, "kg·m²", kNotNegative);
    f("current_limit", current_limit, "A", kLimit);
    f("torque_limit", torque_limit, "N·m", kLimit);
    f("current_time_constant", current_time_constant, "s", kNotNegative);
    f("stiffness", stiffness, "N·m/rad", kLimit);
    f("damping", damping, "N·m·s/rad", kNotNegative);
    friction.Parameters(f);
  }

  double torque_per_ampere() const { return efficiency * torque_constant * gear_ratio; }
  double reflected_inertia() const { return rotor_inertia * gear_ratio * gear_ratio; }

  bool operator==(const ActuatorParameters&) const = default;
};

/// `actuators`, one for each joint, each figure in its range; throws with the joint's name if not.
const std::vector<ActuatorParameters>& Checked(const Joints& joints,
                                               const std::vector<ActuatorParameters>& actuators);

/// A figure of every joint, such as &ActuatorParameters::stiffness.
template <class Figure>
PerJoint FiguresOf(const std::vector<ActuatorParameters>& actuators, Figure figure) {
  PerJoint all(static_cast<Eigen::Index>(actuators.size()));
  std::ranges::transform(actuators, all.data(), figure);
  return all;
}

/// The actuators of an arm, in the order of its joints.
struct ArmActuators {
  Transmission transmission = Transmission::Elastic;
  FrictionLaw friction = FrictionLaw::ElastoPlastic;
  std::vector<ActuatorParameters> joint;

  /// Reads a file such as models/gen3/actuators.yaml:
  ///
  ///   transmission: elastic       # or rigid
  ///   friction: elasto_plastic    # or none, coulomb_viscous, stribeck, lugre
  ///   sizes:                      # figures, under names of one's own
  ///     large: {gear_ratio: 100, …}
  ///   joints:                     # which joint has which, all of the robot's
  ///     joint_1: large
  ///
  /// What is wrong is an Error "file:line:column: …".
  static ArmActuators Read(const std::filesystem::path& file, const Joints& joints);
  static ArmActuators ReadText(const std::string& text, const Joints& joints,
                               const std::string& source = "YAML");

  /// Torque sources: 1 A makes 1 N·m at once and without bound; the rotors turn with the links.
  /// Empty: no rotors.
  static ArmActuators Ideal(const Joints& joints, const PerJoint& reflected_inertia = {});

  PerJoint reflected_inertia() const;  ///< B = J G_r² [kg·m²]
  PerJoint torque_per_ampere() const;  ///< η K_T G_r [N·m/A]
  JointTorque torque_limit() const;
};

}  // namespace pliant
