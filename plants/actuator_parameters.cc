#include "pliant/plants/actuator_parameters.h"

#include <algorithm>
#include <map>

#include "pliant/systems/elements.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

ArmActuators From(const ParameterFile& file, const Joints& joints) {
  file.RequireKeys({"transmission", "friction", "sizes", "joints"});
  ArmActuators arm;
  if (const auto given = file.Find("transmission")) given->Read(arm.transmission);
  if (const auto given = file.Find("friction")) given->Read(arm.friction);

  std::map<std::string, ActuatorParameters> sizes;
  std::vector<std::string> names;
  for (const auto& [name, figures] : file["sizes"].entries()) {
    figures.Fill(sizes[name]);
    names.push_back(name);
  }
  std::vector<std::string> known;
  for (int j = 0; j < joints.size(); ++j) known.push_back(joints[j]);
  const ParameterFile of_joints = file["joints"];
  of_joints.RequireKeys(known);
  for (const std::string& joint : known)
    arm.joint.push_back(sizes[names[of_joints[joint].OneOf(names)]]);
  return arm;
}

}  // namespace

const std::vector<ActuatorParameters>& Checked(const Joints& joints,
                                               const std::vector<ActuatorParameters>& actuators) {
  RequireOneForEach(joints, "actuators", std::ssize(actuators));
  for (int j = 0; j < joints.size(); ++j) {
    const ActuatorParameters& p = actuators[static_cast<std::size_t>(j)];
    RequireInRange(joints[j], p);
    RequireInRange(joints[j], "torque_constant gear_ratio", p.torque_per_ampere(), "N·m/A",
                   kPositive);
    RequireInRange(joints[j], "rotor_inertia gear_ratio²", p.reflected_inertia(), "kg·m²",
                   kNotNegative);
  }
  return actuators;
}

ArmActuators ArmActuators::Read(const std::filesystem::path& file, const Joints& joints) {
  return From(ParameterFile::Read(file), joints);
}

ArmActuators ArmActuators::ReadText(const std::string& text, const Joints& joints,
                                    const std::string& source) {
  return From(ParameterFile::ReadText(text, source), joints);
}

ArmActuators ArmActuators::Ideal(const Joints& joints, const PerJoint& reflected_inertia) {
  const PerJoint B =
      EachInRangeOr0("reflected_inertia", reflected_inertia, "kg·m²", kNotNegative, joints);
  ArmActuators arm{.transmission = Transmission::Rigid, .friction = FrictionLaw::None, .joint = {}};
  for (int j = 0; j < joints.size(); ++j)
    arm.joint.push_back({.gear_ratio = 1,
                         .torque_constant = 1,
                         .rotor_inertia = B(j),
                         .current_limit = kUnbounded,
                         .torque_limit = kUnbounded,
                         .stiffness = kUnbounded,
                         .friction = {.coulomb = 0, .viscous = 0, .stiction = 0}});
  return arm;
}

PerJoint ArmActuators::reflected_inertia() const {
  return FiguresOf(joint, &ActuatorParameters::reflected_inertia);
}

PerJoint ArmActuators::torque_per_ampere() const {
  return FiguresOf(joint, &ActuatorParameters::torque_per_ampere);
}

JointTorque ArmActuators::torque_limit() const {
  return FiguresOf(joint, &ActuatorParameters::torque_limit);
}

}  // namespace pliant
