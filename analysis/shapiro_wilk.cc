#include "pliant/analysis/shapiro_wilk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "pliant/analysis/distributions.h"
#include "pliant/analysis/sample.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

/// c₀ + c₁ x + c₂ x² + …
template <std::size_t N>
double Polynomial(const std::array<double, N>& c, double x) {
  return std::accumulate(c.rbegin(), c.rend(), 0.0,
                         [x](double sum, double ci) { return sum * x + ci; });
}

/// a of the upper half, the largest first; the lower half has the opposite sign, the middle none.
/// Normal scores by Blom, and polynomials in 1/√n for the outermost one or two.
std::vector<double> Weights(std::size_t n) {
  const std::size_t half = n / 2;
  if (n == 3) return {1 / std::numbers::sqrt2};
  const auto count = static_cast<double>(n);
  std::vector<double> m(half);
  for (std::size_t i = 0; i < half; ++i) {
    m[i] = -internal::NormalQuantile((static_cast<double>(i) + 0.625) / (count + 0.25));
  }
  const double square = 2 * std::inner_product(m.begin(), m.end(), m.begin(), 0.0);
  const double u = 1 / std::sqrt(count);
  std::vector<double> outer = {
      m[0] / std::sqrt(square) +
      Polynomial<6>({0, 0.221157, -0.147981, -2.071190, 4.434685, -2.706056}, u)};
  if (n > 5) {
    outer.push_back(m[1] / std::sqrt(square) +
                    Polynomial<6>({0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633}, u));
  }
  // The inner ones keep the direction of the scores; all together have length 1.
  double scores_left = square, length_left = 1;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    scores_left -= 2 * m[i] * m[i];
    length_left -= 2 * outer[i] * outer[i];
  }
  std::vector<double> a = m;
  for (double& ai : a) ai /= std::sqrt(scores_left / length_left);
  std::ranges::copy(outer, a.begin());
  return a;
}

/// P(W ≤ w), with 1 − w given: near w = 1 it has more digits.
double Probability(double one_minus_w, std::size_t n) {
  if (n == 3) {  // exact: W ≥ 3/4
    const double angle = std::asin(std::sqrt(1 - one_minus_w)) - std::numbers::pi / 3;
    return std::clamp(6 / std::numbers::pi * angle, 0.0, 1.0);
  }
  const auto count = static_cast<double>(n);
  const double y = std::log(one_minus_w);
  if (n <= 11) {
    // Positive for every W that n values can have: W ≥ n a₁² / (n − 1).
    const double gap = Polynomial<2>({-2.273, 0.459}, count) - y;
    const double mean = Polynomial<4>({0.5440, -0.39978, 0.025054, -0.0006714}, count);
    const double deviation =
        std::exp(Polynomial<4>({1.3822, -0.77857, 0.062767, -0.0020322}, count));
    return internal::NormalAbove((-std::log(gap) - mean) / deviation);
  }
  const double x = std::log(count);
  const double mean = Polynomial<4>({-1.5861, -0.31082, -0.083751, 0.0038915}, x);
  const double deviation = std::exp(Polynomial<3>({-0.4803, -0.082676, 0.0030302}, x));
  return internal::NormalAbove((y - mean) / deviation);
}

}  // namespace

ShapiroWilk ShapiroWilkTest(const std::vector<double>& values) {
  internal::RequireSample(values, "Shapiro–Wilk: the sample", 3);
  const std::size_t n = values.size();
  Require(n <= 5000, "Shapiro–Wilk: the sample must have at most 5000 values", n);
  std::vector<double> x = values;
  std::ranges::sort(x);
  const double least = x.front(), range = x.back() - least;
  Require(range > 0, "Shapiro–Wilk: the values must not all be equal", least);
  for (double& xi : x) xi = (xi - least) / range;

  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(n);
  const double squares = std::accumulate(x.begin(), x.end(), 0.0, [mean](double sum, double xi) {
    return sum + (xi - mean) * (xi - mean);
  });
  const std::vector<double> a = Weights(n);
  double product = 0, length = 0;  // Σ aᵢ x₍ᵢ₎, Σ aᵢ²
  for (std::size_t i = 0; i < a.size(); ++i) {
    product += a[i] * (x[n - 1 - i] - x[i]);
    length += 2 * a[i] * a[i];
  }
  const double root = std::sqrt(length * squares);
  const double one_minus_w =
      std::max(0.0, (root - product) * (root + product) / (length * squares));
  return {.w = 1 - one_minus_w, .p = Probability(one_minus_w, n)};
}

}  // namespace pliant
