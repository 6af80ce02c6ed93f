#pragma once

#include <cstddef>
#include <vector>

namespace pliant {

/// What repetitions of a measurement have in common:
///
///   x̄ = Σ xᵢ / n,   s = √(Σ (xᵢ − x̄)² / (n − 1))
///
struct Summary {
  std::size_t n;
  double mean;
  double standard_deviation;  ///< s; 0 if there is one value only
  double lower_quartile, median, upper_quartile;
};

/// Of one finite value or more.
Summary Summarize(const std::vector<double>& values);

/// The number below which a share p of the values lies, 0 ≤ p ≤ 1: with the values in ascending
/// order x₀ … x₍ₙ₋₁₎, x at the place (n − 1) p, linear between neighbours.
/// Source: Hyndman & Fan, The American Statistician 50 (1996), 361, definition 7.
double Quantile(std::vector<double> values, double p);

}  // namespace pliant
