#include "pliant/analysis/distributions.h"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace pliant::internal {

namespace {

// double carries every digit that a test's p needs; long double only compiles longer.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Student = boost::math::students_t_distribution<double, Policy>;

}  // namespace

double NormalAbove(double z) { return std::erfc(z / std::numbers::sqrt2) / 2; }

double NormalBelow(double z) { return NormalAbove(-z); }

double NormalQuantile(double p) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (p == 0) return -kInfinity;
  if (p == 1) return kInfinity;
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2 * p, Policy());
}

double StudentAbove(double t, double degrees_of_freedom) {
  return cdf(complement(Student(degrees_of_freedom), t));
}

double StudentQuantile(double p, double degrees_of_freedom) {
  return quantile(Student(degrees_of_freedom), p);
}

}  // namespace pliant::internal
