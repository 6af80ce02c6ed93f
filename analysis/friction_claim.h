#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// What of the friction is meant.
enum class FrictionTerm { Coulomb, Viscous, Static };

inline const std::vector<std::string>& Words(FrictionTerm) {
  static const std::vector<std::string> words{"coulomb", "viscous", "static"};
  return words;
}

/// Whose friction is meant.
enum class FrictionGroup { Joints, Sizes };

inline const std::vector<std::string>& Words(FrictionGroup) {
  static const std::vector<std::string> words{"joints", "sizes"};
  return words;
}

/// A term of the friction, fitted to a run of !FrictionExperiment, is that of the station's
/// actuators: of each joint, or of joints with one actuator size taken together. With Δ the half
/// width of its 95 % interval and D = 3 σ_d √(2 (1 − exp(−t/T))) what the offset of the torque
/// sensor may drift during the test of a joint, of t,
///
///   |ĉ − c| ≤ Δ + D,   |d̂ − d| ≤ Δ + D/ω_max,   |ŝ − s| ≤ Δ + D + d ω_b
///
/// ω_b is the speed at which breaking away is noticed. Intervals know noise, but take the offset
/// for constant. Where Δ is more than `within` of the truth, nothing is recovered.
struct FrictionIdentified {
  static constexpr const char* kTag = "FrictionIdentified";
  ClaimSource claim;
  std::string run;
  FrictionTerm term = FrictionTerm::Coulomb;
  FrictionGroup of = FrictionGroup::Joints;
  double within = 0.05;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("term", term);
    f("of", of);
    f("within", within, "", kPositive);
  }
  /// Throws Error if its run is no friction experiment, or not of an arm with friction.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
