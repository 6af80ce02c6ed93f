#include "pliant/analysis/integrator_study.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <numbers>

#include "pliant/analysis/with_unit.h"
#include "pliant/analysis/work_precision.h"
#include "pliant/diagrams/stations.h"
#include "pliant/diagrams/sway_loop.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

constexpr double kAmplitude = 0.1;  // of the sway [rad]
constexpr double kUsual = 1e-6;     // the relative tolerance of the runs that are balanced
constexpr double kEnergyTolerance = 1e-5;

const JointPosition kHome{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};

SimulatedArm::Options Gen3(const IntegratorStudyOptions& o, bool ideal) {
  SimulatedArm::Options arm =
      SimulatedGen3(RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
                    {.position = kHome, .ideal = ideal, .seed = o.seed, .engine = o.engine});
  if (!ideal) arm.firmware.mode = ControlMode::Current;
  return arm;
}

/// Of any loop with an arm that has a position.
template <class Loop>
Observed LookAtPosition(std::unique_ptr<Loop> loop) {
  const auto* arm = loop->arm;
  return {.diagram = std::move(loop->diagram),
          .look = [arm](Simulator& sim) { return Eigen::VectorXd(sim.Get(arm->position)); },
          .scale = Eigen::VectorXd::Constant(kHome.size(), kAmplitude)};
}

Observed MakeSmooth(const IntegratorStudyOptions& o) {
  const SimulatedArm::Options arm = Gen3(o, true);
  return LookAtPosition(std::make_unique<SmoothSwayLoop>(
      SimbodyPlant::Options{.model = arm.model,
                            .position = arm.position,
                            .rotor_inertia = arm.actuators.reflected_inertia(),
                            .engine = o.engine}));
}

Observed MakeIdeal(const IntegratorStudyOptions& o) {
  return LookAtPosition(std::make_unique<SwayLoop>(SwayLoop::Options{.arm = Gen3(o, true)}));
}

/// Rounding turns the smallest difference of positions into a jump, which says nothing of the
/// integrator, so it is off.
Observed MakeFull(const IntegratorStudyOptions& o) {
  SimulatedArm::Options arm = Gen3(o, false);
  arm.sensors.position_quantum = {};
  return LookAtPosition(std::make_unique<SwayLoop>(SwayLoop::Options{.arm = arm}));
}

/// One of the three systems and what every method did on it.
struct Problem {
  std::string name, title;
  std::function<Observed()> make;
  std::vector<WorkPrecisionPoint> points = {};
};

double Calls(const WorkPrecisionPoint& p) { return static_cast<double>(p.work.derivative_calls); }

const WorkPrecisionPoint* Find(const Problem& problem, Method method, double tolerance) {
  const auto found = std::ranges::find_if(problem.points, [&](const WorkPrecisionPoint& p) {
    return p.method == method && p.relative_tolerance == tolerance;
  });
  return found == problem.points.end() ? nullptr : &*found;
}

void Compare(Problem& problem, const IntegratorStudyOptions& o, const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const double total = o.compared_s * static_cast<double>(o.methods.size());
  for (const Method method : o.methods) {
    const std::vector<WorkPrecisionPoint> points =
        WorkPrecision({.make = problem.make,
                       .duration_s = o.compared_s,
                       .methods = {method},
                       .relative_tolerances = o.relative_tolerances,
                       .repetitions = o.repetitions});
    problem.points.insert(problem.points.end(), points.begin(), points.end());
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    if (progress)
      progress(problem.title,
               total * static_cast<double>(problem.points.size()) /
                   static_cast<double>(o.methods.size() * o.relative_tolerances.size()),
               total, wall.count());
  }
}

/// A long run of the full station.
struct Balance {
  Method method;
  double simulated_s = 0;
  double work = 0, heat = 0;  // [J]
  double residual = 0;        // largest |E(t) − E(0) − work + heat| [J]
  double wall_s = 0, cpu_s = 0;
  Integrator::Statistics integrator = {};
  std::string failure = {};

  double relative() const { return residual / heat; }
};

