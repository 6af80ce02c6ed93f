#include "pliant/analysis/mann_whitney.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pliant/systems/error.h"
#include "pliant/systems/random.h"

namespace pliant {
namespace {

using testing::ThrowsMessage;

// Sums of at most some thousand positive numbers, divided once.
constexpr double kRoundOff = 1e-14;

/// The test of n and m different values whose U is u.
MannWhitney TestWithU(int n, int m, int u, const MannWhitneyOptions& options = {}) {
  std::vector<double> first, second;
  for (int j = 1; j <= m; ++j) second.push_back(j);
  for (int i = 0; i < n; ++i) {
    const int below = std::min(u, m);
    first.push_back(below + 0.25 + 0.5 * i / n);
    u -= below;
  }
  return MannWhitneyTest(first, second, options);
}

/// Values of few different sizes if `levels` is small.
std::vector<double> Draw(const RandomStream& random, int n, int levels, double shift = 0) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) {
    values.push_back(std::floor(levels * random.Uniform(static_cast<std::uint64_t>(i))) + shift);
  }
  return values;
}

// Mann & Whitney, Ann. Math. Statist. 18 (1947), table I: P(U ≤ u), three decimals.
TEST(MannWhitney, AgreesWithTheTableOfMannAndWhitney) {
  const std::map<int, std::vector<double>> table = {
      {3, {0.050, 0.100, 0.200, 0.350, 0.500}},
      {4, {0.014, 0.029, 0.057, 0.100, 0.171, 0.243, 0.343, 0.443, 0.557}}};
  for (const auto& [n, row] : table) {
    for (int u = 0; u < static_cast<int>(row.size()); ++u) {
      EXPECT_NEAR(TestWithU(n, n, u).p_less, row[static_cast<std::size_t>(u)], 0.0005 + kRoundOff)
          << n << ", " << u;
    }
  }
}

// The largest U that is significant at 0.05, two-sided, as printed in textbooks after Auble (1953);
// rows n = 5, 8, 10 from m = n on, and n = m from 5 to 20.
TEST(MannWhitney, AgreesWithTheTablesOfCriticalValues) {
  const auto expect_critical = [](int n, int m, int critical) {
    EXPECT_LE(TestWithU(n, m, critical).p_two_sided, 0.05) << n << ", " << m;
    EXPECT_GT(TestWithU(n, m, critical + 1).p_two_sided, 0.05) << n << ", " << m;
  };
  const std::map<int, std::vector<int>> rows = {
      {5, {2, 3, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 17, 18, 19, 20}},
      {8, {13, 15, 17, 19, 22, 24, 26, 29, 31, 34, 36, 38, 41}},
      {10, {23, 26, 29, 33, 36, 39, 42, 45, 48, 52, 55}}};
  for (const auto& [n, row] : rows) {
    for (std::size_t j = 0; j < row.size(); ++j) {
      expect_critical(n, n + static_cast<int>(j), row[j]);
      expect_critical(n + static_cast<int>(j), n, row[j]);
    }
  }
  const std::vector<int> diagonal = {2, 5, 8, 13, 17, 23, 30, 37, 45, 55, 64, 75, 87, 99, 113, 127};
  for (std::size_t j = 0; j < diagonal.size(); ++j) {
    expect_critical(5 + static_cast<int>(j), 5 + static_cast<int>(j), diagonal[j]);
  }
}

// SciPy 1.10.1, scipy.stats.mannwhitneyu(x, y, method='exact' and 'asymptotic')
TEST(MannWhitney, AgreesWithSciPy) {
  const std::vector<double> x = {0.346,  0.822, 0.33,  -1.303, 0.905,  0.446,  -0.537,
                                 0.581,  0.365, 0.294, 0.028,  0.547,  -0.736, -0.163,
                                 -0.482, 0.599, 0.04,  -0.292, -0.782, -0.257, 0.008,
                                 -0.276, 1.294, 1.007, -2.711};
  const std::vector<double> y = {0.784, -0.284, -0.12,  -3.162, 3.2,   2.216,  0.012,
                                 1.661, 0.922,  -0.331, 1.966,  0.034, 0.007,  -0.688,
                                 1.182, 0.351,  1.318,  -0.411, 0.69,  -0.838, 1.762,
                                 0.782, 0.996,  1.116,  -1.016, 1.675, 3.585,  -1.958};
  const MannWhitney exact = MannWhitneyTest(x, y);
  EXPECT_EQ(exact.distribution, NullDistribution::kExact);
  EXPECT_EQ(exact.u, 256);
  EXPECT_NEAR(exact.p_greater, 0.95380529595634733, kRoundOff);
  EXPECT_NEAR(exact.p_less, 0.047973938045623964, kRoundOff);
  EXPECT_NEAR(exact.p_two_sided, 0.095947876091247927, kRoundOff);

  const MannWhitney normal = MannWhitneyTest(x, y, {.exact_pairs = 0});
  EXPECT_EQ(normal.distribution, NullDistribution::kNormal);
  EXPECT_NEAR(normal.p_greater, 0.95388459936455416, kRoundOff);
  EXPECT_NEAR(normal.p_less, 0.047863837333757542, kRoundOff);

  const MannWhitney tied = MannWhitneyTest({1, 2, 2, 3, 3, 3, 4, 5, 5, 7},
                                           {2, 3, 4, 4, 5, 6, 7, 7, 8}, {.exact_pairs = 0});
  EXPECT_EQ(tied.u, 24.5);
  EXPECT_NEAR(tied.p_greater, 0.95858855085213213, kRoundOff);
  EXPECT_NEAR(tied.p_less, 0.049273419663672484, kRoundOff);
  EXPECT_NEAR(tied.p_two_sided, 0.098546839327344968, kRoundOff);
}

