#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// Which bounds of a joint's damper are meant.
enum class DamperBound { Position, Speed, Both };

inline const std::vector<std::string>& Words(DamperBound) {
  static const std::vector<std::string> words{"position", "speed", "both"};
  return words;
}

/// In each of `runs` a joint keeps the bounds of its damper, or, with `crossed`, passes each of
/// those meant: its position [q⁻ + d_s, q⁺ − d_s], which a continuous joint does not have, its
/// speed q̇⁺. They are true positions and velocities, from `from_s` to `to_s`.
struct DamperClaim {
  static constexpr const char* kTag = "KeepsDamper";
  ClaimSource claim;
  std::vector<std::string> runs = {};
  std::string joint;
  DamperBound bound = DamperBound::Both;
  bool crossed = false;
  double from_s = 0, to_s = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("runs", runs);
    f("joint", joint);
    f("bound", bound);
    f("crossed", crossed);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
  }
  /// Throws Error if no row of a run is looked at.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if the robot has no such joint.
  void RequireSound(const Recording& recorded) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
