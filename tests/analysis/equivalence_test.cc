#include "pliant/analysis/equivalence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/error.h"
#include "pliant/systems/random.h"

namespace pliant {
namespace {

using testing::ThrowsMessage;

constexpr double kRoundOff = 1e-13;

std::vector<double> Normal(const RandomStream& random, int n, double mean, double deviation) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) {
    values.push_back(mean + deviation * random.Normal(static_cast<std::uint64_t>(i)));
  }
  return values;
}

// SciPy 1.10.1, scipy.stats.ttest_ind(x ± 0.9, y, equal_var=False, alternative='greater' and
// 'less')
TEST(EquivalenceOfMeans, AgreesWithSciPy) {
  const std::vector<double> x = {0.346,  0.822, 0.33,  -1.303, 0.905,  0.446,  -0.537,
                                 0.581,  0.365, 0.294, 0.028,  0.547,  -0.736, -0.163,
                                 -0.482, 0.599, 0.04,  -0.292, -0.782, -0.257, 0.008,
                                 -0.276, 1.294, 1.007, -2.711};
  const std::vector<double> y = {0.784, -0.284, -0.12,  -3.162, 3.2,   2.216,  0.012,
                                 1.661, 0.922,  -0.331, 1.966,  0.034, 0.007,  -0.688,
                                 1.182, 0.351,  1.318,  -0.411, 0.69,  -0.838, 1.762,
                                 0.782, 0.996,  1.116,  -1.016, 1.675, 3.585,  -1.958};
  const EquivalenceOfMeans test = TestEquivalenceOfMeans(x, y, {.margin = 0.9});
  EXPECT_NEAR(test.difference, -0.54890142857142865, kRoundOff);
  EXPECT_NEAR(test.degrees_of_freedom, 44.071368539158776, 100 * kRoundOff);
  EXPECT_NEAR(test.p_above_lower, 0.13961352416041042, kRoundOff);
  EXPECT_NEAR(test.p_below_upper, 2.2963140708650545e-05, kRoundOff);
  EXPECT_EQ(test.p, test.p_above_lower);
  // SciPy's quantile of Student's t has ten digits, Boost's all.
  EXPECT_NEAR(test.interval.lower, -1.0873580738340722, 1e-9);
  EXPECT_NEAR(test.interval.upper, -0.010444783308784955, 1e-9);
  EXPECT_FALSE(test.equivalent);
}

TEST(EquivalenceOfMeans, WelchsDegreesOfFreedomAreStudentsForLikeSamples) {
  EXPECT_DOUBLE_EQ(TestEquivalenceOfMeans({1, 2, 4}, {5, 6, 8}, {.margin = 1}).degrees_of_freedom,
                   4);
  // A constant sample tells nothing of the spread.
  EXPECT_DOUBLE_EQ(TestEquivalenceOfMeans({1, 2, 4}, {5, 5}, {.margin = 1}).degrees_of_freedom, 2);
}

TEST(EquivalenceOfMeans, IsTheIntervalLyingWithinTheMargins) {
  const RandomStream random(6);
  int equivalent = 0;
  for (std::uint64_t round = 0; round < 200; ++round) {
    const RandomStream part = random.Part(round);
    const EquivalenceOptions options{.margin = 0.2 + part.Uniform(0), .alpha = 0.05};
    const EquivalenceOfMeans test = TestEquivalenceOfMeans(
        Normal(part.Part(0), 12, 0, 1), Normal(part.Part(1), 30, 0, 0.3), options);
    EXPECT_EQ(test.equivalent,
              test.interval.lower > -options.margin && test.interval.upper < options.margin);
    equivalent += test.equivalent;
  }
  EXPECT_GT(equivalent, 20);  // both outcomes are seen
  EXPECT_LT(equivalent, 180);
}

TEST(EquivalenceOfMeans, ClaimsTooMuchAtTheMarginAsOftenAsAlphaAllows) {
  // At a difference of exactly Δ, far from −Δ, the size is α.
  constexpr int kTrials = 4000;
  const RandomStream random(7);
  int claimed = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const RandomStream part = random.Part(trial);
    claimed += TestEquivalenceOfMeans(Normal(part.Part(0), 15, 2, 1),
                                      Normal(part.Part(1), 15, 0, 1), {.margin = 2})
                   .equivalent;
  }
  EXPECT_NEAR(static_cast<double>(claimed) / kTrials, 0.05, 4 * std::sqrt(0.05 * 0.95 / kTrials));
}

