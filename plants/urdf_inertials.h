#pragma once

#include <map>
#include <string>

#include "pliant/plants/robot_model.h"

namespace pliant {

/// A URDF text with other `<inertial>` elements for the links named, and all else as it was,
/// comments too. The inertia is about the centre of mass, in the axes of the link. Throws Error if
/// the text is no URDF or has no such link.
std::string WithInertials(const std::string& urdf, const std::map<std::string, Inertial>& inertials,
                          const std::string& source = "URDF");

/// The element: `<inertial> … </inertial>`, lines that begin with `indent`.
std::string InertialElement(const Inertial& inertial, const std::string& indent = "");

}  // namespace pliant
