#pragma once

#include "pliant/systems/parameter.h"

namespace pliant {

/// How a task is followed, and how much of it gives way.
struct TaskGains {
  double stiffness;   ///< λ₂ [1/s²]
  double damping;     ///< λ₁ [1/s]
  double weight;      ///< w
  double compliance;  ///< γ in Γ = γ I

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "1/s²", kNotNegative);
    f("damping", damping, "1/s", kNotNegative);
    f("weight", weight, "", kPositive);
    f("compliance", compliance, "", kNotNegative);
  }
};

}  // namespace pliant