TEST(MannWhitney, SaysWhichDistributionWasUsed) {
  EXPECT_EQ(MannWhitneyTest({1, 2}, {3, 4}).distribution, NullDistribution::kExact);
  EXPECT_EQ(MannWhitneyTest({1, 2}, {2, 4}).distribution, NullDistribution::kExactWithTies);
  EXPECT_EQ(MannWhitneyTest({1, 2}, {2, 4}, {.exact_pairs = 3}).distribution,
            NullDistribution::kNormal);
}

TEST(MannWhitney, EffectIsOneWhenTheFirstSampleIsLargerThroughout) {
  EXPECT_EQ(MannWhitneyTest({4, 5, 6}, {1, 2, 3}).rank_biserial, 1);
  EXPECT_EQ(MannWhitneyTest({1, 2, 3}, {4, 5, 6}).rank_biserial, -1);
  EXPECT_EQ(MannWhitneyTest({1, 2, 3}, {1, 2, 3}).rank_biserial, 0);
}

// Wendt, Eur. J. Soc. Psychol. 2 (1972), 463: r = 1 − 2 U/(n m), U the smaller of the two; the race
// of six hares and six tortoises, T H H H H H T T T T T H from first to last, of which tortoises
// win 11 of 36 pairs, as told in textbooks after Aesop.
TEST(MannWhitney, EffectIsThatOfWendt) {
  const MannWhitney test = MannWhitneyTest({12, 6, 5, 4, 3, 2}, {11, 10, 9, 8, 7, 1});
  EXPECT_EQ(test.u, 11);
  EXPECT_NEAR(test.rank_biserial, -(1 - 2 * 11.0 / 36), kRoundOff);
}

/// U by its definition, over all pairs.
double CountU(const std::vector<double>& first, const std::vector<double>& second) {
  double u = 0;
  for (const double x : first) {
    for (const double y : second) u += x > y ? 1 : x == y ? 0.5 : 0;
  }
  return u;
}

TEST(MannWhitney, EqualsTheEnumerationOfAllPermutationsWithAndWithoutTies) {
  const RandomStream random(1);
  for (std::uint64_t round = 0; round < 60; ++round) {
    const RandomStream part = random.Part(round);
    const int n = 1 + static_cast<int>(6 * part.Uniform(100));
    const int m = 1 + static_cast<int>(6 * part.Uniform(101));
    const int levels = round % 3 == 0 ? 1'000'000 : 2 + static_cast<int>(5 * part.Uniform(102));
    const std::vector<double> first = Draw(part.Part(0), n, levels);
    const std::vector<double> second = Draw(part.Part(1), m, levels);
    std::vector<double> all = first;
    all.insert(all.end(), second.begin(), second.end());
    const double u = CountU(first, second);
    double less = 0, greater = 0, permutations = 0;
    for (unsigned mask = 0; mask < 1u << (n + m); ++mask) {
      if (std::popcount(mask) != n) continue;
      std::vector<double> dealt, rest;
      for (std::size_t i = 0; i < all.size(); ++i) (mask >> i & 1 ? dealt : rest).push_back(all[i]);
      const double other = CountU(dealt, rest);
      ++permutations;
      less += other <= u;
      greater += other >= u;
    }
    const MannWhitney test = MannWhitneyTest(first, second);
    EXPECT_EQ(test.u, u);
    EXPECT_DOUBLE_EQ(test.p_less, less / permutations) << "round " << round;
    EXPECT_DOUBLE_EQ(test.p_greater, greater / permutations) << "round " << round;
  }
}

