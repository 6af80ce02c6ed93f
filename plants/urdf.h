#pragma once

#include <string>
#include <vector>

#include "pliant/plants/robot_model.h"

namespace pliant::internal {

/// A joint as the file states it, fixed ones too.
struct UrdfJoint {
  Joint joint;
  bool fixed = false;
  Pose origin;                                      ///< X_PC at q = 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit vector in the child link
  int line = 0;
};

/// A URDF file that has been checked: a tree of links, in the order of the file.
struct UrdfRobot {
  std::string name;
  std::string source;
  std::vector<Link> links;  ///< `body` and `pose` not yet set
  std::vector<UrdfJoint> joints;
  int root = 0;
};

UrdfRobot ReadUrdf(const std::string& text, const std::string& source);

/// For TinyXML, which reads a letter of UTF-8 that the text cuts off to where it would end.
inline std::string Padded(const std::string& text) { return text + std::string(3, '\0'); }

/// Throws, with file and line, what makes a URDF text no robot; see RobotModel::FromUrdf.
void CheckUrdf(const std::string& text, const std::string& source);

/// Throws if the inertial is not that of a body; `what` begins the message.
void CheckInertial(const Inertial& inertial, const std::string& what);

/// "; did you mean \"b\"?" for the nearest of `known`, or "" if none is near.
std::string DidYouMean(std::string_view name, const std::vector<std::string>& known);

}  // namespace pliant::internal
