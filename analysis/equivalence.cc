#include "pliant/analysis/equivalence.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/distributions.h"
#include "pliant/analysis/sample.h"
#include "pliant/analysis/summary.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

void RequireOptions(const EquivalenceOptions& o) {
  Require(o.margin > 0 && std::isfinite(o.margin), "margin must be > 0 and finite", o.margin);
  Require(o.alpha > 0 && o.alpha < 0.5, "alpha must lie between 0 and 0.5", o.alpha);
}

std::vector<double> Shifted(std::vector<double> values, double by) {
  for (double& value : values) value += by;
  return values;
}

}  // namespace

EquivalenceOfMeans TestEquivalenceOfMeans(const std::vector<double>& first,
                                          const std::vector<double>& second,
                                          const EquivalenceOptions& options) {
  RequireOptions(options);
  internal::RequireSample(first, "the first sample", 2);
  internal::RequireSample(second, "the second sample", 2);
  const Summary x = Summarize(first), y = Summarize(second);
  const auto n1 = static_cast<double>(x.n), n2 = static_cast<double>(y.n);
  const double e1 = x.standard_deviation * x.standard_deviation / n1;
  const double e2 = y.standard_deviation * y.standard_deviation / n2;
  Require(e1 + e2 > 0,
          "equivalence of means: both samples are constant, and Welch's t divides by their spread");
  const double e = std::sqrt(e1 + e2);
  const double share1 = e1 / (e1 + e2), share2 = e2 / (e1 + e2);
  const double freedom = 1 / (share1 * share1 / (n1 - 1) + share2 * share2 / (n2 - 1));
  const double d = x.mean - y.mean;
  const double above = internal::StudentAbove((d + options.margin) / e, freedom);
  const double below = internal::StudentAbove((options.margin - d) / e, freedom);
  const double reach = internal::StudentQuantile(1 - options.alpha, freedom) * e;
  const double p = std::max(above, below);
  return {.difference = d,
          .degrees_of_freedom = freedom,
          .p_above_lower = above,
          .p_below_upper = below,
          .p = p,
          .interval = {.lower = d - reach, .upper = d + reach},
          .equivalent = p < options.alpha};
}

EquivalenceOfRanks TestEquivalenceOfRanks(const std::vector<double>& first,
                                          const std::vector<double>& second,
                                          const EquivalenceOptions& options,
                                          const MannWhitneyOptions& ranks) {
  RequireOptions(options);
  internal::RequireSample(first, "the first sample", 1);
  internal::RequireSample(second, "the second sample", 1);
  std::vector<double> differences;
  for (const double x : first) {
    for (const double y : second) differences.push_back(x - y);
  }
  const double above = MannWhitneyTest(Shifted(first, options.margin), second, ranks).p_greater;
  const double below = MannWhitneyTest(Shifted(first, -options.margin), second, ranks).p_less;
  const double p = std::max(above, below);
  return {.difference = Quantile(std::move(differences), 0.5),
          .p_above_lower = above,
          .p_below_upper = below,
          .p = p,
          .equivalent = p < options.alpha};
}

}  // namespace pliant
