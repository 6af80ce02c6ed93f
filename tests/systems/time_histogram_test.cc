#include "pliant/systems/time_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(TimeHistogram, QuantilesAreExactWithinABucket) {
  std::mt19937_64 random{7};
  std::lognormal_distribution<double> spans(std::log(2e4), 2.5);  // [ns], from ns to s
  TimeHistogram histogram;
  std::vector<std::int64_t> all(10'007);
  for (std::int64_t& ns : all) {
    ns = std::llround(spans(random));
    histogram.Count(ns);
  }
  std::ranges::sort(all);
  ASSERT_EQ(histogram.count(), std::ssize(all));
  EXPECT_EQ(histogram.worst(), 1e-9 * static_cast<double>(all.back()));
  for (const double q : {0.0, 1e-4, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
    const double n = std::ceil(q * static_cast<double>(all.size()));
    const double exact =
        1e-9 * static_cast<double>(all[static_cast<std::size_t>(std::max(n, 1.0)) - 1]);
    EXPECT_GE(histogram.Quantile(q), exact) << q;
    EXPECT_LE(histogram.Quantile(q), exact * (1 + TimeHistogram::kRelativeWidth)) << q;
  }
}

TEST(TimeHistogram, IsExactBelow256Nanoseconds) {
  for (std::int64_t ns = 0; ns < 256; ++ns) {
    TimeHistogram histogram;
    histogram.Count(ns);
    histogram.Count(1000);
    EXPECT_EQ(histogram.Quantile(0.5), 1e-9 * static_cast<double>(ns));
  }
}

TEST(TimeHistogram, KeepsTheOrderOfAllSpansAcrossBuckets) {
  double before = -1;
  for (std::int64_t ns = 0; ns < std::int64_t{1} << 39; ns += 1 + ns / 100) {
    TimeHistogram histogram;
    histogram.Count(ns);
    histogram.Count(std::int64_t{1} << 39);
    const double now = histogram.Quantile(0.5);
    ASSERT_GE(now, before) << ns;
    ASSERT_GE(now, 1e-9 * static_cast<double>(ns));
    ASSERT_LE(now, 1e-9 * static_cast<double>(ns) * (1 + TimeHistogram::kRelativeWidth));
    before = now;
  }
}

TEST(TimeHistogram, TakesSpansOfAnyLength) {
  TimeHistogram histogram;
  histogram.Count(-5);
  EXPECT_EQ(histogram.Quantile(1), 0);
  histogram.Count(std::int64_t{1} << 62);
  EXPECT_EQ(histogram.Quantile(0.5), 0);
  EXPECT_EQ(histogram.Quantile(1), 1e-9 * std::ldexp(1.0, 62));
  EXPECT_EQ(histogram.count(), 2);
}

TEST(TimeHistogram, OfNoSpansIsZero) {
  const TimeHistogram histogram;
  EXPECT_EQ(histogram.count(), 0);
  EXPECT_EQ(histogram.Quantile(0.5), 0);
  EXPECT_EQ(histogram.worst(), 0);
}

TEST(TimeHistogram, RefusesWhatIsNoQuantile) {
  const TimeHistogram histogram;
  EXPECT_EQ(ErrorOf([&] { histogram.Quantile(99); }), "a quantile is from 0 to 1, got 99");
  EXPECT_EQ(ErrorOf([&] { histogram.Quantile(std::nan("")); }),
            "a quantile is from 0 to 1, got nan");
}

}  // namespace
}  // namespace pliant
