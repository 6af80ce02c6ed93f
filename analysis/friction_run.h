#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/friction_log.h"
#include "pliant/analysis/run_data.h"
#include "pliant/estimators/friction_fit.h"

namespace pliant {

/// What a run with !FrictionExperiment has shown of one joint.
struct TestedJoint {
  int joint = 0;
  /// ω and y = κ i − τ − B q̈ while the joint moved at a constant speed, and where ramps broke it
  /// away.
  FrictionSamples samples;
  double lasted_s = 0;     ///< from the first to the last of them
  double break_speed = 0;  ///< largest speed at which breaking away was noticed [rad/s]
};

/// Throws Error unless the controller of the scenario is !FrictionExperiment, with a row of the log
/// at each of its ticks.
void RequireFrictionExperiment(const Scenario& scenario);

/// The joints under test in the order of the robot. q̈ is the slope of the line that fits 41
/// samples of the velocity best.
std::vector<TestedJoint> TestedJointsOf(const RunData& run);

/// The run of a log with !FrictionExperiment; none of any other file. Such a run says itself which
/// samples are steady and where ramps broke joints away, so nothing is guessed from the numbers.
std::optional<RunData> FrictionRunOf(const std::filesystem::path& file);

/// What such a run has shown of each joint under test, and its motors.
struct TestedDrive {
  FrictionLog log;
  DriveFigures drive;
};
std::vector<TestedDrive> TestedDrivesOf(const RunData& run);

/// The joints that one actuator drives, in all but their friction.
struct ActuatorSize {
  std::vector<TestedJoint> joints;
  std::string name;  ///< "joint_1, joint_2"
};
std::vector<ActuatorSize> SizesOf(const RunData& run);

/// Coulomb and viscous friction and the offset of the sensor of each of the joints, and those of
/// all of them taken for one.
struct SizeFit {
  std::vector<FrictionFit> each;
  FrictionSamples pooled;  ///< without the offsets
  FrictionFit all;
};
SizeFit FitOf(const ActuatorSize& size);

}  // namespace pliant
