#pragma once

#include <string>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// Γ = 0 with the external torque known: the tool stands still, to what friction, sensor offsets
/// and the leak's clamp leave at rest. Without these the joints stand still too, to the absolute
/// tolerance of the integrator.
struct StandsStill {
  static constexpr const char* kTag = "StandsStill";
  ClaimSource claim;
  std::string run;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
  }
  /// Throws Error if the log of a run of this scenario lacks ticks of the controller.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

/// The tool deviates by no more than `factor` times what being late by an observer explains.
struct HoldsTool {
  static constexpr const char* kTag = "HoldsTool";
  ClaimSource claim;
  std::string run;
  double factor = 1.2;
  double joints_more_than_deg = 0;  ///< and the joints move by more than that

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("factor", factor, "", kPositive);
    f("joints_more_than_deg", joints_more_than_deg, "deg", kNotNegative);
  }
  /// Throws Error if the log of a run of this scenario lacks ticks of the controller.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

/// All Γ = I: at the end of the plateau of the last push the tool is where the push, the arm's own
/// inertia and the stiffness of the task put it, to a part `within` of that.
struct YieldsAsInertia {
  static constexpr const char* kTag = "YieldsAsInertia";
  ClaimSource claim;
  std::string run;
  double within = 0.1;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("within", within, "", kPositive);
  }
  /// The same, and if a run has no push whose plateau ends in it.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

/// No run comes to a limit of position, velocity or torque, and no controller leaves one out.
struct KeepsLimits {
  static constexpr const char* kTag = "KeepsLimits";
  ClaimSource claim;

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
  }
  /// Throws Error if the log of a run of this scenario lacks ticks of the controller.
  void RequireFit(const Scenario& scenario) const;
  Claim Check(const Runs& runs) const;
};

/// What the transfer function of the observer makes of the pushes of a run: e, 6 rows.
Eigen::MatrixXd PredictedError(const RunData& run);

/// The tool's error were the pushes of a run static and all Γ = I: e, 6 rows.
Eigen::MatrixXd StaticError(const RunData& run);

}  // namespace pliant
