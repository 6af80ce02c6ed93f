#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pliant/analysis/compliance_claims.h"

namespace pliant {

/// What is taken of a signal over time.
enum class Statistic { Peak, Rms, Mean, Last };

inline const std::vector<std::string>& Words(Statistic) {
  static const std::vector<std::string> words{"peak", "rms", "mean", "last"};
  return words;
}

/// A number computed from a recorded signal lies between two bounds, in the signal's unit. x(t) is
/// an element of the signal, or the norm of several:
///
///   peak max x,  rms √(mean x²),  mean mean x,  last x at the end,   of rows with from_s ≤ t ≤
///   to_s
///
struct BoundClaim {
  static constexpr const char* kTag = "Bound";
  ClaimSource claim;
  std::string basis;  ///< where the bounds come from
  std::string run;
  std::string signal;                      ///< path, such as control.pose_error
  std::vector<std::string> elements = {};  ///< such as joint_1; none: all
  Statistic statistic = Statistic::Peak;
  double from_s = 0, to_s = kUnbounded;
  double least = -kUnbounded, most = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("signal", signal);
    f("elements", elements);
    f("statistic", statistic);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
    f("least", least, "", Range{.least = -kUnbounded, .most = kUnbounded});
    f("most", most, "", Range{.least = -kUnbounded, .most = kUnbounded});
  }
  /// Throws Error without a bound, and if no time of a run lies between from_s and to_s.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if elements are not there, or of different units.
  void RequireSound(const RecordedSignal& signal) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
