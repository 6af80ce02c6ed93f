#pragma once

#include <Eigen/Core>
#include <cmath>

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

}  // namespace pliant
