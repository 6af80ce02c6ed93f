#include "pliant/analysis/run_experiment.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "pliant/analysis/advance_run.h"
#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/repeated_number.h"
#include "pliant/analysis/run_log.h"
#include "pliant/analysis/run_settings.h"
#include "pliant/analysis/series.h"
#include "pliant/analysis/with_unit.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {

using internal::AdvanceInParts;

namespace {

/// One run of one repetition.
struct Job {
  const RunOf* run;
  Scenario scenario;
  int repetition;
  std::filesystem::path log;
};

class Execution {
 public:
  Execution(const ExperimentFile& file, const RunOptions& options)
      : file_{file}, options_{options} {
    for (int k = 0; k < file.experiment.repeat; ++k)
      for (std::size_t i = 0; i < file.scenarios.size(); ++i) {
        Job job{.run = &file.experiment.runs[i],
                .scenario = file.scenarios[i],
                .repetition = k,
                .log = {}};
        job.scenario.seed += static_cast<std::uint64_t>(k);
        job.log =
            options.out / "logs" /
            (job.run->name + (file.experiment.repeat > 1 ? "-" + std::to_string(k) : "") + ".mcap");
        jobs_.push_back(std::move(job));
      }
  }

  std::vector<std::filesystem::path> Run() {
    Require(!options_.view || jobs_.size() == 1,
            "a page shows one run; name it with --run, and --repeat 1", jobs_.size());
    if (Logs()) {
      internal::MakeDirectory(options_.out / "logs");
      if (options_.force) RemoveOldLogs();
    }
    // Refused before anything is run, not after an hour.
    for (const Job& job : jobs_)
      if (std::error_code unknown;
          Logs() && !options_.force && std::filesystem::exists(job.log, unknown))
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
    for (std::size_t i = 0; Logs() && i < std::min<std::size_t>(next_, jobs_.size()); ++i)
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

  bool Logs() const { return !options_.view || !options_.out.empty(); }
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

  std::shared_ptr<McapLog> LogOf(const Job& job, const Scenario& scenario) const {
    if (!Logs()) return {};
    return std::make_shared<McapLog>(RunLogOf({.file = job.log,
                                               .experiment = file_.text(),
                                               .run = *job.run,
                                               .scenario = scenario,
                                               .repetition = job.repetition,
                                               .force = options_.force}));
  }

  void Execute(const Job& job) {
    LiveView* const view = options_.view;
    const Scenario scenario = view ? view->Pushable(job.scenario) : job.scenario;
    const std::shared_ptr<McapLog> log = LogOf(job, scenario);
    const auto panel = view ? std::make_shared<OperatorPanel>() : nullptr;
    ScenarioDiagram scene(scenario,
                          view ? view->Sink(scenario, log) : std::shared_ptr<RecordSink>(log),
                          {.panel = panel});
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    const auto begin = std::chrono::steady_clock::now();
    const auto wall = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    const double duration = scenario.duration_s;
    const Duration period = scene.control_period;
    const auto end = [&](bool whole) {
      if (!log) return;
      const std::int64_t ticks = view ? ticks_shown_ : TicksOf(sim, period);
      log->AddMetadata("pliant.run", RunEndOf(sim, whole, wall(), ticks));
      log->Close();
    };
    bool whole = false;
    try {
      whole = view ? Show(job, sim,
                          {.run = *job.run,
                           .scenario = scenario,
                           .scene = &scene,
                           .diagram = &diagram,
                           .panel = scene.safety ? panel : nullptr})
                   : Advance(job, sim, *log, wall);
      // A view shows the only run: other threads have no others.
      if (whole && TickAtEnd(sim, duration, period) && view) {
        ++ticks_shown_;
        if (sim.ended()) reason_ = sim.ended()->text();
      }
    } catch (const std::exception& reason) {
      if (view) view->End(reason.what());
      try {
        end(false);
      } catch (const std::exception& also) {
        throw Error(std::string(reason.what()) + "\n" + also.what());
      }
      throw;
    }
    if (view) view->End(reason_);
    end(whole);
  }

  /// As fast as it goes. Whether it came to its end.
  template <class Wall>
  bool Advance(const Job& job, Simulator& sim, const McapLog& log, const Wall& wall) {
    const std::string phase =
        job.run->title + (file_.experiment.repeat > 1 ? ", " + std::to_string(job.repetition) : "");
    const double duration = job.scenario.duration_s;
    return AdvanceInParts(sim, duration, [&] {
      if (options_.progress) {
        const std::lock_guard lock(mutex_);
        options_.progress(phase, sim.time(), duration, wall());
      }
      // A log that cannot be written ends the run; Close says why.
      return !Stopped() && log.statistics().error.empty();
    });
  }

  /// At the pace of the wall clock, for those who look on. Whether it came to its end.
  bool Show(const Job& job, Simulator& sim, const LiveView::Run& run) {
    LiveView& view = *options_.view;
    view.Begin(run);
    RealTimeRunner runner(
        sim, {.stop = &view.stop(),
              .before_tick = [&, change = view.BeforeTick()](Simulator& s, const RunReport& now) {
                if (Stopped()) view.RequestStop();
                change(s, now);
              }});
    const RunReport& report = runner.Run(job.scenario.duration_s);
    reason_ = report.reason;
    ticks_shown_ = report.ticks;
    if (options_.say) options_.say(report.text());
    return report.end == RunEnd::TimeReached || report.end == RunEnd::Ended;
  }

  const ExperimentFile& file_;
  const RunOptions& options_;
  std::vector<Job> jobs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::optional<std::string> failure_;
  // Of a run that is shown.
  std::string reason_;
  std::int64_t ticks_shown_ = 0;
};

Experiment ExperimentOf(const RunHeading& run) {
  Experiment experiment;
  ParameterFile::ReadText(run.experiment, run.file.string() + ": experiment").Fill(experiment);
  return experiment;
}

/// A claim about one repetition, over all of them.
class RepeatedCheck {
 public:
  void Add(Claim claim) {
    ++all_;
    holding_ += claim.holds;
    if (!shown_ || (shown_->holds && !claim.holds)) shown_ = std::move(claim);
  }
  Claim claim() const {
    Claim claim = *shown_;
    if (all_ == 1) return claim;
    claim.measured = "holds in " + Text(holding_) + " of " + Text(all_) + " repetitions; in the " +
                     (claim.holds ? "first: " : "first that fails: ") + claim.measured;
    claim.criterion += "; in every repetition";
    return claim;
  }

