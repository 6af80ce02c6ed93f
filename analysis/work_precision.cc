#include "pliant/analysis/work_precision.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What a run leaves: a column of `look` for each time.
struct Trace {
  Eigen::MatrixXd seen;
  Eigen::VectorXd scale;
  Integrator::Statistics work = {};
  double wall_s = 0;
  std::string failure = {};
};

Trace Run(const WorkPrecisionOptions& o, const IntegratorOptions& integrator) {
  const Observed observed = o.make();
  Simulator sim(observed.diagram, {.integrator = integrator});
  const auto samples = static_cast<Eigen::Index>(std::llround(o.duration_s / o.spacing_s));
  Trace trace{.seen = Eigen::MatrixXd::Zero(observed.scale.size(), samples),
              .scale = observed.scale};
  const auto begin = std::chrono::steady_clock::now();
  try {
    for (Eigen::Index k = 0; k < samples; ++k) {
      sim.AdvanceTo(o.duration_s * static_cast<double>(k + 1) / static_cast<double>(samples));
      trace.seen.col(k) = observed.look(sim);
    }
  } catch (const Error& e) {
    trace.failure = e.what();
  }
  trace.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
                           .wall_s = first.wall_s,
                           .work = first.work,
                           .failure = first.failure};
  if (!first.failure.empty()) return point;
  const Eigen::MatrixXd off = first.seen - reference.seen;
  point.error = (off.array().colwise() / reference.scale.array()).abs().maxCoeff();
  std::vector<double> times{first.wall_s};
  while (static_cast<int>(times.size()) < o.repetitions) times.push_back(Run(o, integrator).wall_s);
  std::ranges::sort(times);
  point.wall_s = times[times.size() / 2];
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
  struct Place {
    double error, work;  // logarithms
  };
  std::vector<Place> places;
  for (const WorkPrecisionPoint& p : points)
    if (p.method == method && p.failure.empty() && p.error > 0)
      places.push_back({std::log(p.error), std::log(work(p))});
  if (places.size() < 2) return kInfinity;
  std::ranges::sort(places, {}, &Place::error);
  const auto above = std::ranges::lower_bound(places, std::log(error), {}, &Place::error);
  const auto b = std::clamp(above, places.begin() + 1, places.end() - 1), a = b - 1;
  if (b->error == a->error) return std::exp(std::max(a->work, b->work));
  const double slope = (b->work - a->work) / (b->error - a->error);
  return std::exp(a->work + slope * (std::log(error) - a->error));
}

}  // namespace pliant