TEST(Equivalence, MirrorsWhenTheSamplesAreSwapped) {
  const RandomStream random(8);
  for (std::uint64_t round = 0; round < 20; ++round) {
    const std::vector<double> first = Normal(random.Part(2 * round), 9, 0.2, 1);
    const std::vector<double> second = Normal(random.Part(2 * round + 1), 14, 0, 2);
    const EquivalenceOptions options{.margin = 1.5};
    const auto a = TestEquivalenceOfMeans(first, second, options);
    const auto b = TestEquivalenceOfMeans(second, first, options);
    EXPECT_NEAR(a.difference, -b.difference, kRoundOff);
    EXPECT_NEAR(a.p_above_lower, b.p_below_upper, kRoundOff);
    EXPECT_NEAR(a.interval.lower, -b.interval.upper, kRoundOff);
    const auto c = TestEquivalenceOfRanks(first, second, options);
    const auto d = TestEquivalenceOfRanks(second, first, options);
    EXPECT_NEAR(c.difference, -d.difference, kRoundOff);
    EXPECT_NEAR(c.p_above_lower, d.p_below_upper, kRoundOff);
    EXPECT_NEAR(c.p, d.p, kRoundOff);
  }
}

TEST(EquivalenceOfRanks, IsTheSmallestPossibleWhenTheMarginExceedsAllDifferences) {
  const EquivalenceOfRanks test =
      TestEquivalenceOfRanks({1, 2, 3, 4}, {1.5, 2.5, 3.5, 4.5}, {.margin = 10});
  EXPECT_DOUBLE_EQ(test.p_above_lower, 1 / 70.0);  // 8 over 4
  EXPECT_DOUBLE_EQ(test.p_below_upper, 1 / 70.0);
  EXPECT_TRUE(test.equivalent);
  EXPECT_EQ(test.difference, -0.5);
}

TEST(EquivalenceOfRanks, FindsAShiftWhateverOneValueIs) {
  EXPECT_EQ(
      TestEquivalenceOfRanks({11, 12, 13, 14, 1e6}, {1, 2, 3, 4, 5}, {.margin = 1}).difference, 10);
}

TEST(EquivalenceOfRanks, ClaimsTooMuchAtTheMarginNoMoreOftenThanAlpha) {
  constexpr int kTrials = 2000;
  const RandomStream random(9);
  int claimed = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const RandomStream part = random.Part(trial);
    claimed += TestEquivalenceOfRanks(Normal(part.Part(0), 10, 2, 1),
                                      Normal(part.Part(1), 10, 0, 1), {.margin = 2})
                   .equivalent;
  }
  // Exact tests are discrete: U ≤ 27 of 10 and 10 has the probability 0.0446, U ≤ 28 more than
  // 0.05.
  EXPECT_NEAR(static_cast<double>(claimed) / kTrials, 0.0446,
              4 * std::sqrt(0.0446 * 0.9554 / kTrials));
}

TEST(Equivalence, RefusesWhatItCannotDecide) {
  const std::vector<double> x = {1, 2, 3};
  EXPECT_THAT([&] { TestEquivalenceOfMeans(x, x, {.margin = 0}); },
              ThrowsMessage<Error>("margin must be > 0 and finite, got 0"));
  EXPECT_THAT(
      [&] { TestEquivalenceOfRanks(x, x, {.margin = std::numeric_limits<double>::infinity()}); },
      ThrowsMessage<Error>("margin must be > 0 and finite, got inf"));
  EXPECT_THAT([&] { TestEquivalenceOfMeans(x, x, {.margin = 1, .alpha = 0.5}); },
              ThrowsMessage<Error>("alpha must lie between 0 and 0.5, got 0.5"));
  EXPECT_THAT([&] { TestEquivalenceOfMeans(x, {1}, {.margin = 1}); },
              ThrowsMessage<Error>("the second sample must have at least 2 values, got 1"));
  EXPECT_THAT([&] { TestEquivalenceOfRanks({}, x, {.margin = 1}); },
              ThrowsMessage<Error>("the first sample must have at least one value, got 0"));
  EXPECT_THAT(
      [&] {
        TestEquivalenceOfMeans({2, 2}, {3, 3, 3}, {.margin = 1});
      },
      ThrowsMessage<Error>("equivalence of means: both samples are constant, and Welch's t "
                           "divides by their spread"));
}

}  // namespace
}  // namespace pliant
