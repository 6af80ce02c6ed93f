#include "pliant/analysis/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "pliant/analysis/distributions.h"
#include "pliant/analysis/sample.h"
#include "pliant/analysis/summary.h"
#include "pliant/systems/error.h"
#include "pliant/systems/random.h"

namespace pliant {

namespace {

void RequireOptions(const BootstrapOptions& o) {
  Require(o.confidence > 0 && o.confidence < 1, "confidence must lie between 0 and 1",
          o.confidence);
  const double least = std::ceil(2 / (1 - o.confidence));
  Require(o.resamples >= least,
          "resamples must be at least " + Text(least) + " for a confidence of " +
              Text(o.confidence) + ", so that one lies in each tail",
          o.resamples);
}

double Evaluate(const SampleStatistic& statistic, const std::vector<double>& values,
                const std::string& sample) {
  const double found = statistic(values);
  Require(std::abs(found) <= internal::kLargestOfSample,
          "the statistic of " + sample + " must lie within ±1e75", found);
  return found;
}

/// θ* of so many resamples. The values of a resample are a function of the seed and its number.
std::vector<double> Resample(const std::vector<double>& sample, const SampleStatistic& statistic,
                             int resamples, const RandomStream& random) {
  const std::size_t n = sample.size();
  std::vector<double> drawn(n), found(static_cast<std::size_t>(resamples));
  std::uint64_t draw = 0;
  for (double& theta : found) {
    for (double& value : drawn) {
      const double place = random.Uniform(draw++) * static_cast<double>(n);
      value = sample[std::min(static_cast<std::size_t>(place), n - 1)];
    }
    theta = Evaluate(statistic, drawn, "a resample");
  }
  return found;
}

/// uᵢ, how much each value moves the statistic.
std::vector<double> Influence(const std::vector<double>& sample, const SampleStatistic& statistic) {
  std::vector<double> without;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    std::vector<double> others = sample;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    without.push_back(Evaluate(statistic, others, "the sample without its value " + Text(i + 1)));
  }
  const auto n = static_cast<double>(sample.size());
  const double mean = std::accumulate(without.begin(), without.end(), 0.0) / n;
  for (double& u : without) u = (n - 1) / n * (mean - u);
  return without;
}

double Acceleration(const std::vector<double>& influence) {
  double squares = 0, cubes = 0;
  for (const double u : influence) {
    squares += u * u;
    cubes += u * u * u;
  }
  return squares > 0 ? cubes / (6 * squares * std::sqrt(squares)) : 0;
}

/// z₀.
double Bias(const std::vector<double>& resampled, double estimate) {
  const auto below = static_cast<double>(
      std::ranges::count_if(resampled, [estimate](double theta) { return theta < estimate; }));
  const auto equal = static_cast<double>(std::ranges::count(resampled, estimate));
  const double share = (below + equal / 2) / static_cast<double>(resampled.size());
  Require(
      share > 0 && share < 1,
      "BCa needs resamples on both sides of the estimate, and all lie on one: take kPercentile, "
      "or a statistic with less bias",
      estimate);
  return internal::NormalQuantile(share);
}

/// The share of the resamples below a limit of the BCa interval.
double Share(double bias, double acceleration, double z) {
  const double w = bias + z;
  const double stretch = 1 - acceleration * w;
  if (stretch <= 0) return w > 0 ? 1 : 0;  // as far as it goes
  return internal::NormalBelow(bias + w / stretch);
}

Bootstrap Conclude(double estimate, const std::vector<double>& resampled,
                   const std::vector<double>& influence, const BootstrapOptions& o) {
  const double alpha = (1 - o.confidence) / 2;
  Interval shares{.lower = alpha, .upper = 1 - alpha};
  if (o.method == BootstrapMethod::kBca) {
    const double bias = Bias(resampled, estimate);
    const double acceleration = Acceleration(influence);
    const double z = internal::NormalQuantile(1 - alpha);
    shares = {.lower = Share(bias, acceleration, -z), .upper = Share(bias, acceleration, z)};
  }
  return {.estimate = estimate,
          .standard_error = Summarize(resampled).standard_deviation,
          .interval = {.lower = Quantile(resampled, shares.lower),
                       .upper = Quantile(resampled, shares.upper)}};
}

}  // namespace

Bootstrap BootstrapOf(const std::vector<double>& sample, const SampleStatistic& statistic,
                      const BootstrapOptions& options) {
  RequireOptions(options);
  internal::RequireSample(sample, "the sample", 2);
  const double estimate = Evaluate(statistic, sample, "the sample");
  const bool bca = options.method == BootstrapMethod::kBca;
  return Conclude(estimate,
                  Resample(sample, statistic, options.resamples, RandomStream(options.seed)),
                  bca ? Influence(sample, statistic) : std::vector<double>{}, options);
}

Bootstrap BootstrapOfDifference(const std::vector<double>& first, const std::vector<double>& second,
                                const SampleStatistic& statistic, const BootstrapOptions& options) {
  RequireOptions(options);
  internal::RequireSample(first, "the first sample", 2);
  internal::RequireSample(second, "the second sample", 2);
  const double estimate = Evaluate(statistic, first, "the first sample") -
                          Evaluate(statistic, second, "the second sample");
  const RandomStream random(options.seed);
  std::vector<double> resampled = Resample(first, statistic, options.resamples, random.Part(0));
  const std::vector<double> subtracted =
      Resample(second, statistic, options.resamples, random.Part(1));
  std::ranges::transform(resampled, subtracted, resampled.begin(), std::minus{});
  std::vector<double> influence;
  if (options.method == BootstrapMethod::kBca) {
    influence = Influence(first, statistic);
    for (const double u : Influence(second, statistic)) influence.push_back(-u);
  }
  return Conclude(estimate, resampled, influence, options);
}

}  // namespace pliant