 private:
  std::optional<Claim> shown_;  // of the first repetition, or the first that fails
  std::size_t holding_ = 0, all_ = 0;
};

/// Least and greatest of a quantity of every joint.
class JointExtents {
 public:
  JointExtents(const char* title, const char* unit, const char* path, double Joint::*lower,
               double Joint::*upper, double sign)
      : title_{title}, unit_{unit}, path_{path}, lower_{lower}, upper_{upper}, sign_{sign} {}

  void Add(const RunData& run) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const RobotModel& model = run.arm.model;
    for (int j = 0; j < model.size(); ++j) {
      const auto i = static_cast<std::size_t>(j);
      const Joint& joint = model.joint(j);
      if (i == extents_.size())
        extents_.push_back({joint.name, kNone, -kNone, sign_ * (joint.*lower_), joint.*upper_});
      Extent& e = extents_[i];
      e.least = std::min(e.least, -Largest(-run[path_].row(j)));
      e.greatest = std::max(e.greatest, Largest(run[path_].row(j)));
    }
  }
  Table table() const { return ExtentsTable(title_, unit_, extents_); }

 private:
  const char *title_, *unit_, *path_;
  double Joint::*lower_, Joint::*upper_;
  double sign_;
  std::vector<Extent> extents_;
};

/// Takes the repetitions of an experiment one by one and keeps what a report says of them.
class Reporting {
 public:
  explicit Reporting(const Experiment& experiment)
      : experiment_{experiment}, checks_(experiment.claims.size()) {
    report_.title = experiment.title;
    report_.summary = experiment.summary;
    report_.timing = Timing{};
    report_.figures.resize(experiment.figures.size());
    for (const ClaimCheck& check : experiment.claims)
      std::visit([&](const auto& of) { claims_.push_back(NumbersOf(of)); }, check);
    for (const FigureOf& figure : experiment.figures)
      std::visit([&](const auto& of) { figures_.push_back(NumbersOf(of)); }, figure);
    for (const NumberTable& table : experiment.tables) tables_.push_back(table.Wanted());
  }

