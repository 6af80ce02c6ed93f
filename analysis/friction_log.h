#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/sample_source.h"
#include "pliant/estimators/friction_fit.h"

namespace pliant {

/// What is between a motor's current and the friction of its joint.
struct DriveFigures {
  double torque_per_ampere;  ///< κ = η K_T G_r [N·m/A]
  double reflected_inertia;  ///< B [kg·m²]

  bool operator==(const DriveFigures&) const = default;
};

/// What a log says of the friction of one joint.
struct FrictionLog {
  std::string joint;
  FrictionSamples samples;
  Eigen::Index transient = 0;            ///< samples that were left out after steps
  Eigen::Index steps = 0;                ///< of the current
  std::vector<std::string> doubts = {};  ///< what looks wrong with units or signs, for a person
};

/// The torque error y = κ i − τ − B q̈ of a row of `samples`, without transients:
///
/// A step is where the mean current of five samples differs from that of the five before it by more
/// than 4 % of the range of all currents and six standard deviations of their noise, in one file,
/// while the velocity keeps its sign: where it turns, friction changes the current. From a step on,
/// samples are left out until the mean velocity of five comes to stay within 2 % of its change,
/// or within the noise, about its median in the last quarter before the next step; three quarters
/// of the samples at most. Logs without steps keep all.
///
/// A joint breaks away where 20 samples below the least velocity are followed by five above it
/// while the current does not step: y is the mean of the last five at rest.
FrictionLog FrictionOf(const Samples& samples, Eigen::Index row, const DriveFigures& drive,
                       double least_velocity = 0);

}  // namespace pliant
