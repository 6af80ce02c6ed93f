#pragma once

#include <vector>

namespace pliant {

/// Whether a sample may come from a normal distribution of any mean and deviation:
///
///   W = (Σ aᵢ x₍ᵢ₎)² / Σ (xᵢ − x̄)²,   x₍₁₎ ≤ … ≤ x₍ₙ₎
///
/// where a is near the direction in which the order statistics of normal values lie. W ≤ 1; small
/// W and p speak against a normal distribution.
/// Source: Royston, Applied Statistics 44 (1995), 547, algorithm AS R94; for n = 3 exact.
struct ShapiroWilk {
  double w;
  double p;  ///< P(W ≤ w) of a normal sample
};

/// Of 3 to 5000 values, not all equal.
ShapiroWilk ShapiroWilkTest(const std::vector<double>& values);

}  // namespace pliant
