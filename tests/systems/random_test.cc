#include "pliant/systems/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::VectorXd;

constexpr Eigen::Index kMany = 1'000'000;

using Numbers = std::function<double(std::uint64_t)>;

VectorXd Drawn(Eigen::Index n, const Numbers& number) {
  VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x(i) = number(static_cast<std::uint64_t>(i));
  return x;
}

/// χ² of the places of pairs of numbers in (0, 1)² on a grid of 32 × 32.
void ExpectIndependent(const VectorXd& x, const VectorXd& y, const char* what) {
  constexpr int kSide = 32;
  const Eigen::Index n = std::min(x.size(), y.size());
  VectorXd counts = VectorXd::Zero(kSide * kSide);
  for (Eigen::Index i = 0; i < n; ++i)
    ++counts(static_cast<int>(x(i) * kSide) * kSide + static_cast<int>(y(i) * kSide));
  EXPECT_LT(std::abs(ChiSquare(counts) - (kSide * kSide - 1)), ChiSquareBound(kSide * kSide - 1))
      << what;
  EXPECT_LT(std::abs(Correlation(x.head(n), y.head(n))), MeanBound(n)) << what;
}

void ExpectUniform(const VectorXd& x, const char* what) {
  constexpr int kBins = 1000;
  VectorXd counts = VectorXd::Zero(kBins);
  for (const double u : x) {
    ASSERT_TRUE(u > 0 && u < 1) << what;
    ++counts(static_cast<int>(u * kBins));
  }
  EXPECT_LT(std::abs(ChiSquare(counts) - (kBins - 1)), ChiSquareBound(kBins - 1)) << what;
  EXPECT_LT(DistributionError(x, std::identity{}), DistributionBound(x.size())) << what;
}

TEST(RandomStream, IsUniform) {
  for (const std::uint64_t seed : {0ull, 1ull, 42ull, ~0ull}) {
    const RandomStream random(seed);
    ExpectUniform(Drawn(kMany, [&](std::uint64_t n) { return random.Uniform(n); }), "a stream");
  }
}

TEST(RandomStream, IsUniformOverSeedsAndParts) {
  ExpectUniform(Drawn(kMany, [](std::uint64_t s) { return RandomStream(s).Uniform(0); }), "seeds");
  ExpectUniform(Drawn(kMany, [](std::uint64_t p) { return RandomStream(1).Part(p).Uniform(0); }),
                "parts");
}

TEST(RandomStream, IsNormal) {
  const RandomStream random(7);
  const VectorXd x = Drawn(kMany, [&](std::uint64_t n) { return random.Normal(n); });
  // Over n normal numbers the means of x, x², x³ and x⁴ have the variances 1/n, 2/n, 15/n and 96/n.
  const auto n = static_cast<double>(kMany);
  EXPECT_LT(std::abs(x.mean()), MeanBound(kMany));
  EXPECT_LT(std::abs(x.array().square().mean() - 1), VarianceBound(kMany));
  EXPECT_LT(std::abs(x.array().cube().mean()), kDeviations * std::sqrt(15 / n));
  EXPECT_LT(std::abs(x.array().pow(4).mean() - 3), kDeviations * std::sqrt(96 / n));
  EXPECT_LT(
      DistributionError(x, [](double t) { return 0.5 * std::erfc(-t / std::numbers::sqrt2); }),
      DistributionBound(kMany));
  EXPECT_LT(std::abs(Correlation(x, x, 1)), MeanBound(kMany - 1));
}

TEST(RandomStream, HasIndependentNumbers) {
  const RandomStream random(3);
  const VectorXd u = Drawn(kMany, [&](std::uint64_t n) { return random.Uniform(n); });
  for (const Eigen::Index lag : {1, 2, 3, 64, 1000})
    ExpectIndependent(u.head(kMany - lag), u.tail(kMany - lag), "numbers of a stream");
}

TEST(RandomStream, HasIndependentParts) {
  const RandomStream random(3);
  const auto part = [&](std::uint64_t number) {
    return Drawn(kMany, [part = random.Part(number)](std::uint64_t n) { return part.Uniform(n); });
  };
  const VectorXd whole = Drawn(kMany, [&](std::uint64_t n) { return random.Uniform(n); });
  const VectorXd first = part(0);
  ExpectIndependent(whole, first, "a stream and its part");
  for (const std::uint64_t other : {1, 2, 100, 1000})
    ExpectIndependent(first, part(other), "parts");
  ExpectIndependent(
      part(1),
      Drawn(kMany, [part = random.Part(0).Part(1)](std::uint64_t n) { return part.Uniform(n); }),
      "a part and a part of another");
  ExpectIndependent(Drawn(kMany, [&](std::uint64_t p) { return random.Part(p).Uniform(0); }),
                    Drawn(kMany, [&](std::uint64_t p) { return random.Part(p + 1).Uniform(0); }),
                    "neighbouring parts");
}

TEST(RandomStream, HasIndependentSeeds) {
  const auto of_seed = [](std::uint64_t seed) {
    return Drawn(kMany,
                 [random = RandomStream(seed)](std::uint64_t n) { return random.Uniform(n); });
  };
  const VectorXd zero = of_seed(0);
  for (const std::uint64_t seed : {1ull, 2ull, 1ull << 32, 1ull << 63})
    ExpectIndependent(zero, of_seed(seed), "seeds");
  ExpectIndependent(Drawn(kMany, [](std::uint64_t s) { return RandomStream(s).Uniform(0); }),
                    Drawn(kMany, [](std::uint64_t s) { return RandomStream(s + 1).Uniform(0); }),
                    "neighbouring seeds");
  ExpectIndependent(Drawn(kMany, [](std::uint64_t s) { return RandomStream(s).Uniform(0); }),
                    Drawn(kMany, [](std::uint64_t s) { return RandomStream(s).Uniform(1); }),
                    "first and second number over seeds");
}

// Recorded seeds keep their meaning: these numbers are those of the first version.
static_assert(RandomStream(0).Uniform(0) == 0.6524484863740323);
static_assert(RandomStream(0).Uniform(1) == 0.70121210952152535);
static_assert(RandomStream(42).Uniform(0) == 0.34329192209867349);
static_assert(RandomStream(42).Uniform(1'000'000'007) == 0.79905298116481238);
static_assert(RandomStream(42).Part(0).Uniform(0) == 0.92986565897718965);
static_assert(RandomStream(42).Part(7).Part(3).Uniform(5) == 0.28118128784975555);
static_assert(RandomStream(~0ull).Uniform(~0ull) == 0.26684718649403666);

TEST(RandomStream, KeepsItsNormalNumbers) {
  EXPECT_DOUBLE_EQ(RandomStream(42).Normal(0), 1.4061449625634999);
  EXPECT_DOUBLE_EQ(RandomStream(42).Normal(1), 1.0947531324548505);
  EXPECT_DOUBLE_EQ(RandomStream(42).Part(7).Normal(1000), -0.25041628586276837);
}

TEST(TickAt, FindsTheTickOfATimeRoundedToNanoseconds) {
  for (const double h : {0.001, 1.0 / 3000, 1e-6})
    for (const std::uint64_t k : {0ull, 1ull, 2ull, 1000ull, 1'000'003ull})
      EXPECT_EQ(TickAt(1e-9 * std::floor(1e9 * (static_cast<double>(k) * h)), h), k);
}

}  // namespace
}  // namespace pliant
