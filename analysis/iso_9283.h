#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/analysis/series.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// How near n poses X_j, taken at n visits, come to the one that was commanded, X_c:
///
///   AP = ‖p̄ − p_c‖                    RP = l̄ + 3 S_l,   l_j = ‖p_j − p̄‖
///   AP_a = |ā|,  and so b, c          RP_a = 3 S_a,  and so b, c
///
/// with S the standard deviation of n − 1 degrees of freedom, and (a, b, c) = log(R_j R_cᵀ), world
/// axes, which for the small angles in question are the turns about them.
/// Source: ISO 9283:1998, 7.2.
struct PoseAccuracy {
  double position = 0;                                 ///< AP [m]
  double position_repeatability = 0;                   ///< RP [m]
  Eigen::Vector3d rotation = {0, 0, 0};                ///< AP_a, AP_b, AP_c [rad]
  Eigen::Vector3d rotation_repeatability = {0, 0, 0};  ///< RP_a, RP_b, RP_c [rad]
};

/// Throws Error unless there are two poses or more.
PoseAccuracy PoseAccuracyOf(const std::vector<Pose>& attained, const Pose& commanded);

/// How near n rounds of a closed path come to the one that was commanded. At each of its points c_i
/// a plane stands across the path, which round j goes through at p_ij:
///
///   AT = max_i ‖p̄_i − c_i‖            RT = max_i (l̄_i + 3 S_i),   l_ij = ‖p_ij − p̄_i‖
///
/// When the tool is there does not count: AT is of the path, not of time.
/// Source: ISO 9283:1998, 8.2 and 8.3.
struct PathAccuracy {
  double accuracy = 0;       ///< AT [m]
  double repeatability = 0;  ///< RT [m]
  int points = 0;            ///< c_i that there are planes at
};

/// Rounds that follow each other without a break.
struct Rounds {
  double from_s = 0;    ///< begin of the first
  double period_s = 0;  ///< of each
  int count = 0;        ///< ≥ 2
};

/// Of positions over time, commanded and attained, 3 rows each, a column for each of `times`. There
/// are planes where the commanded speed is at least half of the highest, so not where a path turns
/// back. Round j goes through a plane in the direction of the path, where that is nearest to the
/// commanded time, at most a quarter of a period away. AT and RT are infinite if one does not.
/// Throws Error if the rounds are not within `times`, or nothing is commanded to move.
PathAccuracy PathAccuracyOf(const Eigen::VectorXd& times, const Series& commanded,
                            const Series& attained, const Rounds& rounds);

}  // namespace pliant
