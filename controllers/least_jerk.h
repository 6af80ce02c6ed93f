#pragma once

#include <algorithm>

namespace pliant {

/// A number and its first two rates.
struct Course {
  double s, rate, acceleration;
};

/// 10 x³ − 15 x⁴ + 6 x⁵ of x = t/T, held at both ends: from 0 to 1 with least jerk.
/// Source: Flash & Hogan, J. Neuroscience 5(7), 1985.
inline Course LeastJerk(double t, double T) {
  const double x = std::clamp(t / T, 0.0, 1.0);
  return {x * x * x * (10 + x * (-15 + 6 * x)), 30 * x * x * (1 - x) * (1 - x) / T,
          60 * x * (1 - x) * (1 - 2 * x) / (T * T)};
}

}  // namespace pliant