Balance RunBalanced(Method method, const IntegratorStudyOptions& o, const Progress& progress) {
  const SwayLoop loop({.arm = Gen3(o, false), .account = true});
  Simulator sim(loop.diagram, {.integrator = {.method = method,
                                              .relative_tolerance = kUsual,
                                              .absolute_tolerance = 1e-2 * kUsual}});
  const double start = sim.Get(loop.arm->energy);
  Balance run{.method = method};
  const std::clock_t cpu_begin = std::clock();
  const auto begin = std::chrono::steady_clock::now();
  const int parts = static_cast<int>(std::ceil(10 * o.balanced_s));
  try {
    for (int k = 1; k <= parts; ++k) {
      sim.AdvanceTo(o.balanced_s * k / parts);
      run.simulated_s = sim.time();
      run.work = sim.Get(loop.work->y);
      run.heat = sim.Get(loop.heat->y);
      const double off = sim.Get(loop.arm->energy) - start - run.work + run.heat;
      run.residual = std::max(run.residual, std::abs(off));
      run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      if (progress)
        progress(std::string("energy, ") + Name(method), sim.time(), o.balanced_s, run.wall_s);
    }
  } catch (const Error& e) {
    run.failure = e.what();
  }
  run.cpu_s = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
  run.integrator = sim.statistics();
  return run;
}

// ---- what is drawn and listed ----------------------------------------------------------------

Figure WorkFigure(const Problem& problem, const IntegratorStudyOptions& o) {
  Figure figure{.name = "work-" + problem.name,
                .caption = problem.title +
                           ": largest error of a joint's position over the amplitude of the sway, "
                           "against what it costs per simulated millisecond. Further left and "
                           "further down is better.",
                .columns = 1};
  const double milliseconds = 1000 * o.compared_s;
  const auto add = [&](const std::string& label, const auto& cost) {
    Panel panel{.x = {.label = label, .logarithmic = true},
                .left = {.label = "relative error", .logarithmic = true}};
    for (const Method method : o.methods) {
      Curve curve{.label = Name(method), .x = {}, .y = {}};
      for (const WorkPrecisionPoint& p : problem.points)
        if (p.method == method) {
          curve.x.push_back(cost(p) / milliseconds);
          curve.y.push_back(p.error);
        }
      panel.curves.push_back(std::move(curve));
    }
    figure.panels.push_back(std::move(panel));
  };
  add("evaluations of ẋ per ms", Calls);
  add("processor time per simulated ms [µs]",
      [](const WorkPrecisionPoint& p) { return 1e6 * p.cpu_s; });
  return figure;
}

