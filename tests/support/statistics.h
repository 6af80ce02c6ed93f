#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>

namespace pliant {

/// Bounds that a right program misses by chance once in some 15 000 trials. Seeds are fixed, so a
/// test that passes once always does.
inline constexpr double kDeviations = 4;

/// Of the mean of n independent numbers of standard deviation 1.
inline double MeanBound(Eigen::Index n) { return kDeviations / std::sqrt(static_cast<double>(n)); }

/// Of s²/σ² − 1, for n normal numbers: χ² has the variance 2 n.
inline double VarianceBound(Eigen::Index n) {
  return kDeviations * std::sqrt(2 / static_cast<double>(n));
}

/// Of χ² − its degrees of freedom, which are many: its variance is twice them.
inline double ChiSquareBound(Eigen::Index freedom) {
  return kDeviations * std::sqrt(2 * static_cast<double>(freedom));
}

/// Of the distance of Kolmogorov and Smirnov: √n D exceeds x with probability 2 exp(−2 x²).
inline double DistributionBound(Eigen::Index n) { return 2.28 / std::sqrt(static_cast<double>(n)); }

inline double Variance(const Eigen::VectorXd& x) {
  return (x.array() - x.mean()).square().sum() / static_cast<double>(x.size() - 1);
}

/// Of x_k and y_{k−lag}. For independent numbers its bound is that of a mean.
inline double Correlation(const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                          Eigen::Index lag = 0) {
  const Eigen::Index n = x.size() - lag;
  const Eigen::ArrayXd a = x.tail(n).array() - x.mean(), b = y.head(n).array() - y.mean();
  return (a * b).sum() / (static_cast<double>(n) * std::sqrt(Variance(x) * Variance(y)));
}

/// χ² of counts that are all expected to be alike, with one degree of freedom less than counts.
inline double ChiSquare(const Eigen::VectorXd& counts) {
  return (counts.array() - counts.mean()).square().sum() / counts.mean();
}

/// Kolmogorov and Smirnov's D = sup |F_n − F|, where F is the distribution x should have.
inline double DistributionError(Eigen::VectorXd x, const std::function<double(double)>& F) {
  std::ranges::sort(x);
  const auto n = static_cast<double>(x.size());
  double D = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double now = F(x(i)), below = static_cast<double>(i) / n;
    D = std::max({D, now - below, below + 1 / n - now});
  }
  return D;
}

}  // namespace pliant
