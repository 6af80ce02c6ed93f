#pragma once

#include <filesystem>
#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// Positions of joints at increasing times.
struct JointTrajectory {
  Joints joints;
  std::vector<double> times;             ///< [s]
  std::vector<JointPosition> positions;  ///< at each of them
};

/// Throws Error unless there is a row, times increase, and each row has a finite number for each
/// joint.
void RequireTrajectory(const JointTrajectory& trajectory);

/// Reads comma-separated values with the time in the first column:
///
///   t [s], elbow [deg], shoulder [deg]
///   0,     0,           10
///   0.5,   30,          10
///
/// Columns are called after the joints, in any order, with a unit in [] or (): rad, or deg or °;
/// rad where there is none. The time is in s or ms. Without a row of names there is a column for
/// each joint, in their order. Throws Error "file:line:column: …" for a joint that is not there or
/// there twice, a column that is no joint, an unknown unit, and as ReadTimeTable does.
JointTrajectory ReadJointTrajectory(const std::filesystem::path& file, const Joints& joints);

}  // namespace pliant
