#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/diagrams/scenario.h"

namespace pliant {

/// What is taken of a signal over time.
enum class Statistic { Peak, Least, Magnitude, Rms, Mean, Last, Range, SettlingTime };

inline const std::vector<std::string>& Words(Statistic) {
  static const std::vector<std::string> words{"peak", "least", "magnitude", "rms",
                                              "mean", "last",  "range",     "settling_time"};
  return words;
}

/// Where a signal is to settle.
enum class SettlesAt { Zero, Final };

inline const std::vector<std::string>& Words(SettlesAt) {
  static const std::vector<std::string> words{"zero", "final"};
  return words;
}

/// A number of a recorded signal. x(t) is an element of the signal, or the norm of several of one
/// unit, of rows with from_s ≤ t ≤ to_s:
///
///   peak max x,  least min x,  magnitude max |x|,  range max x − min x,  rms √(mean x²),  mean,
///   last at the end,
///   settling_time  T = min{t: ‖y(t′) − y_∞‖ ≤ band for all t′ ≥ t} − from_s
///
/// where y are the elements, and y_∞ is zero, or their mean over the last tenth of that time. T is
/// infinite if the last row is outside of the band. With relative_to_s each element is taken less
/// what it is at that time: what came of it since, such as a deflection of a position. With
/// above_hz it is a number of what of each element lies above that frequency, see HighPass, of the
/// whole log before rows are taken; its rms is that of the band. With below_hz it is of the rest.
struct SignalNumber {
  std::string signal;                      ///< path, such as control.pose_error
  std::vector<std::string> elements = {};  ///< such as joint_1; none: all
  Statistic statistic = Statistic::Peak;
  double from_s = 0, to_s = kUnbounded;
  std::optional<double> relative_to_s = {};
  double above_hz = 0;  ///< 0: all of it
  double below_hz = kUnbounded;
  double band = 0;                         ///< of settling_time, in the signal's unit, > 0
  SettlesAt settles_at = SettlesAt::Zero;  ///< of settling_time

  template <class F>
  void Parameters(F&& f) {
    f("signal", signal);
    f("elements", elements);
    f("statistic", statistic);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
    f("relative_to_s", relative_to_s, "s", kNotNegative);
    f("above_hz", above_hz, "Hz", kNotNegative);
    f("below_hz", below_hz, "Hz", kLimit);
    f("band", band, "", kNotNegative);
    f("settles_at", settles_at);
  }

  /// Throws Error if no time of a run lies between from_s and to_s, or a field does not go with the
  /// statistic or with the log's period.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if elements are not there, or of different units.
  void RequireSound(const RecordedSignal& recorded) const;

  bool is_norm(const RecordedSignal& recorded) const;
  /// Of the number: that of the signal, or s.
  std::string unit(const RecordedSignal& recorded) const;
  /// Such as "peak norm of control.pose_error[x, y, z] from 1 s".
  std::string text(const RecordedSignal& recorded) const;
  /// The elements over the whole log, relative or filtered as asked.
  Eigen::MatrixXd Elements(const RecordedSignal& recorded) const;
  /// Throws Error if there is no such signal or row.
  double Of(const Recording& recording) const;
};

/// Throws Error unless a scenario's log has a row at each tick of its controller: between two rows
/// of a coarser one anything may have happened.
void RequireEveryTick(const Scenario& scenario);

/// Throws Error unless a row of a scenario's log lies between two times of it.
void RequireRowBetween(double from_s, double to_s, const Scenario& scenario);

/// The rows of a log between two times, begin and end.
struct RowsBetween {
  RowsBetween(const Eigen::VectorXd& times, double from_s, double to_s)
      : begin{(times.array() < from_s).count()}, end{(times.array() <= to_s).count()} {}
  Eigen::Index size() const { return end - begin; }

  Eigen::Index begin, end;
};

}  // namespace pliant
