#pragma once

#include "pliant/systems/parameter.h"

namespace pliant {

/// How a distance e to a limit may shrink, as a bound on its acceleration. With the safety distance
/// d_s:
///
///   ë ≥ −λ ė − λ²/(4M²) (e − d_s)                                                      (EC 24)
///
/// M > 1 is overdamped: what sets out at rest comes up to d_s and does not pass it, also when
/// sampled and held every h ≤ 1/λ.
///
/// Source: Celerier et al. 2025 (EC); λ = 100 1/s and M = 2 as recommended there.
struct VelocityDamper {
  double rate = 100;         ///< λ [1/s], > 0
  double damping_ratio = 2;  ///< M ≥ 1

  /// The bound on ë; e − d_s is called `room`.
  double Least(double room, double edot) const {
    return -rate * edot - rate * rate / (4 * damping_ratio * damping_ratio) * room;
  }

  template <class F>
  void Parameters(F&& f) {
    f("rate", rate, "1/s", kPositive);
    f("damping_ratio", damping_ratio, "", Range{.least = 1});
  }
};

}  // namespace pliant
