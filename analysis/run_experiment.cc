#include "pliant/analysis/run_experiment.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/series.h"
#include "pliant/analysis/with_unit.h"
#include "pliant/analysis/write_file.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

/// One run of one repetition.
struct Job {
  const RunOf* run;
  Scenario scenario;
  int repetition;
  std::filesystem::path log;
};

std::string Exact(double value) { return internal::YamlText(value); }

McapLog::Options LogOf(const Job& job, const ExperimentFile& file, bool force) {
  const std::filesystem::path urdf = UrdfOf(job.scenario);
  return {.file = job.log,
          .force = force,
          .metadata = {{"pliant",
                        {{"version", PLIANT_VERSION},
                         {"built_with", PLIANT_BUILT_WITH},
                         {"experiment", file.text()},
                         {"scenario", ParametersText(job.scenario)},
                         {"run", job.run->name},
                         {"title", job.run->title},
                         {"repetition", std::to_string(job.repetition)},
                         {"seed", std::to_string(job.scenario.seed)}}}},
          .robot = RobotModel::FromUrdf(urdf),
          .robot_description = internal::ReadFile(urdf),
          .position = "arm.measured_position",
          .velocity = "arm.measured_velocity",
          .torque = "arm.measured_torque"};
}

class Execution {
 public:
  Execution(const ExperimentFile& file, const RunOptions& options)
      : file_{file}, options_{options} {
    for (int k = 0; k < options.repeat; ++k)
      for (std::size_t i = 0; i < file.scenarios.size(); ++i) {
        Job job{.run = &file.experiment.runs[i],
                .scenario = file.scenarios[i],
                .repetition = k,
                .log = {}};
        job.scenario.seed += static_cast<std::uint64_t>(k);
        job.log = options.out / "logs" /
                  (job.run->name + (options.repeat > 1 ? "-" + std::to_string(k) : "") + ".mcap");
        jobs_.push_back(std::move(job));
      }
  }

  std::vector<std::filesystem::path> Run() {
    internal::MakeDirectory(options_.out / "logs");
    if (options_.force) RemoveOldLogs();
    // Refused before anything is run, not after an hour.
    for (const Job& job : jobs_)
      if (std::error_code unknown; !options_.force && std::filesystem::exists(job.log, unknown))
        throw Error(job.log.string() + " exists; give --force to write over it, or another --out");
    {
      std::vector<std::jthread> threads;
      const auto count =
          std::min<std::size_t>(static_cast<std::size_t>(options_.jobs), jobs_.size());
      try {
        for (std::size_t i = 1; i < count; ++i) threads.emplace_back([this] { Work(); });
      } catch (const std::system_error&) {
        // Fewer at a time, where the system gives no more threads.
      }
      Work();
    }
    if (failure_) throw FailedRun(*failure_);
    std::vector<std::filesystem::path> logs;
    for (std::size_t i = 0; i < std::min<std::size_t>(next_, jobs_.size()); ++i)
      logs.push_back(jobs_[i].log);
    return logs;
  }

 private:
  /// Those of other repetitions, which would be taken for some of this.
  void RemoveOldLogs() const {
    for (const auto& entry : std::filesystem::directory_iterator(options_.out / "logs")) {
      const std::filesystem::path& log = entry.path();
      const std::string name = log.stem().string();
      const std::string of = name.substr(0, name.find_last_not_of("0123456789") + 1);
      const bool ours = std::ranges::any_of(file_.experiment.runs, [&](const RunOf& run) {
        return name == run.name || (of == run.name + "-" && name != of);
      });
      if (log.extension() != ".mcap" || !ours ||
          std::ranges::find(jobs_, log, &Job::log) != jobs_.end())
        continue;
      std::error_code error;
      std::filesystem::remove(log, error);
      if (error)
        throw Error("cannot take away the older log " + log.string() + ": " + error.message() +
                    "\nmove it, or give another --out");
    }
  }

