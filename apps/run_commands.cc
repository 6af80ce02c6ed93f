#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/figure.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/study.h"
#include "pliant/apps/arm_run.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/progress_line.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/set_option.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/apps/view_options.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

constexpr int kStopped = 130;

/// What `run`, `experiment run` and `report` are told.
struct Told {
  std::string file;  // or name
  std::vector<std::string> names, set, logs;
  fs::path out;
  std::optional<int> repeat;  // none: what the file says
  int jobs = 1;
  bool force = false, strict = false, check = false, verbose = false;
  ArmTold arm;
  ViewTold view;
};

Overrides AllOverrides(const Told& told) {
  Overrides overrides = OverridesOf(told.set);
  if (told.repeat) overrides.emplace_back("repeat", std::to_string(*told.repeat));
  return overrides;
}

/// A report that is there stays, unless told otherwise.
void RefuseToOverwrite(const fs::path& out, bool force) {
  for (const char* name : {"report.html", "verdict.json"})
    if (std::error_code unknown; !force && fs::exists(out / name, unknown))
      throw Error((out / name).string() +
                  " exists; give --force to write over it, or another --out");
}

/// A report on other logs than those beside it says what is not so.
void RemoveReport(const fs::path& out) {
  for (const char* name : {"report.html", "verdict.json"})
    if (std::error_code none; true) fs::remove(out / name, none);
}

