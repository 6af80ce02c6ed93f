#pragma once

#include <cmath>
#include <numbers>

#include "pliant/systems/parameter.h"

namespace pliant {

/// How a structured-light camera errs about a depth z [m] of a surface whose normal has the angle θ
/// with the line of sight. Noise first, then steps of the inverse depth:
///
///   σ(z, θ) = a + b (z − 0.4 m)² + c √(1 m/z) (θ/(π/2 − θ))²,   the last term beyond 60°
///   1/z is rounded to multiples of s, so the depths are s z² apart
///
/// Sources: Nguyen, Izadi & Lovell, Modeling Kinect Sensor Noise, 3DIMPVT 2012, (3) and (4);
/// Khoshelham & Elberink, Sensors 12, 2012, depth resolution 2.85·10⁻⁵ z² [cm]. The first was
/// measured with the steps in, so both together are a little more than either.
struct DepthNoise {
  double floor = 0.0012;     ///< a [m]
  double growth = 0.0019;    ///< b [1/m]
  double grazing = 0.0001;   ///< c [m]
  double step = 0.00285;     ///< s [1/m]
  double widest_deg = 80.0;  ///< no reading at larger θ

  template <class F>
  void Parameters(F&& f) {
    f("floor", floor, "m", kNotNegative);
    f("growth", growth, "1/m", kNotNegative);
    f("grazing", grazing, "m", kNotNegative);
    f("step", step, "1/m", kNotNegative);
    f("widest_deg", widest_deg, "°", Between(1, 89.9));
  }

  static DepthNoise None() { return {.floor = 0, .growth = 0, .grazing = 0, .step = 0}; }

  double Deviation(double z, double theta = 0) const {
    constexpr double kSteep = std::numbers::pi / 3;
    double sigma = floor + growth * (z - 0.4) * (z - 0.4);
    if (theta > kSteep)
      sigma += grazing / std::sqrt(z) * std::pow(theta / (std::numbers::pi / 2 - theta), 2);
    return sigma;
  }
  /// Of neighbouring depths.
  double Spacing(double z) const { return step * z * z; }
  double Rounded(double z) const { return step > 0 ? 1 / (step * std::round(1 / (step * z))) : z; }
};

}  // namespace pliant
