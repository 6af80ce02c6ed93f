#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// A joint comes to its bounds, those that its damper is to keep, from inside: its position to
/// [q⁻ + d_s, q⁺ − d_s], which a continuous joint does not have, its speed to q̇⁺. In each of `runs`
/// it keeps all of them, or, with `crossed`, it crosses both: true positions and velocities, from
/// `from_s` on.
struct DamperClaim {
  static constexpr const char* kTag = "KeepsDamper";
  ClaimSource claim;
  std::vector<std::string> runs = {};
  std::string joint;
  bool crossed = false;
  double from_s = 0;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("runs", runs);
    f("joint", joint);
    f("crossed", crossed);
    f("from_s", from_s, "s", kNotNegative);
  }
  /// Throws Error if no row of a run is looked at.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if the robot has no such joint.
  void RequireSound(const Recording& recorded) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
