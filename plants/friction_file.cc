#include "pliant/plants/friction_file.h"

#include <algorithm>

#include "pliant/plants/parameter_text.h"

namespace pliant {

namespace {

FrictionFile From(const ParameterFile& file, const Joints& joints) {
  FrictionFile friction;
  file.Fill(friction);
  std::vector<std::string> known, seen;
  for (int j = 0; j < joints.size(); ++j) known.push_back(joints[j]);
  const std::vector<ParameterFile> places = file["joints"].elements();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const IdentifiedFriction& of = friction.joints[i];
    places[i]["joint"].OneOf(known);
    if (std::ranges::find(seen, of.joint) != seen.end())
      places[i]["joint"].Fail("'" + of.joint + "' is given twice");
    seen.push_back(of.joint);
    if (of.stiction && *of.stiction < of.coulomb.value_or(0))
      places[i]["stiction"].Fail("stiction must be ≥ coulomb, " + Text(*of.coulomb) + ", got " +
                                 Text(*of.stiction));
    const auto n = std::ssize(of.estimates);
    if (of.covariance.rows() != n || (n > 0 && of.covariance.cols() != n))
      places[i].Fail("covariance must have a row and a column for each of the " + Text(n) +
                     " estimates, got " + Text(of.covariance.rows()) + " × " +
                     Text(of.covariance.cols()));
  }
  return friction;
}

}  // namespace

std::string FrictionFile::text() const {
  return "# Friction as identified, SI. See docs/identification.md.\n" + ParametersText(*this);
}

FrictionFile ReadFriction(const std::filesystem::path& file, const Joints& joints) {
  return From(ParameterFile::Read(file), joints);
}

FrictionFile ReadFrictionText(const std::string& text, const Joints& joints,
                              const std::string& source) {
  return From(ParameterFile::ReadText(text, source), joints);
}

ArmActuators WithFriction(ArmActuators actuators, const Joints& joints,
                          const FrictionFile& friction) {
  RequireOneForEach(joints, "actuators", std::ssize(actuators.joint));
  for (int j = 0; j < joints.size(); ++j) {
    const auto of = std::ranges::find(friction.joints, joints[j], &IdentifiedFriction::joint);
    if (of == friction.joints.end()) continue;
    FrictionParameters& p = actuators.joint[static_cast<std::size_t>(j)].friction;
    const double ratio = p.coulomb > 0 ? p.stiction / p.coulomb : 1;
    p.coulomb = of->coulomb.value_or(p.coulomb);
    p.viscous = of->viscous.value_or(p.viscous);
    p.stiction = of->stiction.value_or(of->coulomb ? ratio * p.coulomb : p.stiction);
    p.stribeck_velocity = of->stribeck_velocity.value_or(p.stribeck_velocity);
  }
  Checked(joints, actuators.joint);
  return actuators;
}

}  // namespace pliant