  void Add(const Runs& runs) {
    if (++repetitions_ == 1) report_.settings = RunSettings(runs);
    for (std::size_t i = 0; i < checks_.size(); ++i)
      std::visit(
          [&](const auto& of) {
            About(of, [&] {
              if constexpr (requires { of.Check(runs); }) checks_[i].Add(of.Check(runs));
              for (RepeatedNumber& number : claims_[i]) number.Add(runs);
            });
          },
          experiment_.claims[i]);
    for (auto* all : {&figures_, &tables_})
      for (std::vector<RepeatedNumber>& numbers : *all)
        for (RepeatedNumber& number : numbers) number.Add(runs);
    for (std::size_t i = 0; repetitions_ == 1 && i < experiment_.figures.size(); ++i)
      std::visit(
          [&](const auto& of) {
            if constexpr (requires { of.Draw(runs); }) report_.figures[i] = of.Draw(runs);
          },
          experiment_.figures[i]);
    for (const RunData* run : runs.all()) {
      for (JointExtents& extents : extents_) extents.Add(*run);
      report_.timing->simulated_s += run->timing.simulated_s;
      report_.timing->wall_s += run->timing.wall_s;
      report_.timing->ticks += run->timing.ticks;
      report_.timing->integrator_steps += run->timing.integrator_steps;
      report_.timing->derivative_calls += run->timing.derivative_calls;
    }
  }

  Report Finish() {
    if (repetitions_ > 1)
      report_.settings.push_back({"repetitions", Text(repetitions_) + ", each with its seed"});
    std::vector<RepeatedNumber> measured;
    for (std::size_t i = 0; i < checks_.size(); ++i)
      std::visit(
          [&](const auto& of) {
            if constexpr (requires { of.Judge(claims_[i].front()); }) {
              report_.claims.push_back(of.Judge(claims_[i].front()));
            } else {
              report_.claims.push_back(checks_[i].claim());
            }
          },
          experiment_.claims[i]);
    for (std::size_t i = 0; i < figures_.size(); ++i)
      std::visit(
          [&](const auto& of) {
            if constexpr (requires { of.Draw(figures_[i]); })
              report_.figures[i] = of.Draw(figures_[i]);
          },
          experiment_.figures[i]);
    for (std::size_t i = 0; i < tables_.size(); ++i)
      report_.results.push_back(experiment_.tables[i].Show(tables_[i]));
    for (const auto* all : {&claims_, &figures_})
      for (const std::vector<RepeatedNumber>& numbers : *all)
        measured.insert(measured.end(), numbers.begin(), numbers.end());
    if (repetitions_ > 1 && !measured.empty()) report_.tables.push_back(NumbersTable(measured));
    for (const JointExtents& extents : extents_) report_.tables.push_back(extents.table());
    return std::move(report_);
  }

 private:
  /// Says which claim cannot be checked.
  template <class Check, class Act>
  static void About(const Check& check, const Act& act) {
    try {
      act();
    } catch (const Error& e) {
      throw Error("claim '" + check.claim.id + "': " + e.what());
    }
  }

  /// What a claim or a figure wants measured in every repetition.
  template <class Part>
  static std::vector<RepeatedNumber> NumbersOf(const Part& part) {
    if constexpr (requires { part.Wanted(); }) return part.Wanted();
    return {};
  }

