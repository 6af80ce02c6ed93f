#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/repeated_number.h"

namespace pliant {

/// Over all repetitions a number of one run is that of another, but for a margin that was stated
/// beforehand: two one-sided tests of the means, p < alpha, see EquivalenceOfMeans.
///
/// The margin is in the unit of the number, or a part of the other run's mean. Then it is itself
/// measured, which the test leaves out of account: of n repetitions the mean is off by s/√n.
struct EquivalenceClaim {
  static constexpr const char* kTag = "Equivalent";
  ClaimSource claim;
  std::string basis;  ///< where the margin comes from
  std::string run;    ///< of which it is claimed
  std::string to;     ///< that it is compared with
  SignalNumber number = {};
  double margin = 0;       ///< in the unit of the number; this or
  double margin_part = 0;  ///< of the mean of run `to`
  double alpha = 0.05;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("to", to);
    number.Parameters(f);
    f("margin", margin, "", kNotNegative);
    f("margin_part", margin_part, "", kNotNegative);
    f("alpha", alpha, "",
      Range{.least = 0, .most = 0.5, .without_least = true, .without_most = true});
  }
  /// Throws Error if a run is compared with itself, without a margin or with two, and where the
  /// number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const RecordedSignal& recorded) const { number.RequireSound(recorded); }
  /// Throws Error unless there are two or more, without which nothing is known of the scatter.
  void RequireRepetitions(int repetitions) const;
  std::vector<RepeatedNumber> Wanted() const { return {{number, {run, to}}}; }
  Claim Judge(const RepeatedNumber& measured) const;
};

}  // namespace pliant
