#include "pliant/analysis/bootstrap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>

#include "pliant/analysis/distributions.h"
#include "pliant/analysis/summary.h"
#include "pliant/systems/error.h"
#include "pliant/systems/random.h"

namespace pliant {
namespace {

using testing::ThrowsMessage;

double Mean(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

double Deviation(const std::vector<double>& x) { return Summarize(x).standard_deviation; }

const std::vector<double> kSkewed = {0.11,  0.39,  1.4,   2.2,   0.343, 0.258, 0.435, 0.103,
                                     1.001, 0.066, 0.451, 3.348, 0.267, 1.285, 0.516, 2.034,
                                     0.908, 1.485, 0.289, 0.178, 0.002, 1.165, 0.894, 1.216,
                                     0.654, 0.575, 0.59,  0.584, 0.041, 2.157};
const std::vector<double> kOther = {0.346,  0.822, 0.33,  -1.303, 0.905,  0.446,  -0.537,
                                    0.581,  0.365, 0.294, 0.028,  0.547,  -0.736, -0.163,
                                    -0.482, 0.599, 0.04,  -0.292, -0.782, -0.257, 0.008,
                                    -0.276, 1.294, 1.007, -2.711};

// SciPy 1.10.1, scipy.stats.bootstrap(..., n_resamples=200000), means over two seeds.
TEST(Bootstrap, AgreesWithSciPyWithinTheErrorOfResampling) {
  // A quantile q of B resamples strays by √(q (1 − q) / B) / density; 1.2e-3 of a standard error
  // at 0.975, 3e-3 in the longer tail of BCa, and z₀ by √(π / 2 B): below 0.02 of a standard error
  // at 4 deviations for the percentiles, 0.1 for BCa.
  const int resamples = 100'000;
  const auto expect = [&](const auto& run, double error, Interval percentile, Interval bca) {
    const Bootstrap a = run(BootstrapOptions{
        .resamples = resamples, .method = BootstrapMethod::kPercentile, .seed = 1});
    EXPECT_NEAR(a.standard_error, error, 0.01 * error);  // 4 / √(2 B)
    EXPECT_NEAR(a.interval.lower, percentile.lower, 0.04 * error);
    EXPECT_NEAR(a.interval.upper, percentile.upper, 0.04 * error);
    const Bootstrap b =
        run(BootstrapOptions{.resamples = resamples, .method = BootstrapMethod::kBca, .seed = 1});
    EXPECT_NEAR(b.interval.lower, bca.lower, 0.1 * error);
    EXPECT_NEAR(b.interval.upper, bca.upper, 0.1 * error);
  };
  expect([](const BootstrapOptions& o) { return BootstrapOf(kSkewed, Mean, o); }, 0.14161,
         {.lower = 0.57148, .upper = 1.12483}, {.lower = 0.59957, .upper = 1.17035});
  expect([](const BootstrapOptions& o) { return BootstrapOf(kSkewed, Deviation, o); }, 0.14013,
         {.lower = 0.49386, .upper = 1.02961}, {.lower = 0.57555, .upper = 1.16099});
  expect([](const BootstrapOptions& o) { return BootstrapOfDifference(kSkewed, kOther, Mean, o); },
         0.21729, {.lower = 0.42298, .upper = 1.27314}, {.lower = 0.45502, .upper = 1.31794});
}

TEST(Bootstrap, StandardErrorOfAMeanIsTheTextbooks) {
  const auto n = static_cast<double>(kSkewed.size());
  // The resamples' population is the sample: its variance has n below the line.
  const double error = Deviation(kSkewed) * std::sqrt((n - 1) / n) / std::sqrt(n);
  const Bootstrap b = BootstrapOf(kSkewed, Mean, {.resamples = 20'000});
  EXPECT_NEAR(b.standard_error, error, 4 * error / std::sqrt(2 * 20'000.0));
  EXPECT_EQ(b.estimate, Mean(kSkewed));
}

// Efron & Tibshirani, table 2.1, seven mice under treatment, and table 2.2: the bootstrap's
// standard error of the mean is 23.36 for B → ∞.
TEST(Bootstrap, AgreesWithTheMiceOfEfronAndTibshirani) {
  const Bootstrap mice = BootstrapOf({94, 197, 16, 38, 99, 141, 23}, Mean, {.resamples = 100'000});
  EXPECT_NEAR(mice.estimate, 86.86, 0.005);
  EXPECT_NEAR(mice.standard_error, 23.36, 23.36 * 4 / std::sqrt(2e5));  // 4 / √(2 B)
}

TEST(Bootstrap, IsTheSameForTheSameSeedAndAnotherForAnother) {
  for (const BootstrapMethod method : {BootstrapMethod::kPercentile, BootstrapMethod::kBca}) {
    const BootstrapOptions seven{.resamples = 500, .method = method, .seed = 7};
    const BootstrapOptions eight{.resamples = 500, .method = method, .seed = 8};
    const Interval a = BootstrapOf(kSkewed, Mean, seven).interval;
    const Interval b = BootstrapOf(kSkewed, Mean, seven).interval;
    const Interval c = BootstrapOf(kSkewed, Mean, eight).interval;
    EXPECT_EQ(a.lower, b.lower);
    EXPECT_EQ(a.upper, b.upper);
    EXPECT_NE(a.lower, c.lower);
  }
}

TEST(Bootstrap, FollowsAnIncreasingFunctionOfTheStatistic) {
  // Resamples are chosen by rank; between two neighbours, here 1e-5 apart, the function is linear.
  const BootstrapOptions options{.resamples = 100'000, .method = BootstrapMethod::kPercentile};
  const Interval of_mean = BootstrapOf(kSkewed, Mean, options).interval;
  const Interval of_log =
      BootstrapOf(
          kSkewed, [](const std::vector<double>& x) { return std::log(Mean(x)); }, options)
          .interval;
  EXPECT_NEAR(std::exp(of_log.lower), of_mean.lower, 1e-6);
  EXPECT_NEAR(std::exp(of_log.upper), of_mean.upper, 1e-6);
}

TEST(Bootstrap, PercentileIntervalCoversTheMeanOfANormalAsTheorySays) {
  // The interval is x̄ ± z s √((n − 1)/n) / √n, so that it covers if |T| < z √((n − 1)/n), with
  // Student's t: less than 0.95 for a small n.
  constexpr int kTrials = 1000, kSize = 20;
  const double reach = internal::NormalQuantile(0.975) * std::sqrt((kSize - 1.0) / kSize);
  const double theory = 1 - 2 * internal::StudentAbove(reach, kSize - 1);
  const RandomStream random(10);
  int covered = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    std::vector<double> sample;
    for (std::uint64_t i = 0; i < kSize; ++i) sample.push_back(random.Part(trial).Normal(i));
    const Interval interval =
        BootstrapOf(sample, Mean,
                    {.resamples = 1000, .method = BootstrapMethod::kPercentile, .seed = trial})
            .interval;
    covered += interval.lower < 0 && 0 < interval.upper;
  }
  EXPECT_NEAR(static_cast<double>(covered) / kTrials, theory,
              4 * std::sqrt(theory * (1 - theory) / kTrials));
}

TEST(Bootstrap, BcaMissesASkewedMeanOnBothSidesAlikeAndPercentilesDoNot) {
  // Hall, Ann. Statist. 16 (1988), 927: to order 1/√n the percentiles miss γ z² φ(z) / (2 √n) more
  // often above and as much less below; BCa has no such term, and terms of 1/n are the same above
  // and below. γ = 2 for an exponential.
  constexpr int kTrials = 1000, kSize = 60;
  const double z = internal::NormalQuantile(0.975);
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
  const double uneven = 2 * (2 * z * z * density) / (2 * std::sqrt(kSize));
  const double chance = 4 * std::sqrt(0.06 / kTrials);  // of the difference of two shares of 0.03
  const RandomStream random(11);
  for (const BootstrapMethod method : {BootstrapMethod::kPercentile, BootstrapMethod::kBca}) {
    int above = 0, below = 0;
    for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
      std::vector<double> sample;
      for (std::uint64_t i = 0; i < kSize; ++i) {
        sample.push_back(-std::log(random.Part(trial).Uniform(i)));
      }
      const Interval interval =
          BootstrapOf(sample, Mean, {.resamples = 1000, .method = method, .seed = trial}).interval;
      above += interval.upper < 1;
      below += interval.lower > 1;
    }
    const double difference = static_cast<double>(above - below) / kTrials;
    EXPECT_NEAR(difference, method == BootstrapMethod::kBca ? 0 : uneven, chance);
  }
}

TEST(Bootstrap, OfADifferenceMirrorsWhenTheSamplesAreSwapped) {
  const BootstrapOptions options{.resamples = 20'000};
  const Bootstrap a = BootstrapOfDifference(kSkewed, kOther, Mean, options);
  const Bootstrap b = BootstrapOfDifference(kOther, kSkewed, Mean, options);
  EXPECT_EQ(a.estimate, -b.estimate);
  // Other numbers are drawn: 0.1 of a standard error at 100 000 resamples, √5 times that here.
  EXPECT_NEAR(a.interval.lower, -b.interval.upper, 0.22 * a.standard_error);
  EXPECT_NEAR(a.interval.upper, -b.interval.lower, 0.22 * a.standard_error);
}

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  const Bootstrap b = BootstrapOf({3, 3, 3}, Mean);
  EXPECT_EQ(b.standard_error, 0);
  EXPECT_EQ(b.interval.lower, 3);
  EXPECT_EQ(b.interval.upper, 3);
}

TEST(Bootstrap, RefusesWhatGivesNoInterval) {
  EXPECT_THAT([] { BootstrapOf({1}, Mean); },
              ThrowsMessage<Error>("the sample must have at least 2 values, got 1"));
  EXPECT_THAT(
      [] {
        BootstrapOfDifference({1, 2}, {1}, Mean);
      },
      ThrowsMessage<Error>("the second sample must have at least 2 values, got 1"));
  EXPECT_THAT(
      [] {
        BootstrapOf({1, std::numeric_limits<double>::quiet_NaN()}, Mean);
      },
      ThrowsMessage<Error>("the sample: value 2 must be finite: leave out what was not "
                           "measured, got nan"));
  EXPECT_THAT(
      [] {
        BootstrapOf({1, 2}, Mean, {.confidence = 95});
      },
      ThrowsMessage<Error>("confidence must lie between 0 and 1, got 95"));
  EXPECT_THAT(
      [] {
        BootstrapOf({1, 2}, Mean, {.confidence = 0.75, .resamples = 7});
      },
      ThrowsMessage<Error>("resamples must be at least 8 for a confidence of 0.75, so that "
                           "one lies in each tail, got 7"));
  const auto relative = [](const std::vector<double>& x) { return Mean(x) / Deviation(x); };
  EXPECT_THAT(
      [&] {
        BootstrapOf({3, 3}, relative);
      },
      ThrowsMessage<Error>("the statistic of the sample must lie within ±1e75, got inf"));
  EXPECT_THAT(
      [&] {
        BootstrapOf({1, 3, 3}, relative);
      },
      ThrowsMessage<Error>(
          "the statistic of the sample without its value 1 must lie within ±1e75, got inf"));
  EXPECT_THAT(
      [&] {
        BootstrapOf({1, 3}, relative, {.method = BootstrapMethod::kPercentile});
      },
      ThrowsMessage<Error>("the statistic of a resample must lie within ±1e75, got inf"));
  // Of 25 different values, a resample has 25 once in 10¹⁰.
  const auto kinds = [](const std::vector<double>& x) {
    return static_cast<double>(std::set<double>(x.begin(), x.end()).size());
  };
  EXPECT_THAT([&] { BootstrapOf(kOther, kinds); },
              ThrowsMessage<Error>("BCa needs resamples on both sides of the estimate, and all lie "
                                   "on one: take kPercentile, or a statistic with less bias, got "
                                   "25"));
}

}  // namespace
}  // namespace pliant
