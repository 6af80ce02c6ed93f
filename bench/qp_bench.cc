// What a solve costs and how good it is, tick by tick. Names and counters are those of
// bench/figures.tsv.
//
// A tick counts as the fastest of several runs of its sequence: what interrupts a run is left out,
// what the problem makes slow is not. A sequence is written outside of the clock, as a controller
// assembles in place.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <vector>

#include "pliant/controllers/qp_certificate.h"
#include "pliant/controllers/qp_solver.h"
#include "pliant/tests/controllers/qp_reference.h"
#include "pliant/tests/controllers/qp_sequences.h"

namespace pliant {
namespace {

enum class From { Cold, Warm };

struct Ticks {
  std::vector<double> ns;
  std::vector<QpStatus> status;
  double error = 0;  ///< of the worst answer: relative in x, infinite if it is proven by nothing
};

double ErrorOf(const QpProblem& qp, const QpLimits& active, const QpSolution& solution) {
  constexpr double kUnproven = std::numeric_limits<double>::infinity();
  if (solution.status == QpStatus::Solved)
    return Kkt(qp, solution).max() < 1e-10 ? RelativeError(qp, active, solution) : kUnproven;
  if (solution.status == QpStatus::Infeasible)
    return Farkas(qp, solution).Excludes(1e5, qp.variables()) ? 0 : kUnproven;
  return kUnproven;
}

template <class Sequence>
Ticks Measure(const Sequence& sequence, int ticks, int runs, From from) {
  using Clock = std::chrono::steady_clock;
  const auto workspace = std::make_unique<QpWorkspace>();
  QpProblem qp = sequence.MakeProblem();
  QpSolution solution;
  Ticks result{.ns = std::vector<double>(ticks, std::numeric_limits<double>::infinity()),
               .status = std::vector<QpStatus>(ticks)};
  for (int run = 0; run < runs; ++run) {
    QpLimits active;
    for (int tick = 0; tick < ticks; ++tick) {
      sequence.Write(tick, qp);
      if (from == From::Cold) active.clear();
      const Clock::time_point start = Clock::now();
      Solve(qp, *workspace, active, solution);
      const std::chrono::duration<double, std::nano> took = Clock::now() - start;
      result.ns[tick] = std::min(result.ns[tick], took.count());
      if (run > 0) continue;
      result.status[tick] = solution.status;
      result.error = std::max(result.error, ErrorOf(qp, active, solution));
    }
  }
  return result;
}

double Percentile(std::vector<double> values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[at];
}

// Counters: median_ns, p999_ns, max_ns over the ticks, error, and the part that is infeasible.
void Report(benchmark::State& state, const Ticks& ticks, const std::vector<double>& ns) {
  state.counters["median_ns"] = Percentile(ns, 0.5);
  state.counters["p999_ns"] = Percentile(ns, 0.999);
  state.counters["max_ns"] = *std::ranges::max_element(ns);
  state.counters["error"] = ticks.error;
  state.counters["infeasible"] =
      static_cast<double>(std::ranges::count(ticks.status, QpStatus::Infeasible)) /
      static_cast<double>(ticks.status.size());
}

constexpr int kRuns = 15;  // the rarest slow ticks need many to meet a quiet machine

void Arm(benchmark::State& state, ArmQpSequence::Options options, From from) {
  const ArmQpSequence sequence{options};
  for (auto _ : state) {
    const Ticks ticks = Measure(sequence, 10'000, kRuns, from);
    Report(state, ticks, ticks.ns);
  }
}

// Only the ticks without a solution.
void Infeasible(benchmark::State& state, From from) {
  const ArmQpSequence sequence{kOverloadedArm};
  for (auto _ : state) {
    const Ticks ticks = Measure(sequence, 10'000, kRuns, from);
    std::vector<double> ns;
    for (std::size_t i = 0; i < ticks.ns.size(); ++i)
      if (ticks.status[i] == QpStatus::Infeasible) ns.push_back(ticks.ns[i]);
    Report(state, ticks, ns);
  }
}

void Body(benchmark::State& state, BodyQpSequence::Options options, From from) {
  const BodyQpSequence sequence{options};
  for (auto _ : state) {
    const Ticks ticks = Measure(sequence, 2000, 5, from);
    Report(state, ticks, ticks.ns);
  }
}

// 7 variables; rows besides the bounds: A 7, B and D 17, C 27.
BENCHMARK_CAPTURE(Arm, A, kFreeArm, From::Cold)->Name("TorqueQp/A/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Arm, A, kFreeArm, From::Warm)->Name("TorqueQp/A/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Arm, B, kLimitedArm, From::Cold)->Name("TorqueQp/B/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Arm, B, kLimitedArm, From::Warm)->Name("TorqueQp/B/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Arm, C, kCrowdedArm, From::Cold)->Name("TorqueQp/C/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Arm, C, kCrowdedArm, From::Warm)->Name("TorqueQp/C/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Arm, D, kOverloadedArm, From::Cold)->Name("TorqueQp/D/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Arm, D, kOverloadedArm, From::Warm)->Name("TorqueQp/D/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Infeasible, Cold, From::Cold)->Name("TorqueQp/Infeasible/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Infeasible, Warm, From::Warm)->Name("TorqueQp/Infeasible/Warm")->Iterations(1);

constexpr BodyQpSequence::Options k20{.variables = 20, .rows = 30, .equalities = 12};
constexpr BodyQpSequence::Options k30{.variables = 30, .rows = 50, .equalities = 18};
constexpr BodyQpSequence::Options k50{.variables = 50, .rows = 80, .equalities = 24};
BENCHMARK_CAPTURE(Body, F20, k20, From::Cold)->Name("BodyQp/20/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Body, F20, k20, From::Warm)->Name("BodyQp/20/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Body, F30, k30, From::Cold)->Name("BodyQp/30/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Body, F30, k30, From::Warm)->Name("BodyQp/30/Warm")->Iterations(1);
BENCHMARK_CAPTURE(Body, F50, k50, From::Cold)->Name("BodyQp/50/Cold")->Iterations(1);
BENCHMARK_CAPTURE(Body, F50, k50, From::Warm)->Name("BodyQp/50/Warm")->Iterations(1);

}  // namespace
}  // namespace pliant
