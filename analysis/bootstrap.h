#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pliant/analysis/interval.h"

namespace pliant {

/// A number of a sample, such as its mean or median. The same sample gives the same number.
using SampleStatistic = std::function<double(const std::vector<double>&)>;

enum class BootstrapMethod {
  kPercentile,  ///< the middle share of the resamples
  kBca          ///< the same, corrected for bias and skewness
};

struct BootstrapOptions {
  double confidence = 0.95;  ///< 1 − 2 α, between 0 and 1
  int resamples = 10'000;    ///< B, of which at least one in each tail: B α ≥ 1
  BootstrapMethod method = BootstrapMethod::kBca;
  std::uint64_t seed = 0;
};

/// In which interval a statistic θ of a population lies, from one sample of it: B resamples of the
/// sample's size are drawn from it with replacement, and their statistics θ*ᵦ put in order.
///
///   percentile  the quantiles α and 1 − α of θ*
///   BCa         the quantiles Φ(z₀ + w / (1 − a w)) of θ*, w = z₀ ± Φ⁻¹(1 − α)
///               z₀ = Φ⁻¹(#{θ*ᵦ < θ̂}/B + ½ #{θ*ᵦ = θ̂}/B)
///               a  = Σ uᵢ³ / (6 (Σ uᵢ²)^(3/2)),   uᵢ = (n − 1)/n (mean of θ̂₍ⱼ₎ over j − θ̂₍ᵢ₎)
///
/// where θ̂₍ᵢ₎ leaves the i-th value out. With fewer than about 20 values both are too narrow.
/// Source: Efron & Tibshirani, An Introduction to the Bootstrap (1993), (14.9) … (14.15).
struct Bootstrap {
  double estimate;        ///< θ̂
  double standard_error;  ///< standard deviation of θ*
  Interval interval;
};

/// Of one sample of two values or more. The same seed gives the same interval, bit for bit.
Bootstrap BootstrapOf(const std::vector<double>& sample, const SampleStatistic& statistic,
                      const BootstrapOptions& options = {});

/// Of θ(first) − θ(second), two samples that were drawn apart; a then sums over both.
Bootstrap BootstrapOfDifference(const std::vector<double>& first, const std::vector<double>& second,
                                const SampleStatistic& statistic,
                                const BootstrapOptions& options = {});

}  // namespace pliant