  bool Stopped() const { return failed_ || (options_.stop && *options_.stop); }

  void Work() {
    while (!Stopped()) {
      const std::size_t i = next_++;
      if (i >= jobs_.size()) return;
      try {
        Execute(jobs_[i]);
      } catch (const std::exception& e) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = jobs_[i].log.string() + ": " + e.what();
        failed_ = true;
      }
    }
  }

  void Execute(const Job& job) {
    const auto log = std::make_shared<McapLog>(LogOf(job, file_, options_.force));
    ScenarioDiagram scene(job.scenario, log);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = job.scenario.integrator});
    const auto begin = std::chrono::steady_clock::now();
    const auto wall = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const double duration = job.scenario.duration_s;
    const double period = seconds(scene.control_period);
    // The tick at the end, if there is one, is the last.
    const double ticks = std::ceil(duration / period - 1e-9);
    const bool ends_with_a_tick = std::abs(ticks * period - duration) < 1e-9;
    const auto end = [&](bool whole) {
      const Integrator::Statistics statistics = sim.statistics();
      log->AddMetadata(
          "pliant.run",
          {{"whole", whole ? "1" : "0"},
           {"simulated_s", Exact(sim.time())},
           {"wall_s", Exact(wall())},
           {"ticks", std::to_string(std::llround(std::ceil(sim.time() / period - 1e-9)) +
                                    (whole && ends_with_a_tick))},
           {"integrator_steps", std::to_string(statistics.steps)},
           {"derivative_calls", std::to_string(statistics.derivative_calls)}});
      log->Close();
    };
    const std::string phase =
        job.run->title + (options_.repeat > 1 ? ", " + std::to_string(job.repetition) : "");
    bool whole = false;
    try {
      const auto parts = static_cast<std::int64_t>(std::ceil(10 * duration));
      std::int64_t k = 0;
      // A log that cannot be written ends the run; Close says why.
      while (k < parts && !Stopped() && log->statistics().error.empty()) {
        ++k;
        sim.AdvanceTo(duration * static_cast<double>(k) / static_cast<double>(parts));
        if (!options_.progress) continue;
        const std::lock_guard lock(mutex_);
        options_.progress(phase, sim.time(), duration, wall());
      }
      whole = k == parts;
      if (whole && ends_with_a_tick) sim.AdvanceThroughTick();
    } catch (const std::exception& reason) {
      try {
        end(false);
      } catch (const std::exception& also) {
        throw Error(std::string(reason.what()) + "\n" + also.what());
      }
      throw;
    }
    end(whole);
  }

  const ExperimentFile& file_;
  const RunOptions& options_;
  std::vector<Job> jobs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::optional<std::string> failure_;
};

std::string EstimatorOf(const ComplianceControl::Options& c) {
  const std::string gain = "K_I = " + Text(c.observer_gain) + " 1/s";
  const std::string rate = "L = " + Text(c.observer_rate) + " N·m/s";
  switch (c.estimate) {
    case TorqueEstimate::True:
      return "none: external torques are known";
    case TorqueEstimate::Observer:
      return "momentum observer, " + gain;
    case TorqueEstimate::SuperTwisting:
      return "super-twisting observer, " + rate;
    case TorqueEstimate::Fusion:
      return "momentum observer and wrist sensor, complementary, " + gain;
    case TorqueEstimate::SuperTwistingFusion:
      return "wrist sensor and super-twisting observer, " + rate;
    case TorqueEstimate::Zero:
      break;
  }
  return "none: external torques are taken for 0";
}

