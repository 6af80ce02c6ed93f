#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/analysis/sample_source.h"

namespace pliant {

/// How motion and torque are smoothed before anything is fitted to them.
struct SmoothingOptions {
  double window_s = 0.1;   ///< 2 h, width of the window
  double step_s = 0.025;   ///< between points, no less than between rows
  double repeat_s = 0.02;  ///< from here on rows that repeat the one before are no stale ones
};

/// Positions, velocities, accelerations and torques that belong together: a row for each joint, a
/// column for each point.
struct SmoothMotion {
  Eigen::VectorXd time;                  ///< [s]
  std::vector<Eigen::Index> begin;       ///< the first point of each file
  Eigen::MatrixXd position, velocity;    ///< [rad], [rad/s]
  Eigen::MatrixXd acceleration, torque;  ///< [rad/s²], [N·m]
  Eigen::Index repeated = 0;             ///< rows dropped: they repeat the one before
  Eigen::Index gaps = 0;                 ///< points left out: too few samples about them

  Eigen::Index size() const { return time.size(); }
};

/// Fits a cubic to each signal over the samples within h of every point, by least squares,
///
///   x(t + s) ≈ c₀ + c₁ s + c₂ s² + c₃ s³,   |s| ≤ h
///
/// q, v and τ are their c₀, v̇ is the velocity's c₁. One filter without phase for all of them: what
/// it takes from the motion it takes from the torque. For dense samples c₀ is off by −h⁴ x⁗/280 and
/// c₁ by −h⁴ x⁽⁵⁾/504; white noise of v, of deviation σ at a rate f, makes that of v̇
/// σ √(75/(8 f h³)).
///
/// Stamps need no regular spacing. A row that repeats the numbers of the one before is stale and
/// dropped, unless that lasts `repeat_s` or longer: then the arm rests and every row counts. A
/// point needs six samples about it, a third of them on either side, and no hole wider than h among
/// them.
///
/// `samples` must have position, velocity and torque. Throws Error if no point is left, or if the
/// step is less than the median time from row to row.
///
/// Source: Savitzky & Golay, Analytical Chemistry 36(8), 1964.
SmoothMotion Smooth(const Samples& samples, const SmoothingOptions& o = {});

}  // namespace pliant
