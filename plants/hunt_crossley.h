#pragma once

#include <algorithm>

namespace pliant {

/// The law of Hunt and Crossley with exponent 1, for a body that has gone p > 0 deep into another
/// and goes deeper with ṗ:
///
///   N = max(0, k p (1 + c ṗ))  where p > 0,   N = 0  where not
///
/// No force at first touch, so N has no jump there; and none that pulls: the clip holds where the
/// body leaves fast, 1 + c ṗ < 0.
///
/// Energy: E = ½ k p² is stored, and (N − k p) ṗ is lost, which is k c p ṗ² ≥ 0 where the body is
/// pushed and −k p ṗ ≥ 0 where it leaves fast.
///
/// A free body that hits with speed v₁ leaves with e v₁, for any k and mass:
///
///   ln(1 + c v₁) − c v₁ = ln(1 − c e v₁) + c e v₁,   e = 1 − ⅔ c v₁ + O(c² v₁²)
///
/// For an angle p read rad for m and N·m for N.
///
/// Source: Hunt & Crossley, Coefficient of restitution interpreted as damping in vibroimpact,
/// J. Appl. Mech. 42(2), 1975, with damping λ = c k and exponent n = 1.

/// N [N], with k [N/m], c [s/m], p [m] and ṗ [m/s].
inline double HuntCrossleyForce(double k, double c, double p, double p_dot) {
  return p > 0 ? std::max(0.0, k * p * (1 + c * p_dot)) : 0.0;
}

/// (N − k p) ṗ [W].
inline double HuntCrossleyLoss(double k, double c, double p, double p_dot) {
  return p > 0 ? k * p * p_dot * std::max(c * p_dot, -1.0) : 0.0;
}

}  // namespace pliant