std::vector<Setting> SettingsOfRun(const RunData& run) {
  const Scenario& s = run.scenario;
  const StationOptions& station = std::get<StationOptions>(s.station);
  const ComplianceControl::Options& c = run.control;
  const auto gains = [](const auto& g) {
    return Text(g.stiffness) + " 1/s², " + Text(g.damping) + " 1/s, weight " + Text(g.weight);
  };
  return {
      {"robot",
       run.arm.model.name() +
           (station.ideal ? ", ideal torque actuators and sensors"
                          : ", elastic gears with friction, sensors with noise and offsets "
                            "(seed " +
                                Text(s.seed) + "), torque loop of the RSS paper")},
      {"rotor inertia", Text(c.rotor_inertia.transpose()) + " kg·m², reflected"},
      {"plant", Words(station.engine)[static_cast<std::size_t>(station.engine)]},
      {"controller", "one QP at " + c.period.text() + ": pose of " + c.tool + " " + gains(c.pose) +
                         "; posture " + gains(c.posture)},
      {"limits", "torque, and dampers with λ = " + Text(c.damper.rate) +
                     " 1/s, M = " + Text(c.damper.damping_ratio) +
                     ", d_s = " + Text(100 * c.damper.safety_distance) + " % of the range"},
      {"estimator", EstimatorOf(c)},
      {"compliance", c.modes ? "as the modes say"
                             : "Γ = " + internal::YamlText(c.pose.compliance) + " of the pose, " +
                                   internal::YamlText(c.posture.compliance) + " of the posture"},
      {"integrator", std::string(Name(s.integrator.method)) + ", tolerances " +
                         Text(s.integrator.relative_tolerance) + " relative, " +
                         Text(s.integrator.absolute_tolerance) + " absolute"},
      {"duration", Text(s.duration_s) + " s, a row of the log each " + run.sample_period().text()},
      {"version", "pliant " + run.version + "; " + run.built_with}};
}

/// What all runs of a repetition have in common, and where they differ.
std::vector<Setting> SettingsOf(const Runs& runs) {
  std::vector<Setting> settings = SettingsOfRun(*runs.all().front());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    std::map<std::string, std::string> titles;  // by value
    for (const RunData* run : runs.all()) {
      std::string& with = titles[SettingsOfRun(*run)[i].value];
      with += (with.empty() ? "" : "; ") + run->title;
    }
    if (titles.size() == 1) continue;
    settings[i].value.clear();
    for (const auto& [value, of] : titles)
      settings[i].value += (settings[i].value.empty() ? "" : " / ") + value + " (" + of + ")";
  }
  return settings;
}

/// Least and greatest of a quantity of every joint, over all runs.
std::vector<Extent> Extents(const std::vector<RunData>& runs, const char* path,
                            double Joint::*lower, double Joint::*upper, double sign) {
  const RobotModel& model = runs.front().arm.model;
  std::vector<Extent> extents;
  for (int j = 0; j < model.size(); ++j) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    Extent e{model.joint(j).name, kNone, -kNone, sign * (model.joint(j).*lower),
             model.joint(j).*upper};
    for (const RunData& run : runs) {
      e.least = std::min(e.least, -Largest(-run[path].row(j)));
      e.greatest = std::max(e.greatest, Largest(run[path].row(j)));
    }
    extents.push_back(e);
  }
  return extents;
}

Experiment ExperimentOf(const RunData& run) {
  Experiment experiment;
  ParameterFile::ReadText(run.experiment, run.file.string() + ": experiment").Fill(experiment);
  return experiment;
}

/// The runs of each repetition; throws Error if they do not fit together.
std::vector<Runs> Repetitions(const std::vector<RunData>& runs, const Experiment& experiment) {
  std::map<int, std::vector<const RunData*>> by_number;
  for (const RunData& run : runs) {
    if (run.experiment != runs.front().experiment)
      throw Error(run.file.string() + ": the log is of another experiment than " +
                  runs.front().file.string());
    if (run.times().size() == 0)
      throw Error(run.file.string() + ": the log has no row; a report needs whole runs");
    if (!run.whole)
      throw Error(run.file.string() + ": the run ended at " + Text(run.times().tail<1>()(0)) +
                  " s of " + Text(run.scenario.duration_s) + " s; a report needs whole runs");
    by_number[run.repetition].push_back(&run);
  }
  std::vector<Runs> all;
  for (const auto& [number, of] : by_number) {
    all.emplace_back(of);
    for (const RunOf& run : experiment.runs) {
      const auto count = std::ranges::count(of, run.name, &RunData::name);
      if (count != 1)
        throw Error("repetition " + Text(number) + " has " +
                    (count == 0 ? "no log" : Text(count) + " logs") + " of run '" + run.name +
                    "'; a report needs one of each run");
    }
  }
  return all;
}

