#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

/// A number of one run is less than that of each of some others, such as of a baseline whose gain
/// nobody publishes, over the gains it may have: in every repetition
///
///   x ≤ min_i x_i,  factor x ≤ min_i x_i,   factor ≥ 1
///
/// What is measured is said of each.
struct LeastClaim {
  static constexpr const char* kTag = "Least";
  ClaimSource claim;
  std::string basis;                ///< where the factor comes from
  std::string run;                  ///< of which it is claimed
  std::vector<std::string> others;  ///< that it is compared with
  SignalNumber number = {};
  double factor = 1;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("others", others);
    number.Parameters(f);
    f("factor", factor, "", Range{.least = 1, .most = 1e6});
  }
  /// Throws Error without others, if a run is compared with itself, and where the number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const RecordedSignal& recorded) const { number.RequireSound(recorded); }
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