  const Experiment& experiment_;
  Report report_;
  int repetitions_ = 0;
  std::vector<RepeatedCheck> checks_;  // one for each claim, as are the numbers
  std::vector<std::vector<RepeatedNumber>> claims_, figures_, tables_;
  std::array<JointExtents, 3> extents_{
      {{"Joint positions, all runs", "rad", "arm.measured_position", &Joint::lower, &Joint::upper,
        1},
       {"Joint velocities, all runs", "rad/s", "arm.measured_velocity", &Joint::velocity,
        &Joint::velocity, -1},
       {"Joint torques, all runs", "N·m", "control.torque", &Joint::effort, &Joint::effort, -1}}};
};

/// By number of repetition, the places of its runs in the order of the experiment; throws Error if
/// they do not fit together.
std::map<int, std::vector<std::size_t>> Repetitions(const std::vector<RunHeading>& runs,
                                                    const Experiment& experiment) {
  std::map<int, std::vector<std::size_t>> all;
  for (std::size_t i = 0; i < runs.size(); ++i) all[runs[i].repetition].push_back(i);
  for (auto& [number, of] : all) {
    for (const RunOf& run : experiment.runs) {
      const auto count = std::ranges::count(
          of, run.name, [&](std::size_t i) -> const std::string& { return runs[i].name; });
      if (count != 1)
        throw Error("repetition " + Text(number) + " has " +
                    (count == 0 ? "no log" : Text(count) + " logs") + " of run '" + run.name +
                    "'; a report needs one of each run");
    }
    std::ranges::stable_sort(of, {}, [&](std::size_t i) {
      return std::ranges::find(experiment.runs, runs[i].name, &RunOf::name);
    });
  }
  return all;
}

using ReadOne = std::function<std::shared_ptr<const RunData>(std::size_t)>;

void RequireRows(const RunData& run) {
  if (run.times().size() == 0)
    throw Error(run.file.string() + ": the log has no row; a report needs whole runs");
}

/// Before any run is read whole, as far as that can be said then.
void RequireWhole(const std::vector<RunHeading>& runs, const ReadOne& read) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].experiment != runs.front().experiment)
      throw Error(runs[i].file.string() + ": the log is of another experiment than " +
                  runs.front().file.string());
    if (runs[i].whole) continue;
    const std::shared_ptr<const RunData> run = read(i);
    RequireRows(*run);
    throw Error(run->file.string() + ": the run ended at " + Text(run->times().tail<1>()(0)) +
                " s of " + Text(run->scenario.duration_s) + " s; a report needs whole runs");
  }
}

RunsReport Reported(const std::vector<RunHeading>& headings, const ReadOne& read) {
  Require(!headings.empty(), "a report needs the log of a run");
  RequireWhole(headings, read);
  const Experiment experiment = ExperimentOf(headings.front());
  const std::map<int, std::vector<std::size_t>> repetitions = Repetitions(headings, experiment);
  RequireRepetitions(experiment, static_cast<int>(repetitions.size()));

  Reporting reporting(experiment);
  RunsReport result;
  for (const auto& [number, of] : repetitions) {
    RunsReport one;
    for (const std::size_t i : of) {
      one.kept.push_back(read(i));
      RequireRows(*one.kept.back());
    }
    reporting.Add(one.runs());
    if (result.kept.empty()) result.kept = std::move(one.kept);
  }
  result.report = reporting.Finish();
  return result;
}

}  // namespace

std::vector<std::filesystem::path> RunExperiment(const ExperimentFile& file, const RunOptions& o) {
  Require(file.experiment.repeat >= 1, "repeat must be >= 1", file.experiment.repeat);
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

std::shared_ptr<const RunData> ReadWhole(const std::filesystem::path& log) {
  return std::make_shared<const RunData>(RunData::Read(log));
}

Runs RunsReport::runs() const {
  std::vector<const RunData*> all;
  for (const std::shared_ptr<const RunData>& run : kept) all.push_back(run.get());
  return Runs(std::move(all));
}

Report ReportOf(const std::vector<RunData>& runs) {
  const std::vector<RunHeading> headings(runs.begin(), runs.end());
  return Reported(headings,
                  [&](std::size_t i) {
                    return std::shared_ptr<const RunData>(std::shared_ptr<void>(), &runs[i]);
                  })
      .report;
}

RunsReport ReportOf(const std::vector<std::filesystem::path>& logs, const ReadRun& read) {
  std::vector<RunHeading> headings;
  for (const std::filesystem::path& log : logs) headings.push_back(RunHeading::Read(log));
  return Reported(headings, [&](std::size_t i) { return read(logs[i]); });
}

}  // namespace pliant
