#pragma once

#include <array>

#include "pliant/systems/time.h"

namespace pliant {

/// H(z) = (b₀ + b₁ z⁻¹ + b₂ z⁻²)/(1 + a₁ z⁻¹ + a₂ z⁻²), through which a Kinova arm's torque loop
/// sees its error, at 1 kHz: a lag with poles at 1 and 3 Hz, zeros at 8 and 20 Hz, static gain 1
/// and gain 0.019 at high frequencies.
/// Source: Muraccioli et al. 2025 (RSS); coefficients from mathieu-celerier/mc_kortex.
struct KinovaLag {
  static constexpr Duration period = 1ms;  ///< that the coefficients are for
  static constexpr std::array<double, 3> b{0.02017482, -0.03697504, 0.01691718};
  static constexpr std::array<double, 3> a{1, -1.975063, 0.9751799};
};

}  // namespace pliant
