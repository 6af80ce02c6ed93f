#include "pliant/analysis/shapiro_wilk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pliant/analysis/distributions.h"
#include "pliant/systems/error.h"
#include "pliant/systems/random.h"

namespace pliant {
namespace {

using testing::ThrowsMessage;

// Shapiro & Wilk, Biometrika 52 (1965), 606, example 1: W = 0.79, significant at 0.01; all digits
// as in the documentation of SciPy 1.12, scipy.stats.shapiro.
TEST(ShapiroWilk, AgreesOnTheWeightsOfElevenMen) {
  const ShapiroWilk test = ShapiroWilkTest({148, 154, 158, 160, 161, 162, 166, 170, 182, 195, 236});
  EXPECT_NEAR(test.w, 0.79, 0.005);
  EXPECT_LT(test.p, 0.01);
  EXPECT_NEAR(test.w, 0.7888146948631716, 1e-9);  // other normal quantiles: AS 241
  EXPECT_NEAR(test.p, 0.006703814061898823, 1e-9);
}

/// A sample of n with this W: normal quantiles, bent until they have it.
std::vector<double> SampleWith(double w, int n) {
  const auto bent = [&](double by) {
    std::vector<double> values;
    for (int i = 1; i <= n; ++i)
      values.push_back(std::exp(by * internal::NormalQuantile((i - 0.375) / (n + 0.25))));
    return values;
  };
  double straight = 1e-3, bowed = 5;
  for (int k = 0; k < 60; ++k) {
    const double middle = (straight + bowed) / 2;
    (ShapiroWilkTest(bent(middle)).w > w ? straight : bowed) = middle;
  }
  return bent(bowed);
}

// Shapiro & Wilk, Biometrika 52 (1965), table 6: the W below which a share p of normal samples
// lies. That table is a fit to at most 5000 samples of each size, so that its p are off by the
// deviation of such a share and by the fit: 4 deviations and a tenth. Up to n = 20, above which
// that paper approximates a.
TEST(ShapiroWilk, AgreesWithTheTableOfShapiroAndWilk) {
  struct Row {
    int n;
    double w_01, w_05, w_10;
  };
  for (const Row& row :
       {Row{10, 0.781, 0.842, 0.869}, Row{15, 0.835, 0.881, 0.901}, Row{20, 0.868, 0.905, 0.920}})
    for (const auto& [p, w] :
         std::map<double, double>{{0.01, row.w_01}, {0.05, row.w_05}, {0.1, row.w_10}})
      EXPECT_NEAR(ShapiroWilkTest(SampleWith(w, row.n)).p, p,
                  4 * std::sqrt(p * (1 - p) / 5000) + 0.1 * p)
          << "n = " << row.n << ", W = " << w;
}

// SciPy 1.10.1, scipy.stats.shapiro, which computes in single precision.
TEST(ShapiroWilk, AgreesWithSciPyInEveryRangeOfSizes) {
  const std::vector<double> normal = {0.346,  0.822, 0.33,  -1.303, 0.905,  0.446,  -0.537,
                                      0.581,  0.365, 0.294, 0.028,  0.547,  -0.736, -0.163,
                                      -0.482, 0.599, 0.04,  -0.292, -0.782, -0.257, 0.008,
                                      -0.276, 1.294, 1.007, -2.711};
  std::vector<double> skewed = {0.784, -0.284, -0.12,  -3.162, 3.2,   2.216,  0.012,
                                1.661, 0.922,  -0.331, 1.966,  0.034, 0.007,  -0.688,
                                1.182, 0.351,  1.318,  -0.411, 0.69,  -0.838, 1.762,
                                0.782, 0.996,  1.116,  -1.016, 1.675, 3.585,  -1.958};
  for (double& x : skewed) x = std::exp(x);
  const double single = 1e-5;  // n last digits of 2⁻²⁴
  const auto expect = [&](const std::vector<double>& x, double w, double p) {
    const ShapiroWilk test = ShapiroWilkTest(x);
    EXPECT_NEAR(test.w, w, single) << x.size();
    EXPECT_NEAR(test.p, p, 10 * single * p) << x.size();
  };
  expect({1, 2, 4}, 0.9642857313156128, 0.6368856430053711);
  expect({1, 2, 4, 9}, 0.8946863412857056, 0.405147522687912);
  expect({1, 3, 4, 5, 9}, 0.9556270837783813, 0.7772530913352966);
  expect(normal, 0.9085996150970459, 0.028367359191179276);
  expect(skewed, 0.5370393991470337, 2.809255406077682e-08);
}

TEST(ShapiroWilk, IsExactForThreeValues) {
  // W of 0, x, 1 is ½ / Σ (xᵢ − x̄)²; p = (6/π) (arcsin √W − π/3).
  for (const double x : {0.0, 0.1, 0.3, 0.5, 1.0}) {
    const double mean = (1 + x) / 3;
    const double w = 0.5 / (mean * mean + (x - mean) * (x - mean) + (1 - mean) * (1 - mean));
    const ShapiroWilk test = ShapiroWilkTest({1, 0, x});
    EXPECT_NEAR(test.w, w, 1e-15);
    // arcsin is steep near 1: the root of a last digit.
    EXPECT_NEAR(
        test.p,
        6 / std::numbers::pi * (std::asin(std::sqrt(std::min(w, 1.0))) - std::numbers::pi / 3),
        1e-7);
  }
}

TEST(ShapiroWilk, IsTheSameInAnyUnitAndOrder) {
  const RandomStream random(4);
  for (const int n : {3, 4, 5, 6, 11, 12, 50}) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back(random.Normal(static_cast<std::uint64_t>(i)));
    const ShapiroWilk before = ShapiroWilkTest(values);
    std::ranges::reverse(values);
    for (double& x : values) x = -1e-6 * x + 0.002;
    const ShapiroWilk after = ShapiroWilkTest(values);
    // A last digit of 0.002 against a spread of 1e-6.
    EXPECT_NEAR(before.w, after.w, 1e-11) << n;
    EXPECT_NEAR(before.p, after.p, 1e-9) << n;
  }
}

TEST(ShapiroWilk, RejectsNormalSamplesAsOftenAsItSays) {
  // The share of p < α is binomial; Royston's approximation of p is good to some tenths of α.
  for (const int n : {3, 4, 7, 11, 12, 30, 200}) {
    constexpr int kTrials = 4000;
    const RandomStream random = RandomStream(5).Part(static_cast<std::uint64_t>(n));
    int rejected = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> values;
      for (int i = 0; i < n; ++i) {
        values.push_back(random.Normal(static_cast<std::uint64_t>(trial * n + i)));
      }
      rejected += ShapiroWilkTest(values).p < 0.05;
    }
    const double share = static_cast<double>(rejected) / kTrials;
    EXPECT_NEAR(share, 0.05, 4 * std::sqrt(0.05 * 0.95 / kTrials) + 0.003) << n;
  }
}

