#include "pliant/systems/time_histogram.h"

#include <cmath>

#include "pliant/systems/error.h"

namespace pliant {

/// The inverse of BucketOf, at the upper end.
std::int64_t TimeHistogram::LongestOf(std::size_t bucket) {
  const auto b = static_cast<std::int64_t>(bucket);
  const std::int64_t shift = std::max<std::int64_t>(0, (b >> kBits) - 1);
  return ((b - (shift << kBits) + 1) << shift) - 1;
}

double TimeHistogram::Quantile(double q) const {
  Require(q >= 0 && q <= 1, "a quantile is from 0 to 1", q);
  const auto wanted = static_cast<std::int64_t>(std::ceil(q * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t b = 0; b + 1 < kBuckets; ++b) {
    seen += buckets_[b];
    if (seen > 0 && seen >= wanted)
      return 1e-9 * static_cast<double>(std::min(LongestOf(b), worst_ns_));
  }
  return worst();
}

}  // namespace pliant
