// What a fit of friction costs, by the number of samples.

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "pliant/estimators/friction_fit.h"

namespace pliant {
namespace {

FrictionSamples Samples(Eigen::Index count) {
  const FrictionParameters p{
      .coulomb = 3, .viscous = 2.416, .stiction = 4.5, .stribeck_velocity = 0.1};
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  FrictionSamples samples{.velocity = Eigen::VectorXd(count), .torque = Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(count);
    const double v = std::copysign(0.02 * std::pow(60, std::fmod(7 * x, 1)), std::sin(44 * x));
    samples.velocity(k) = v;
    samples.torque(k) = SteadyFriction(p, v) + 0.15 * normal(random) + (k % 20 == 0 ? 3 : 0);
  }
  return samples;
}

/// folds: those of the cross-validation, which sees 20 000 samples at most.
void BM_FitFriction(benchmark::State& state) {
  const FrictionSamples samples = Samples(state.range(0));
  const FrictionFitOptions options{.model = FrictionModel::Stribeck,
                                   .offset = true,
                                   .least_velocity = 0.01,
                                   .folds = static_cast<int>(state.range(1))};
  for (auto _ : state) benchmark::DoNotOptimize(FitFriction(samples, options).scale);
}
BENCHMARK(BM_FitFriction)
    ->ArgNames({"samples", "folds"})
    ->Args({10'000, 0})
    ->Args({100'000, 0})
    ->Args({1'000'000, 0})
    ->Args({1'000'000, 5})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pliant

BENCHMARK_MAIN();
