#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pliant/analysis/sample_units.h"

namespace pliant {

/// Where a log has the numbers of one kind.
struct SampleColumns {
  /// One name for each joint, or one for all of them:
  ///   "v{}"                    v1, v2, …: {} is the number of the joint, {+7} that and 7, up to
  ///                            1000
  ///   "arm.measured_velocity"  the columns, or elements of the signal, arm.measured_velocity[…]
  ///   "4"                      the fourth column, from 1, if none is called so
  /// Empty: of a log or CSV file of pliant, the signal of the arm's station; of others, none.
  std::vector<std::string> names = {};
  std::string unit = {};  ///< empty: what the log says; where it says nothing, SI
};

/// Samples of a log: which columns, and how many of them to keep.
struct SampleSource {
  std::vector<std::filesystem::path> files;  ///< .mcap of pliant, or CSV; read one after the other
  std::vector<std::string> joints = {};      ///< names, or numbers from 1; empty: all
  SampleColumns time = {}, position = {}, velocity = {}, acceleration = {}, current = {},
                torque = {};
  /// What must be there; velocity and acceleration are derived if they are not.
  bool need_position = false, need_velocity = true, need_acceleration = true, need_current = true,
       need_torque = true;
  double sample_period_s = 0;   ///< of a CSV file without a time; 0: there is one
  char delimiter = 0;           ///< of a CSV file; 0: found
  int half_window = 10;         ///< w, samples on either side of one whose derivative is taken
  Eigen::Index most = 200'000;  ///< rows to keep, ≥ 1000
  std::function<void(double bytes, double of)> progress = {};
};

/// Numbers of joints over time: a row for each joint, a column for each time.
struct Samples {
  std::vector<std::string> joints;
  Eigen::VectorXd time;             ///< [s], within a file never less than before
  std::vector<Eigen::Index> begin;  ///< the first column of each file
  /// [rad], [rad/s], [rad/s²], [A], [N·m]; empty if it was not asked for or is not there.
  Eigen::MatrixXd position, velocity, acceleration, current, torque;

  std::int64_t read = 0;      ///< rows in the files
  std::int64_t skipped = 0;   ///< of these, rows with a number that is none
  std::string first_skipped;  ///< "file:line" or "file at 1.2 s"
  std::int64_t cut = 0;       ///< rows that were not whole
  std::int64_t stride = 1;    ///< one in so many rows was kept, for want of room
  bool derived_velocity = false, derived_acceleration = false;
  /// "10 000 rows, 3 with numbers that are none (first log.csv:17), …": a line for a person.
  std::string text() const;
};

/// Reads logs of any size in bounded memory: past `most` rows every second one is given up and half
/// of those to come, again and again, so what is kept is spread evenly and depends on the log
/// alone. Derivatives are taken before that.
///
/// What is not in the log is derived with the line or parabola that fits the 2w + 1 samples about
/// each best (Savitzky & Golay, Analytical Chemistry 36, 1964; here for any spacing of times):
///
///   v_k + a_k s + ½ j_k s²  ≈  v(t_k + s)            acceleration from velocity
///   q_k + v_k s + ½ a_k s²  ≈  q(t_k + s)            velocity and acceleration from position
///
/// w samples at either end of a file, and about a gap, are given up.
///
/// Throws Error with the file and line: no such column (with those there are), a row of another
/// length, a time before the one before it, no row, nothing but NaN in a column, columns of joints
/// with names that differ, fewer than three times among samples whose derivative is taken.
Samples ReadSamples(const SampleSource& source);

/// The coefficients of the parabola x₀ + x₁ s + ½ x₂ s² that fits the values at times s best, for
/// each row of `values`.
Eigen::MatrixX3d FitParabola(const Eigen::VectorXd& s, const Eigen::MatrixXd& values);

}  // namespace pliant