TEST(ShapiroWilk, StaysWithinItsBoundsForTheWorstSamples) {
  // W ≥ n a₁² / (n − 1), reached by one value apart from n − 1 equal ones.
  for (const std::size_t n : {3u, 4u, 5u, 11u, 12u, 5000u}) {
    std::vector<double> values(n, 1.0);
    values.back() = 2;
    const ShapiroWilk test = ShapiroWilkTest(values);
    EXPECT_GT(test.w, 0);
    EXPECT_LE(test.w, 1);
    EXPECT_GE(test.p, 0);
    EXPECT_LT(test.p, 0.02) << n;
  }
}

TEST(ShapiroWilk, RefusesSamplesThatHaveNoW) {
  EXPECT_THAT(
      [] {
        ShapiroWilkTest({1, 2});
      },
      ThrowsMessage<Error>("Shapiro–Wilk: the sample must have at least 3 values, got 2"));
  EXPECT_THAT(
      [] { ShapiroWilkTest(std::vector<double>(5001, 1.0)); },
      ThrowsMessage<Error>("Shapiro–Wilk: the sample must have at most 5000 values, got 5001"));
  EXPECT_THAT(
      [] {
        ShapiroWilkTest({3, 3, 3});
      },
      ThrowsMessage<Error>("Shapiro–Wilk: the values must not all be equal, got 3"));
  EXPECT_THAT(
      [] {
        ShapiroWilkTest({1, 2, std::numeric_limits<double>::infinity()});
      },
      ThrowsMessage<Error>("Shapiro–Wilk: the sample: value 3 must be finite: leave out "
                           "what was not measured, got inf"));
}

}  // namespace
}  // namespace pliant
