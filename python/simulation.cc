#include "pliant/python/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/run_log.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::python {

RobotModel ModelNamed(const std::string& robot) { return RobotModel::FromUrdf(UrdfOf(robot)); }

Simulation::Simulation(const ExperimentFile& file, std::size_t run, TorqueLaw::Function law)
    : experiment_{file.text()},
      run_{file.experiment.runs.at(run)},
      scenario_{file.scenarios.at(run)},
      has_law_{law != nullptr},
      diagram_{Build(std::move(law))},
      sim_{diagram_, {.integrator = scenario_.integrator}},
      ports_{ReadableValuesOf(diagram_)} {}

Diagram Simulation::Build(TorqueLaw::Function law) {
  Require(!IsHardware(scenario_),
          "station !Gen3 is an arm that is there: expected station: !SimulatedArm {…}");
  period_ = ControlPeriodOf(scenario_);
  if (law) return LawDiagram(scenario_, std::move(law), sink_).builder.Build();
  return ScenarioDiagram(scenario_, sink_).builder.Build();
}

bool Simulation::AdvanceFor(double t, std::chrono::milliseconds at_most) {
  using WallClock = std::chrono::steady_clock;
  const WallClock::time_point begin = WallClock::now();
  const auto passed = [&] { return WallClock::now() - begin; };
  const auto count = [&] {
    wall_s_ += std::chrono::duration<double>(passed()).count();
    time_ = sim_.time();
  };
  // A run in many parts is the same run, bit for bit. Its clock has nanoseconds: it stands still
  // when the one nearest to t is reached.
  const double part = 10 * seconds(period_);
  bool reached = false;
  if (t <= sim_.time()) sim_.AdvanceTo(t);
  try {
    while (!reached && !stop && passed() < at_most) {
      const double before = sim_.time();
      sim_.AdvanceTo(std::min(t, before + part));
      time_ = sim_.time();
      reached = sim_.ended() || sim_.time() == before;
    }
  } catch (const Error& e) {
    count();
    throw FailedRun(e.what());
  } catch (...) {
    count();
    throw;
  }
  count();
  return reached || stop;
}

void Simulation::TickAtEnd() { pliant::TickAtEnd(sim_, duration(), period_); }

std::string Simulation::ended() const {
  const std::optional<Simulator::Ending> ending = sim_.ended();
  return ending ? ending->text() : "";
}

const ReadableValue& Simulation::port(const std::string& path) const {
  const auto found = std::ranges::find(ports_, path, &ReadableValue::path);
  if (found != ports_.end()) return *found;
  std::vector<std::string> paths;
  for (const ReadableValue& port : ports_) paths.push_back(port.path);
  throw UnknownName("the diagram has no value '" + path + "'" + DidYouMean(path, paths));
}

std::vector<double> Simulation::Get(const ReadableValue& port) {
  std::vector<double> numbers(port.elements.size());
  sim_.GetNumbers(*port.value, numbers);
  return numbers;
}

void Simulation::Set(const ReadableValue& port, const std::vector<double>& numbers) {
  const std::vector<double> before = Get(port);
  sim_.SetNumbers(*port.value, numbers);
  if (port.whole && Get(port) != numbers) {
    sim_.SetNumbers(*port.value, before);
    throw Error(port.path + ": expected a whole number of its type, got " + Text(numbers[0]));
  }
  auto change = std::ranges::find(changed_, port.path, &std::pair<std::string, int>::first);
  if (change == changed_.end())
    change = changed_.insert(changed_.end(),
                             {port.path, sink_->Open({static_cast<const RecordedValue&>(port)})});
  const std::span<double> row = sink_->Begin(change->second, sim_.next_tick_ns());
  std::ranges::copy(numbers, row.begin());
  sink_->Commit();
}

void Simulation::WriteLog(const std::filesystem::path& file, bool force) const {
  McapLog::Options options = RunLogOf({.file = file,
                                       .experiment = experiment_,
                                       .run = run_,
                                       .scenario = scenario_,
                                       .force = force});
  // What a function has done cannot be repeated from the log.
  if (has_law_) options.metadata = {{"pliant.law", {{"scenario", experiment_}}}};
  McapLog log(std::move(options));
  sink_->CopyTo(log);
  if (!has_law_) {
    const bool whole = sim_.ended() || sim_.time() >= duration();
    log.AddMetadata("pliant.run", RunEndOf(sim_, whole, wall_s_, TicksOf(sim_, period_)));
  }
  log.Close();
}

Values Simulation::ValuesOf(const std::vector<std::string>& paths) const {
  Values values;
  for (const std::string& path : paths) values.push_back(*port(path).value);
  return values;
}

Linearization Simulation::LinearizeBetween(const std::vector<std::string>& inputs,
                                           const std::vector<std::string>& outputs) {
  const Ports ports{.inputs = ValuesOf(inputs), .outputs = ValuesOf(outputs)};
  return Linearize(diagram_, sim_.context(), ports);
}

}  // namespace pliant::python
