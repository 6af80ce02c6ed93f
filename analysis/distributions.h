#pragma once

namespace pliant::internal {

/// Of the standard normal distribution: P(Z ≤ z), P(Z > z), and the z below which a share p lies,
/// ±∞ at p = 1 and 0.
double NormalBelow(double z);
double NormalAbove(double z);
double NormalQuantile(double p);

/// Of Student's t with so many degrees of freedom, > 0 and not always whole: P(T > t), and the t
/// below which a share p lies, 0 < p < 1.
double StudentAbove(double t, double degrees_of_freedom);
double StudentQuantile(double p, double degrees_of_freedom);

}  // namespace pliant::internal
