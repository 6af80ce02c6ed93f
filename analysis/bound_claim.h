#pragma once

#include <string>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

/// A number of a run lies between two bounds, in its unit, in every repetition.
struct BoundClaim {
  static constexpr const char* kTag = "Bound";
  ClaimSource claim;
  std::string basis;  ///< where the bounds come from
  std::string run;
  SignalNumber number = {};
  double least = -kUnbounded, most = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    number.Parameters(f);
    f("least", least, "", Range{.least = -kUnbounded, .most = kUnbounded});
    f("most", most, "", Range{.least = -kUnbounded, .most = kUnbounded});
  }
  /// Throws Error without a bound, and where the number does.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if a norm is to be negative, and where the number does.
  void RequireSound(const RecordedSignal& recorded) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
