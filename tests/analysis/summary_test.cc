#include "pliant/analysis/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using testing::ThrowsMessage;

TEST(Summary, IsThatOfTheFirstWholeNumbers) {
  const Summary s = Summarize({5, 1, 4, 2, 3});
  EXPECT_EQ(s.n, 5u);
  EXPECT_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.standard_deviation, std::sqrt(2.5));  // (4 + 1 + 0 + 1 + 4) / 4
  EXPECT_EQ(s.lower_quartile, 2);
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.upper_quartile, 4);
}

TEST(Summary, OfOneValueIsThatValueWithoutSpread) {
  const Summary s = Summarize({7});
  EXPECT_EQ(s.mean, 7);
  EXPECT_EQ(s.standard_deviation, 0);
  EXPECT_EQ(s.lower_quartile, 7);
  EXPECT_EQ(s.upper_quartile, 7);
}

TEST(Summary, KeepsTheDigitsOfASmallSpreadOnALargeMean) {
  // The deviations are ±1 and exact; a sum of squares less a squared sum would lose them.
  EXPECT_DOUBLE_EQ(Summarize({1e9 - 1, 1e9, 1e9 + 1}).standard_deviation, 1);
}

TEST(Quantile, IsLinearBetweenNeighbours) {
  EXPECT_DOUBLE_EQ(Quantile({20, 10, 40, 30}, 0.5), 25);
  EXPECT_DOUBLE_EQ(Quantile({20, 10, 40, 30}, 0.25), 17.5);
  EXPECT_EQ(Quantile({20, 10, 40, 30}, 0), 10);
  EXPECT_EQ(Quantile({20, 10, 40, 30}, 1), 40);
}

TEST(Summary, RefusesWhatIsNoMeasurement) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT([] { Summarize({}); },
              ThrowsMessage<Error>("sample must have at least one value, got 0"));
  EXPECT_THAT(
      [] {
        Summarize({1, kNan});
      },
      ThrowsMessage<Error>(
          "sample: value 2 must be finite: leave out what was not measured, got nan"));
  EXPECT_THAT(
      [] {
        Summarize({1, 2, -kInfinity});
      },
      ThrowsMessage<Error>(
          "sample: value 3 must be finite: leave out what was not measured, got -inf"));
  EXPECT_THAT([] { Summarize({1e200}); },
              ThrowsMessage<Error>(
                  "sample: value 1 must lie within ±1e75: choose another unit, got 1e+200"));
  EXPECT_THAT(
      [] {
        Quantile({1, 2}, 1.5);
      },
      ThrowsMessage<Error>("a quantile's share p must lie in 0 … 1, got 1.5"));
}

}  // namespace
}  // namespace pliant
