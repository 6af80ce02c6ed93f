#pragma once

#include <string>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/iso_9283.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// One run follows a closed path as well as another, but for a margin: its accuracy AT and its
/// repeatability RT are at most those of the other run and the margin, see PathAccuracyOf. What is
/// commanded is control.target, what is attained tool.pose.
struct FollowsAsWell {
  static constexpr const char* kTag = "FollowsAsWell";
  ClaimSource claim;
  std::string basis;  ///< where the margin comes from
  std::string run;    ///< of which it is claimed
  std::string to;     ///< that it is compared with
  double margin = kToBeGiven;
  double from_s = kToBeGiven;    ///< begin of the first round
  double period_s = kToBeGiven;  ///< of a round
  int rounds = 10;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("to", to);
    f("margin", margin, "m", kNotNegative);
    f("from_s", from_s, "s", kNotNegative);
    f("period_s", period_s, "s", kPositive);
    f("rounds", rounds, "", Between(2, 100'000));
  }
  /// Throws Error if a run is compared with itself, or is over before its rounds.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if the tool and its target are not recorded.
  void RequireSound(const Recording& recorded) const;
  Claim Check(const Runs& runs) const;
};

/// One run comes to a pose as well as another, but for a margin: its accuracy AP and its
/// repeatability RP of the position are at most those of the other run and the margin, see
/// PoseAccuracyOf. The visits are at from_s, from_s + every_s, …; what is commanded then must be
/// one pose.
struct ComesAsNear {
  static constexpr const char* kTag = "ComesAsNear";
  ClaimSource claim;
  std::string basis;  ///< where the margin comes from
  std::string run;    ///< of which it is claimed
  std::string to;     ///< that it is compared with
  double margin = kToBeGiven;
  double from_s = kToBeGiven;   ///< of the first visit
  double every_s = kToBeGiven;  ///< from one to the next
  int visits = 30;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("to", to);
    f("margin", margin, "m", kNotNegative);
    f("from_s", from_s, "s", kNotNegative);
    f("every_s", every_s, "s", kPositive);
    f("visits", visits, "", Between(2, 100'000));
  }
  /// As above, of its visits.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const Recording& recorded) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
