#include "pliant/analysis/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace pliant::internal {
namespace {

// A few last digits, of erfc and of its inverse.
constexpr double kRoundOff = 1e-14;

TEST(Distributions, NormalQuantileInvertsTheNormalDistribution) {
  for (const double z : {-8.0, -3.0, -1.0, -0.1, 0.0, 0.5, 2.0, 5.0}) {
    // Near p = 1 the last digit of p is worth 2⁻⁵³ / φ(z).
    const double slope = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    EXPECT_NEAR(NormalQuantile(NormalBelow(z)), z,
                kRoundOff * (1 + std::abs(z)) + (z > 0 ? 0x1p-53 / slope : 0))
        << z;
    EXPECT_DOUBLE_EQ(NormalAbove(z), NormalBelow(-z));
  }
  EXPECT_EQ(NormalQuantile(0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(NormalQuantile(1), std::numeric_limits<double>::infinity());
}

TEST(Distributions, StudentIsCauchyForOneDegreeAndAlgebraicForTwo) {
  for (const double t : {-4.0, -0.3, 0.0, 0.7, 3.0, 40.0}) {
    EXPECT_NEAR(StudentAbove(t, 1), 0.5 - std::atan(t) / std::numbers::pi, kRoundOff) << t;
    EXPECT_NEAR(StudentAbove(t, 2), 0.5 - t / (2 * std::sqrt(2 + t * t)), kRoundOff) << t;
  }
}

// SciPy 1.10.1, scipy.stats.t.sf(2.5, 7.3)
TEST(Distributions, StudentTakesDegreesOfFreedomThatAreNotWhole) {
  EXPECT_NEAR(StudentAbove(2.5, 7.3), 0.019825117332800207, kRoundOff);
}

TEST(Distributions, StudentQuantileInvertsStudentsDistribution) {
  for (const double freedom : {1.0, 2.0, 4.5, 19.0, 300.0}) {
    for (const double p : {0.01, 0.3, 0.9, 0.975}) {
      EXPECT_NEAR(1 - StudentAbove(StudentQuantile(p, freedom), freedom), p, 1e-12)
          << p << " of " << freedom;
    }
  }
}

}  // namespace
}  // namespace pliant::internal