std::string Digits(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

Table WorkTable(const std::vector<Problem>& problems, double tolerance,
                const IntegratorStudyOptions& o) {
  Table table{.title = "At a relative tolerance of " + Text(tolerance),
              .columns = {"method"},
              .rows = {},
              .caption =
                  "Evaluations of ẋ and processor time per simulated millisecond, and the largest "
                  "error of a position over the amplitude of the sway."};
  for (const Problem& problem : problems)
    for (const char* what : {"evaluations", "µs", "error"})
      table.columns.push_back(problem.title + ": " + what);
  for (const Method method : o.methods) {
    std::vector<std::string> row{Name(method)};
    for (const Problem& problem : problems) {
      const WorkPrecisionPoint* p = Find(problem, method, tolerance);
      const double milliseconds = 1000 * o.compared_s;
      row.push_back(p ? Digits(Calls(*p) / milliseconds, "%.3g") : "");
      row.push_back(p ? Digits(1e6 * p->cpu_s / milliseconds, "%.3g") : "");
      row.push_back(!p ? "" : p->failure.empty() ? Digits(p->error, "%.1e") : "failed");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table EqualErrorTable(const std::vector<Problem>& problems, double error,
                      const IntegratorStudyOptions& o) {
  Table table{
      .title = "For an error of " + Text(error),
      .columns = {"method"},
      .rows = {},
      .caption =
          "Evaluations of ẋ per simulated millisecond, of the cheapest run with no larger error."};
  for (const Problem& problem : problems) table.columns.push_back(problem.title);
  for (const Method method : o.methods) {
    std::vector<std::string> row{Name(method)};
    for (const Problem& problem : problems)
      row.push_back(
          Digits(WorkFor(error, method, problem.points, Calls) / (1000 * o.compared_s), "%.3g"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table BalanceTable(const std::vector<Balance>& runs) {
  Table table{
      .title = "Full station, long runs at a relative tolerance of " + Text(kUsual),
      .columns = {"method", "reached", "× real time", "evaluations per tick", "rejected steps",
                  "work of the motors", "dissipated", "imbalance", "relative"},
      .rows = {},
      .caption =
          "Real time against the time of the processor. Imbalance: the largest |E(t) − E(0) − work "
          "+ dissipated|, relative to "
          "what was dissipated in all."};
  for (const Balance& run : runs)
    table.rows.push_back(
        {Name(run.method), Text(run.simulated_s) + " s",
         Digits(run.simulated_s / run.cpu_s, "%.3g"),
         Digits(static_cast<double>(run.integrator.derivative_calls) / (1000 * run.simulated_s),
                "%.3g"),
         Digits(100 * static_cast<double>(run.integrator.rejected_steps) /
                    static_cast<double>(run.integrator.steps + run.integrator.rejected_steps),
                "%.2g %%"),
         WithUnit(run.work, "J"), WithUnit(run.heat, "J"), WithUnit(run.residual, "J"),
         Digits(run.relative(), "%.1e")});
  return table;
}

// ---- what is claimed -------------------------------------------------------------------------

constexpr char kOurs[] = "pliant";

Claim Completes(const std::vector<Balance>& runs, double duration_s) {
  std::string failures;
  for (const Balance& run : runs)
    if (!run.failure.empty())
      failures +=
          (failures.empty() ? "" : "; ") + std::string(Name(run.method)) + ": " + run.failure;
  return {.id = "completes",
          .source = kOurs,
          .paper = "every method brings the full station through " + Text(duration_s) + " s",
          .measured = failures.empty() ? Text(runs.size()) + " of " + Text(runs.size()) : failures,
          .criterion = "no run ends before its time",
          .basis = "an integrator that cannot take a step says so",
          .holds = failures.empty()};
}

Claim Balances(const Balance& run) {
  const bool done = run.failure.empty();
  return {.id = std::string("energy-") + Name(run.method),
          .source = kOurs,
          .paper = std::string("the energy of the full station balances with ") + Name(run.method),
          .measured = done ? Digits(run.relative(), "%.1e") + " of " + WithUnit(run.heat, "J") +
                                 " dissipated"
                           : run.failure,
          .criterion = "below " + Text(kEnergyTolerance),
          .basis = "ten times the relative tolerance: room for local errors to add up",
          .holds = done && run.relative() < kEnergyTolerance};
}

/// The smallest of what several methods need for an error, and whose it is.
struct Least {
  Method method;
  double calls;
};

Least LeastWork(double error, const Problem& problem, const std::vector<Method>& methods) {
  Least least{methods.front(), std::numeric_limits<double>::infinity()};
  for (const Method method : methods) {
    const double calls = WorkFor(error, method, problem.points, Calls);
    if (calls < least.calls) least = {method, calls};
  }
  return least;
}

std::vector<Method> Those(const IntegratorStudyOptions& o, bool multistep) {
  std::vector<Method> some;
  std::ranges::copy_if(o.methods, std::back_inserter(some), [&](Method m) {
    return multistep == (m == Method::kAdams || m == Method::kBdf);
  });
  return some;
}

/// One family needs less work than the other on a problem.
Claim Cheaper(const Problem& problem, bool multistep, const std::string& id,
              const std::string& basis, const IntegratorStudyOptions& o) {
  const Least ours = LeastWork(kUsual, problem, Those(o, multistep));
  const Least others = LeastWork(kUsual, problem, Those(o, !multistep));
  const double milliseconds = 1000 * o.compared_s;
  const std::string family = multistep ? "multistep" : "Runge–Kutta",
                    other = multistep ? "Runge–Kutta" : "multistep";
  return {
      .id = id,
      .source = kOurs,
      .paper = problem.title + ": a " + family + " method is cheaper than any " + other + " method",
      .measured = std::string(Name(ours.method)) + " " + Digits(ours.calls / milliseconds, "%.3g") +
                  ", " + Name(others.method) + " " + Digits(others.calls / milliseconds, "%.3g") +
                  " evaluations per ms",
      .criterion = "fewer evaluations for an error of " + Text(kUsual),
      .basis = basis,
      .holds = ours.calls < others.calls};
}

Claim BelowNoise(const Problem& full, const IntegratorStudyOptions& o) {
  const double noise = Gen3(o, false).sensors.position_noise.minCoeff();
  const WorkPrecisionPoint* p = Find(full, IntegratorOptions{}.method, kUsual);
  const double error = p ? kAmplitude * p->error : std::numeric_limits<double>::quiet_NaN();
  return {.id = "default",
          .source = kOurs,
          .paper = "what is taken when nothing is said is more precise than the arm's sensors",
          .measured = WithUnit(error, "rad"),
          .criterion = "the largest error of a position below " + WithUnit(noise, "rad"),
          .basis = "the noise of the position sensors",
          .holds = error < noise};
}

}  // namespace

Report IntegratorStudy(const IntegratorStudyOptions& o, const Progress& progress) {
  Require(o.balanced_s > 0, "balanced_s must be > 0", o.balanced_s);
  Require(!Those(o, true).empty() && !Those(o, false).empty(),
          "methods has a multistep and a Runge–Kutta method");
  RequireGnuplot();
  std::vector<Problem> problems{{"smooth", "smooth loop", [&o] { return MakeSmooth(o); }},
                                {"ideal", "ideal station", [&o] { return MakeIdeal(o); }},
                                {"full", "full station", [&o] { return MakeFull(o); }}};
  for (Problem& problem : problems) Compare(problem, o, progress);
  std::vector<Balance> balances;
  for (const Method method : o.methods)
    if (method != Method::kHeunEuler) balances.push_back(RunBalanced(method, o, progress));
  const Problem &smooth = problems[0], &ideal = problems[1], &full = problems[2];

  Report report{
      .title = "Integrators",
      .summary =
          "A Gen3 sways about its home posture: as a smooth system, under a controller that "
          "samples "
          "and holds at 1 kHz, and with elastic gears, elasto-plastic friction and noisy sensors. "
          "Every integrator runs each at several tolerances against a reference; then the full "
          "station runs long with each, and its energy has to balance."};
  report.settings = {
      {"robot",
       Gen3(o, true).model.name() + ", swaying by " + Text(kAmplitude) + " rad at 2 rad/s"},
      {"plant", o.engine == SimbodyPlant::Engine::Simbody ? "Simbody" : "recursive kernel"},
      {"smooth loop", "computed torque on the plant, continuous, no friction"},
      {"ideal station", "the same law sampled and held at 1 kHz, true sensors"},
      {"full station",
       "the same law and a torque loop, held at 1 kHz; elastic gears, elasto-plastic friction, "
       "noisy sensors with seed " +
           Text(o.seed) +
           "; positions are not rounded while runs are compared, since rounding "
           "makes jumps of the smallest differences"},
      {"reference", "dormand_prince, tolerances 1e-12 relative, 1e-14 absolute"},
      {"absolute tolerance", "a hundredth of the relative one"},
      {"duration", Text(o.compared_s) + " s for each comparison, " + Text(o.balanced_s) +
                       " s for each balance"},
      {"times",
       "median of " + Text(o.repetitions) +
           " of the processor; of this machine and its load, all else is the same at each run"}};
  report.claims = {Completes(balances, o.balanced_s), BelowNoise(full, o),
                   Cheaper(smooth, true, "smooth",
                           "a step of a multistep method needs one or two evaluations, whatever "
                           "its order",
                           o),
                   Cheaper(ideal, false, "sampled",
                           "a multistep method starts again at order one behind each sample", o),
                   Cheaper(full, false, "sampled-friction",
                           "the same; and friction is not stiff at this tolerance", o)};
  for (const Balance& run : balances) report.claims.push_back(Balances(run));
  for (const Problem& problem : problems) report.figures.push_back(WorkFigure(problem, o));
  report.tables = {BalanceTable(balances), WorkTable(problems, kUsual, o),
                   EqualErrorTable(problems, kUsual, o)};
  Timing timing{};
  for (const Balance& run : balances) {
    timing.simulated_s += run.simulated_s;
    timing.wall_s += run.wall_s;
    timing.ticks += std::llround(1000 * run.simulated_s);
    timing.integrator_steps += run.integrator.steps;
    timing.derivative_calls += run.integrator.derivative_calls;
  }
  report.timing = timing;
  return report;
}

}  // namespace pliant
