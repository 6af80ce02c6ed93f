#pragma once

#include <string>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// A free motion of second order: x with
///
///   ẍ + 2 ζ ω_n ẋ + ω_n² (x − x_∞) = 0
///
/// or, without a derivative of what is noisy, with its integrals from the first row on,
///
///   x = c₀ + c₁ t + c₂ t² − 2 ζ ω_n ∫x − ω_n² ∬x
///
/// which is linear in what is sought: least squares over all rows, trapezoids for the integrals.
struct Swing {
  double frequency = 0;  ///< ω_n [rad/s]; not a number where the motion is none of a spring
  double damping = 0;    ///< ζ
};

/// Of rows that are evenly spaced. Throws Error if there are fewer than 10.
Swing FitSwing(const Eigen::VectorXd& times, const Eigen::VectorXd& x);

/// An element of a signal moves freely, between two times, with a natural frequency and a damping
/// ratio, each within a part of its value.
struct SwingClaim {
  static constexpr const char* kTag = "Swings";
  ClaimSource claim;
  std::string basis;  ///< where the values and how near they are to be come from
  std::string run;
  std::string signal, element;
  double from_s = 0, to_s = kUnbounded;
  double frequency = kToBeGiven;  ///< ω_n [rad/s]
  double damping = kToBeGiven;    ///< ζ
  double within = kToBeGiven;     ///< part of either

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("basis", basis);
    f("run", run);
    f("signal", signal);
    f("element", element);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
    f("frequency", frequency, "rad/s", kPositive);
    f("damping", damping, "", kPositive);
    f("within", within, "", kPositive);
  }
  /// Throws Error where no row of a run lies between the times.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if there is no such signal, or element of it.
  void RequireSound(const Recording& recorded) const;
  Claim Check(const Runs& runs) const;
};

}  // namespace pliant