/// Before a long run, not after it.
void FindGnuplot() {
  try {
    RequireGnuplot();
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
}

int WriteAndTell(const Report& report, const fs::path& out, bool strict,
                 const Runs& runs = Runs()) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw Error("cannot make the directory " + out.string() + ": " + error.message());
  try {
    WriteReport(report, runs, out);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  bool all = true;
  for (const Claim& claim : report.claims) {
    std::printf("%-8s %s: %s\n", claim.holds ? "holds" : "FAILS", Printable(claim.id).c_str(),
                Printable(claim.measured).c_str());
    all = all && claim.holds;
  }
  std::printf("report: %s\n", (fs::absolute(out) / "report.html").lexically_normal().c_str());
  return strict && !all ? 1 : 0;
}

int ReportOnLogs(const std::vector<fs::path>& logs, const Told& told) {
  const RunsReport of = ReportOf(logs);
  return WriteAndTell(of.report, told.out, told.strict, of.runs());
}

/// Which runs a block has ended, and what the integrators did.
void TellOfRuns(const std::vector<fs::path>& logs, bool verbose) {
  for (const fs::path& log : logs) {
    const RunHeading run = RunHeading::Read(log);
    const std::string name = log.stem().string();
    if (!run.ended.empty()) std::printf("%s: %s\n", name.c_str(), Printable(run.ended).c_str());
    if (verbose) std::printf("%s: %s\n", name.c_str(), Printable(run.integrator).c_str());
  }
}

void Say(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

std::vector<fs::path> Run(const ExperimentFile& file, const Told& told) {
  const StopSignals signals;
  const std::unique_ptr<LiveView> view = ViewOf(told.view, false);
  ProgressLine line;
  try {
    std::vector<fs::path> logs =
        RunExperiment(file, {.out = told.out,
                             .jobs = told.jobs,
                             .force = told.force,
                             .progress = view ? Progress() : std::ref(line),
                             .stop = &StopSignals::requested,
                             .view = view.get(),
                             .say = Say});
    line.End();
    TellOfRuns(logs, told.verbose);
    return logs;
  } catch (const FailedRun& e) {
    line.End();
    throw CannotGoOn(e.what());
  }
}

/// One run, and what its page has shown is in its log, if there is one.
int ShowFile(ExperimentFile& file, const Told& told) {
  if (!told.arm.run.empty()) ChooseRun(file, told.arm.run);
  for (const fs::path& log : Run(file, told)) std::printf("log: %s\n", log.c_str());
  return StopSignals::requested ? kStopped : 0;
}

int RunFile(const fs::path& path, const Told& told) {
  ExperimentFile file = ReadForArm(path, AllOverrides(told), told.arm);
  if (told.check) {
    const std::size_t runs = file.scenarios.size();
    std::printf("%s: %zu %s, nothing is wrong\n", path.c_str(), runs, runs == 1 ? "run" : "runs");
    return 0;
  }
  Require(!told.out.empty() || (told.view.view && !IsAboutAnArm(file)),
          "--out is required: the folder of logs and report");
  if (IsAboutAnArm(file)) {
    const std::unique_ptr<LiveView> view = ViewOf(told.view, true);
    return RunOnArmAndTell(file, told.arm, told.out, told.force, view.get());
  }
  if (told.view.view) {
    if (told.force) RemoveReport(told.out);
    return ShowFile(file, told);
  }
  Require(told.arm.run.empty(), "--run is for an arm, or for --view", told.arm.run);
  RefuseToOverwrite(told.out, told.force);
  if (!file.experiment.figures.empty()) FindGnuplot();
  if (told.force) RemoveReport(told.out);
  const std::vector<fs::path> logs = Run(file, told);
  if (!StopSignals::requested) return ReportOnLogs(logs, told);
  std::fprintf(stderr, "stopped; what was logged:\n");
  for (const fs::path& log : logs) std::fprintf(stderr, "  %s\n", log.c_str());
  return kStopped;
}

int RunNamed(const std::string& name, const Told& told) {
  for (const Study& study : Studies())
    if (study.name == name) {
      Require(told.set.empty() && !told.repeat && told.jobs == 1,
              "'" + name + "' is no scenario: it takes neither --set nor --repeat nor --jobs");
      RefuseToOverwrite(told.out, told.force);
      FindGnuplot();
      return WriteAndTell(study.run(ProgressLine{}), told.out, told.strict);
    }
  return RunFile(FindExperiment(name).file, told);
}

int ListExperiments() {
  for (const NamedExperiment& e : Experiments())
    std::printf("%-24s %s\n", e.name.c_str(), e.title.c_str());
  for (const Study& s : Studies()) std::printf("%-24s %s\n", s.name.c_str(), s.summary.c_str());
  return 0;
}

void AddRunOptions(CLI::App& app, Told& told) {
  app.add_option("--out", told.out, "folder of logs and report, made if it is not there")
      ->check(SaysSomething());
  app.add_option("--set", told.set,
                 "path=value in the place of what the file says, such as station.ideal=true")
      ->allow_extra_args(false);
  app.add_option("--repeat", told.repeat,
                 "how often, each time with the next seed, in the place of what the file says")
      ->check(CLI::Range(1, 100000));
  app.add_option("--jobs", told.jobs, "runs at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_flag("--force", told.force,
               "write over logs and a report that are there; logs of other repetitions go");
  app.add_flag("--strict", told.strict, "exit with 1 if a claim fails");
  app.add_flag("--verbose", told.verbose, "says of each run what the integrator did");
}

}  // namespace

void AddRunCommands(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();

  CLI::App* run = app.add_subcommand("run", "Runs a scenario file and writes logs and a report");
  run->footer("Example: pliant run my_arm.yaml --set station.ideal=true --out out");
  run->add_option("file", told->file, "scenario, YAML")->required()->check(SaysSomething());
  AddRunOptions(*run, *told);
  AddArmOptions(*run, told->arm);
  AddViewOptions(*run, told->view);
  run->add_flag("--check", told->check, "only says whether the file can be run; needs no --out");
  commands.push_back({run, [told] { return RunFile(told->file, *told); }});

  CLI::App* experiment =
      app.add_subcommand("experiment", "Experiments of the papers, which come with pliant");
  experiment->require_subcommand(1);
  CLI::App* list = experiment->add_subcommand("list", "Names them");
  list->footer("Example: pliant experiment list");
  commands.push_back({list, ListExperiments});
  CLI::App* named = experiment->add_subcommand("run", "Runs some, as `pliant run` their files");
  named->footer(
      "Example: pliant experiment run null-space-compliance --out out\n"
      "With several names each has a folder of its own in --out.");
  named->add_option("names", told->names, "of the experiments")->required();
  AddRunOptions(*named, *told);
  named->get_option("--out")->required();
  commands.push_back({named, [told] {
                        for (const std::string& name : told->names)
                          if (std::ranges::find(Studies(), name, &Study::name) == Studies().end())
                            FindExperiment(name);
                        int worst = 0;
                        for (const std::string& name : told->names) {
                          Told one = *told;
                          if (told->names.size() > 1) one.out /= name;
                          worst = std::max(worst, RunNamed(name, one));
                          if (worst == kStopped) break;
                        }
                        return worst;
                      }});

  CLI::App* report = app.add_subcommand("report", "Writes the report on logs anew");
  report->footer("Example: pliant report out/logs/*.mcap --out report");
  report->add_option("logs", told->logs, "of the runs of one experiment")->required();
  report->add_option("--out", told->out, "folder of the report, made if it is not there")
      ->required()
      ->check(SaysSomething());
  report->add_flag("--force", told->force, "write over a report that is there");
  report->add_flag("--strict", told->strict, "exit with 1 if a claim fails");
  commands.push_back({report, [told] {
                        RefuseToOverwrite(told->out, told->force);
                        return ReportOnLogs({told->logs.begin(), told->logs.end()}, *told);
                      }});

  CLI::App* schema =
      app.add_subcommand("schema", "Prints the JSON Schema of scenario files, for editors");
  schema->footer("Example: pliant schema > pliant.schema.json");
  commands.push_back({schema, [] {
                        std::fputs(ExperimentSchema().c_str(), stdout);
                        return 0;
                      }});
}

}  // namespace pliant
