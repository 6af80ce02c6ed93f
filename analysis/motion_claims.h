#pragma once

#include <string>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// The tool moves along a direction d of the world and hardly across it: with Δ its way from where
/// it was at `from_s`,
///
///   peak ‖Δ − d dᵀ Δ‖ ≤ part · peak |dᵀ Δ|,   peak |dᵀ Δ| ≥ at_least
struct MovesAlong {
  static constexpr const char* kTag = "MovesAlong";
  ClaimSource claim;
  std::string basis;  ///< where the part comes from
  std::string run;
  Eigen::Vector3d direction = Eigen::Vector3d::Constant(kToBeGiven);  ///< d, of any length > 0
  double part = kToBeGiven;
  double at_least = kToBeGiven;  ///< [m]
  double from_s = 0;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("direction", direction);
    f("part", part, "", kPositive);
    f("at_least", at_least, "m", kNotNegative);
    f("from_s", from_s, "s", kNotNegative);
  }
  /// Throws Error if there is no direction, or no row of a run from `from_s` on.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

/// The handle of a virtual door stays on the circle about its hinge, and its inertia is the one
/// that was asked for. The way off the circle is that across the plane of the circle and of the
/// radius; the inertia I is that which explains the true motion best, in least squares over all
/// rows, by the impulse of what turns the door about the hinge:
///
///   I (θ̇(t) − θ̇(0)) = ∫ τ_h − k (θ − θ₀) + τ_g − b θ̇ − c sgn θ̇ ds
///
/// with τ_h the moment of the recorded pushes on the tool, and closer, weight and friction as they
/// were asked for. A door with stops has no such balance, and is refused.
struct KeepsDoor {
  static constexpr const char* kTag = "KeepsDoor";
  ClaimSource claim;
  std::string run;
  double off_circle = kToBeGiven;  ///< [m]
  double within = 0.05;            ///< of the inertia

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("off_circle", off_circle, "m", kPositive);
    f("within", within, "", kPositive);
  }
  /// Throws Error unless the controller has a door without stops and the tool is pushed.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
