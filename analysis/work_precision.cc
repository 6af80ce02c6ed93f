#include "pliant/analysis/work_precision.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

namespace pliant {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a run leaves: a column of `look` for each time.
struct Trace {
  Eigen::MatrixXd seen;
  Eigen::VectorXd scale;
  Integrator::Statistics work = {};
  double cpu_s = 0;
  std::string failure = {};
};

Trace Run(const WorkPrecisionOptions& o, const IntegratorOptions& integrator) {
  const Observed observed = o.make();
  Simulator sim(observed.diagram, {.integrator = integrator});
  const auto samples = static_cast<Eigen::Index>(std::llround(o.duration_s / o.spacing_s));
  Trace trace{.seen = Eigen::MatrixXd::Zero(observed.scale.size(), samples),
              .scale = observed.scale};
  const std::clock_t begin = std::clock();
  try {
    for (Eigen::Index k = 0; k < samples; ++k) {
      sim.AdvanceTo(o.duration_s * static_cast<double>(k + 1) / static_cast<double>(samples));
      trace.seen.col(k) = observed.look(sim);
    }
  } catch (const Error& e) {
    trace.failure = e.what();
  }
  trace.cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  trace.work = sim.statistics();
  return trace;
}

WorkPrecisionPoint Measure(const WorkPrecisionOptions& o, Method method, double tolerance,
                           const Trace& reference) {
  const IntegratorOptions integrator{.method = method,
                                     .relative_tolerance = tolerance,
                                     .absolute_tolerance = o.absolute_over_relative * tolerance};
  const Trace first = Run(o, integrator);
  WorkPrecisionPoint point{.method = method,
                           .relative_tolerance = tolerance,
                           .error = kInfinity,
                           .cpu_s = first.cpu_s,
                           .work = first.work,
                           .failure = first.failure};
  if (!first.failure.empty()) return point;
  const Eigen::MatrixXd off = first.seen - reference.seen;
  point.error = (off.array().colwise() / reference.scale.array()).abs().maxCoeff();
  std::vector<double> times{first.cpu_s};
  while (static_cast<int>(times.size()) < o.repetitions) times.push_back(Run(o, integrator).cpu_s);
  std::ranges::sort(times);
  point.cpu_s = times[times.size() / 2];
  return point;
}

}  // namespace

std::vector<WorkPrecisionPoint> WorkPrecision(const WorkPrecisionOptions& o) {
  Require(o.spacing_s > 0, "spacing_s must be > 0", o.spacing_s);
  Require(o.duration_s >= o.spacing_s, "duration_s must be at least spacing_s", o.duration_s);
  Require(o.repetitions >= 1, "repetitions must be >= 1", o.repetitions);
  const Trace reference = Run(o, o.reference);
  if (!reference.failure.empty()) throw Error("the reference run: " + reference.failure);
  std::vector<WorkPrecisionPoint> points;
  for (const Method method : o.methods)
    for (const double tolerance : o.relative_tolerances)
      points.push_back(Measure(o, method, tolerance, reference));
  return points;
}

double WorkFor(double error, Method method, const std::vector<WorkPrecisionPoint>& points,
               const std::function<double(const WorkPrecisionPoint&)>& work) {
  double least = kInfinity;
  for (const WorkPrecisionPoint& p : points)
    if (p.method == method && p.error <= error) least = std::min(least, work(p));
  return least;
}

}  // namespace pliant
