#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/plants/inertial_parameters.h"

namespace pliant {

/// Rows about the inertial parameters of links and other numbers f, weighted so that each has the
/// deviation 1,
///
///   T (π_1; …; π_L; f) ≈ b
struct InertiaRows {
  Eigen::MatrixXd T;
  Eigen::VectorXd b;
};

/// A body that could be, and how well it is known.
struct ConsistentInertia {
  Inertial inertial;
  Inertial deviation;  ///< standard deviation of each figure
  /// The part of each figure's variance that the data took from it, in the order of π but about the
  /// centre of mass: 1: all known from data, 0: nothing but the prior.
  InertialParameters from_data;
};

struct ConsistentFit {
  std::vector<ConsistentInertia> links;
  Eigen::VectorXd x;  ///< (π_1; …; π_L; f)
};

/// The links that explain rows best among all that could be built, where rows leave a choice the
/// nearest to `prior`:
///
///   ‖T (π; f) − b‖² + Σ_links d²(P, P₀)/σ₀² → min,   P ≻ 0
///
/// Each link's pseudo-inertia is P = A U Uᵀ Aᵀ with P₀ = A Aᵀ of the prior and U upper triangular,
/// exp(θ_i) on its diagonal and six more θ above it: every θ is a body, and θ = 0 is the prior.
/// d² = Σ (2 θ_ii)² + Σ 2 θ_ij² is, to second order, the square of the distance between P and P₀
/// that does not depend on axes, origin and units (Lee & Park, IEEE RA-L 3(4), 2018). `deviation`
/// is σ₀: every θ_ii has the deviation σ₀/2, and P_ii goes with e^{2θ_ii}, so 1 says that each
/// second moment, and the mass, is off by about a factor of e, to first order by ± 100 %. The prior
/// counts as much as one measurement that good: data with many rows overrule it, and it decides
/// what they do not.
///
/// Deviations are those of the linearised problem. `without` names columns of T whose numbers stay
/// 0. A prior that fills no volume is given one, of 1 mm.
///
/// Source: Rucker & Wensing, IEEE Robotics and Automation Letters 7(2), 2022 (the parameters);
/// Wensing, Kim & Slotine, ibid. 3(1), 2018. Solved by Ceres' Levenberg–Marquardt.
ConsistentFit FitConsistentInertia(const InertiaRows& rows, const std::vector<Inertial>& prior,
                                   double deviation, const std::vector<Eigen::Index>& without = {});

}  // namespace pliant
