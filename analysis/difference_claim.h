#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/repeated_number.h"

namespace pliant {

enum class DifferenceDirection { Less, Greater };

inline const std::vector<std::string>& Words(DifferenceDirection) {
  static const std::vector<std::string> words{"less", "greater"};
  return words;
}

/// Over all repetitions a number of one run is less, or greater, than that of another: of a
/// two-sided Mann–Whitney U test
///
///   p < alpha,  and the rank-biserial r is < 0 (less) or > 0 (greater)
///
/// Two-sided although the direction is stated: the same p as in a figure's brackets, and stricter.
/// Shapiro–Wilk of both groups and the bootstrap interval of the difference of the means are said,
/// and decide nothing.
struct DifferenceClaim {
  static constexpr const char* kTag = "Differs";
  ClaimSource claim;
  std::string run;   ///< of which it is claimed
  std::string than;  ///< that it is compared with
  SignalNumber number = {};
  DifferenceDirection direction = DifferenceDirection::Less;
  double alpha = 0.05;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("than", than);
    number.Parameters(f);
    f("direction", direction);
    f("alpha", alpha, "",
      Range{.least = 0, .most = 0.5, .without_least = true, .without_most = true});
  }
  /// Throws Error if a run is compared with itself, and where the number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const RecordedSignal& recorded) const { number.RequireSound(recorded); }
  /// Throws Error if p of so few repetitions cannot be < alpha.
  void RequireRepetitions(int repetitions) const;
  std::vector<RepeatedNumber> Wanted() const { return {{number, {run, than}}}; }
  Claim Judge(const RepeatedNumber& measured) const;
};

}  // namespace pliant
