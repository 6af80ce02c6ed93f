#include "pliant/analysis/summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/analysis/sample.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

double QuantileOfSorted(const std::vector<double>& x, double p) {
  const double place = p * static_cast<double>(x.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, x.size() - 1);
  return std::lerp(x[below], x[above], place - std::floor(place));
}

}  // namespace

Summary Summarize(const std::vector<double>& values) {
  internal::RequireSample(values, "sample", 1);
  std::vector<double> x = values;
  std::ranges::sort(x);
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double squares = std::accumulate(x.begin(), x.end(), 0.0, [mean](double sum, double xi) {
    return sum + (xi - mean) * (xi - mean);
  });
  return {.n = x.size(),
          .mean = mean,
          .standard_deviation = x.size() == 1 ? 0 : std::sqrt(squares / (n - 1)),
          .lower_quartile = QuantileOfSorted(x, 0.25),
          .median = QuantileOfSorted(x, 0.5),
          .upper_quartile = QuantileOfSorted(x, 0.75)};
}

double Quantile(std::vector<double> values, double p) {
  internal::RequireSample(values, "sample", 1);
  Require(p >= 0 && p <= 1, "a quantile's share p must lie in 0 … 1", p);
  std::ranges::sort(values);
  return QuantileOfSorted(values, p);
}

}  // namespace pliant