Claim Checked(const ClaimCheck& check, const std::vector<Runs>& repetitions) {
  std::optional<Claim> shown;  // of the first repetition, or the first that fails
  std::size_t holding = 0;
  for (const Runs& runs : repetitions) {
    Claim claim = std::visit([&](const auto& of) { return of.Check(runs); }, check);
    holding += claim.holds;
    if (!shown || (shown->holds && !claim.holds)) shown = std::move(claim);
  }
  if (repetitions.size() > 1) {
    shown->measured = "holds in " + Text(holding) + " of " + Text(repetitions.size()) +
                      " repetitions; in the " + (shown->holds ? "first: " : "first that fails: ") +
                      shown->measured;
    shown->criterion += "; in every repetition";
  }
  return *shown;
}

Timing TimingOf(const std::vector<RunData>& runs) {
  Timing all{};
  for (const RunData& run : runs) {
    all.simulated_s += run.timing.simulated_s;
    all.wall_s += run.timing.wall_s;
    all.ticks += run.timing.ticks;
    all.integrator_steps += run.timing.integrator_steps;
    all.derivative_calls += run.timing.derivative_calls;
  }
  return all;
}

}  // namespace

std::vector<std::filesystem::path> RunExperiment(const ExperimentFile& file, const RunOptions& o) {
  Require(o.repeat >= 1, "repeat must be >= 1", o.repeat);
  Require(o.jobs >= 1, "jobs must be >= 1", o.jobs);
  return Execution(file, o).Run();
}

std::vector<RunData> ReadRuns(const std::vector<std::filesystem::path>& logs) {
  std::vector<RunData> runs;
  for (const std::filesystem::path& log : logs) runs.push_back(RunData::Read(log));
  if (runs.empty()) return runs;
  const Experiment experiment = ExperimentOf(runs.front());
  std::ranges::stable_sort(runs, {}, [&](const RunData& run) {
    return std::pair(run.repetition, std::ranges::find(experiment.runs, run.name, &RunOf::name));
  });
  return runs;
}

Report ReportOf(const std::vector<RunData>& runs) {
  Require(!runs.empty(), "a report needs the log of a run");
  const Experiment experiment = ExperimentOf(runs.front());
  const std::vector<Runs> repetitions = Repetitions(runs, experiment);

  Report report{.title = experiment.title, .summary = experiment.summary};
  report.settings = SettingsOf(repetitions.front());
  if (repetitions.size() > 1)
    report.settings.push_back({"repetitions", Text(repetitions.size()) + ", each with its seed"});
  for (const ClaimCheck& check : experiment.claims)
    report.claims.push_back(Checked(check, repetitions));
  for (const FigureOf& figure : experiment.figures)
    report.figures.push_back(
        std::visit([&](const auto& of) { return of.Draw(repetitions.front()); }, figure));
  const auto extents = [&](const char* title, const char* unit, const char* path,
                           double Joint::*lower, double Joint::*upper, double sign) {
    report.tables.push_back(ExtentsTable(title, unit, Extents(runs, path, lower, upper, sign)));
  };
  extents("Joint positions, all runs", "rad", "arm.measured_position", &Joint::lower, &Joint::upper,
          1);
  extents("Joint velocities, all runs", "rad/s", "arm.measured_velocity", &Joint::velocity,
          &Joint::velocity, -1);
  extents("Joint torques, all runs", "N·m", "control.torque", &Joint::effort, &Joint::effort, -1);
  report.timing = TimingOf(runs);
  return report;
}

}  // namespace pliant