TEST(MannWhitney, MirrorsWhenTheSamplesAreSwapped) {
  const RandomStream random(2);
  for (const int exact_pairs : {0, 2500}) {
    for (std::uint64_t round = 0; round < 20; ++round) {
      const RandomStream part = random.Part(round);
      const std::vector<double> first = Draw(part.Part(0), 12, 9);
      const std::vector<double> second = Draw(part.Part(1), 5 + static_cast<int>(round), 9);
      const MannWhitney a = MannWhitneyTest(first, second, {.exact_pairs = exact_pairs});
      const MannWhitney b = MannWhitneyTest(second, first, {.exact_pairs = exact_pairs});
      EXPECT_EQ(a.u + b.u, static_cast<double>(first.size() * second.size()));
      EXPECT_NEAR(a.rank_biserial, -b.rank_biserial, kRoundOff);
      EXPECT_NEAR(a.p_less, b.p_greater, kRoundOff);
      EXPECT_NEAR(a.p_greater, b.p_less, kRoundOff);
      EXPECT_NEAR(a.p_two_sided, b.p_two_sided, kRoundOff);
    }
  }
}

TEST(MannWhitney, IsTheSameAfterAnyIncreasingFunction) {
  const RandomStream random(3);
  for (std::uint64_t round = 0; round < 20; ++round) {
    std::vector<double> first = Draw(random.Part(2 * round), 11, 15);
    std::vector<double> second = Draw(random.Part(2 * round + 1), 14, 15);
    const MannWhitney before = MannWhitneyTest(first, second);
    for (double& x : first) x = std::exp(x) - 3;
    for (double& y : second) y = std::exp(y) - 3;
    const MannWhitney after = MannWhitneyTest(first, second);
    EXPECT_EQ(before.u, after.u);
    EXPECT_EQ(before.p_less, after.p_less);
    EXPECT_EQ(before.p_greater, after.p_greater);
  }
}

TEST(MannWhitney, ExactProbabilitiesSumToOne) {
  for (const auto& [n, m] : std::vector<std::pair<int, int>>{{1, 1}, {3, 7}, {9, 4}, {30, 30}}) {
    for (int u = 0; u < n * m; ++u) {
      EXPECT_NEAR(TestWithU(n, m, u).p_less + TestWithU(n, m, u + 1).p_greater, 1, kRoundOff)
          << n << ", " << m << ", " << u;
      if (n == 30) u += 97;  // a few of 900
    }
    EXPECT_EQ(TestWithU(n, m, n * m).p_less, 1);
    EXPECT_EQ(TestWithU(n, m, 0).p_greater, 1);
  }
}

TEST(MannWhitney, SmallestProbabilityIsOneOverTheNumberOfPermutations) {
  // 60 over 30, which double and the sum that leads to it hold to their last digits.
  EXPECT_DOUBLE_EQ(TestWithU(30, 30, 0).p_less, 1 / 118264581564861424.0);
}

TEST(MannWhitney, NormalApproximationConvergesToTheExactDistribution) {
  // The first term that the Edgeworth series adds is γ (z³ − 3 z) φ(z) / 24, largest at z = −0.742,
  // with γ the excess kurtosis of U (Kendall & Stuart, The Advanced Theory of Statistics, vol. 2);
  // the next is of order 1 / n².
  const double z = -std::sqrt(3 - std::sqrt(6.0));
  const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
  for (const int n : {6, 12, 24, 48}) {
    const double pairs = n * n, total = 2 * n;
    const double kurtosis = -1.2 * (3 * pairs + total) / (pairs * (total + 1));
    const double theory = -kurtosis / 24 * (z * z * z - 3 * z) * density;
    const int u =
        static_cast<int>(std::lround(pairs / 2 + z * std::sqrt(pairs * (total + 1) / 12)));
    const double off = TestWithU(n, n, u, {.exact_pairs = 0}).p_less - TestWithU(n, n, u).p_less;
    EXPECT_NEAR(off, -theory, 0.03 / pairs) << "n = m = " << n;
  }
}

TEST(MannWhitney, ValuesAllEqualShowNothing) {
  for (const int exact_pairs : {0, 2500}) {
    const MannWhitney test = MannWhitneyTest({2, 2, 2}, {2, 2}, {.exact_pairs = exact_pairs});
    EXPECT_EQ(test.u, 3);
    EXPECT_EQ(test.rank_biserial, 0);
    EXPECT_EQ(test.p_less, 1);
    EXPECT_EQ(test.p_greater, 1);
    EXPECT_EQ(test.p_two_sided, 1);
  }
}

TEST(MannWhitney, RefusesWhatItCannotRank) {
  EXPECT_THAT([] { MannWhitneyTest({}, {1}); },
              ThrowsMessage<Error>("the first sample must have at least one value, got 0"));
  EXPECT_THAT([] { MannWhitneyTest({1}, {}); },
              ThrowsMessage<Error>("the second sample must have at least one value, got 0"));
  EXPECT_THAT(
      [] {
        MannWhitneyTest({1}, {2, std::numeric_limits<double>::quiet_NaN()});
      },
      ThrowsMessage<Error>(
          "the second sample: value 2 must be finite: leave out what was not measured, got nan"));
  EXPECT_THAT([] { MannWhitneyTest({1}, {2}, {.exact_pairs = 20'000}); },
              ThrowsMessage<Error>("exact_pairs must lie in 0 … 10000, got 20000"));
}

}  // namespace
}  // namespace pliant
