#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant::internal {

/// A number and its first two rates.
struct Course {
  double s = 0, rate = 0, acceleration = 0;
};

/// 10 x³ − 15 x⁴ + 6 x⁵ of x = t/T, held at both ends.
inline Course LeastJerk(double t, double T) {
  const double x = std::clamp(t / T, 0.0, 1.0);
  return {x * x * x * (10 + x * (-15 + 6 * x)), 30 * x * x * (1 - x) * (1 - x) / T,
          60 * x * (1 - x) * (1 - 2 * x) / (T * T)};
}

/// ½ (1 − cos 2π f t) for t ≥ 0.
inline Course Swing(double t, double frequency_hz) {
  if (t < 0) return {};
  const double w = 2 * std::numbers::pi * frequency_hz;
  return {0.5 * (1 - std::cos(w * t)), 0.5 * w * std::sin(w * t), 0.5 * w * w * std::cos(w * t)};
}

}  // namespace pliant::internal
