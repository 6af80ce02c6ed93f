#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/run_experiment.h"
#include "pliant/analysis/run_sweep.h"
#include "pliant/apps/commands.h"
#include "pliant/apps/progress_line.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/set_option.h"
#include "pliant/apps/stop_signals.h"
#include "pliant/plants/parameter_text.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

constexpr int kStopped = 130, kIncomplete = 3;

/// What `sweep`, `merge` and `rerun` are given.
struct Arguments {
  std::string file, run, shard;
  std::vector<std::string> set, over;
  std::vector<fs::path> directories;
  fs::path folder, out;
  std::uint64_t runs = 0, index = 0;
  int jobs = 1;
  bool force = false, check = false;
};

void Say(const std::string& line) { std::fprintf(stderr, "%s\n", Printable(line).c_str()); }

std::string Count(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// Writes tables and report, and says what is in them; the exit code.
int WriteAndTell(const SweepResults& results, const fs::path& out) {
  try {
    WriteSweepTables(results, out);
    WriteReport(ReportOf(results), out);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  const std::size_t failures = results.failures();
  std::printf("%s%s\n", Count(results.rows.size(), "run").c_str(),
              failures > 0 ? (", of which " + std::to_string(failures) + " failed").c_str() : "");
  for (const char* name : {"results.csv", "results.h5", "report.html"})
    std::printf("%s\n", (fs::absolute(out) / name).lexically_normal().c_str());
  if (failures < std::max<std::size_t>(results.rows.size(), 1)) return 0;
  Say("every run failed; the first says: " + results.rows.front().failed);
  return kIncomplete;
}

/// Says which runs are not there, and which are there twice.
void TellOfGaps(const SweepResults& results) {
  constexpr std::size_t kShown = 10;
  if (!results.whole()) {
    std::string list;
    const auto gaps = results.missing();
    for (std::size_t i = 0; i < gaps.size() && i < kShown; ++i) {
      const auto& [from, to] = gaps[i];
      list += (i ? ", " : "") + std::to_string(from) + (to > from ? "-" + std::to_string(to) : "");
    }
    Say(std::to_string(results.sweep.runs() - results.rows.size()) + " of " +
        Count(results.sweep.runs(), "run") + " are missing: " + list +
        (gaps.size() > kShown ? ", …" : "") + "; `pliant sweep` makes them");
  }
  if (!results.repeated.empty())
    Say(Count(results.repeated.size(), "run") +
        " are there more than once, the same each time; "
        "the first is run " +
        std::to_string(results.repeated.front()));
}

int RunFile(const Arguments& given) {
  const Overrides set = OverridesOf(given.set);
  for (const auto& [path, yaml] : set)
    for (const std::string& over : given.over)
      Require(!LiesIn(path, SweptValue(over).path()),
              "--set " + path + "=" + yaml + ": --over sweeps it too, and would have its way");
  const Sweep sweep(ExperimentFile::Read(given.file, set), given.run, given.over, given.runs);
  const Shard shard = given.shard.empty() ? Shard::OfEnvironment() : Shard::Read(given.shard);
  if (given.check) {
    std::printf("%s: %s of %s, nothing is wrong\n", given.file.c_str(),
                Count(sweep.runs(), "run").c_str(), Count(sweep.cells(), "cell").c_str());
    return 0;
  }
  Require(!given.out.empty(), "--out is required: the folder of parts and results");
  if (shard.of == 1) try {
      RequireGnuplot();
    } catch (const Error& e) {
      throw CannotGoOn(e.what());
    }
  else
    Say("part " + std::to_string(shard.number) + " of " + std::to_string(shard.of) + ", says " +
        shard.from);

  const StopSignals signals;
  ProgressLine line;
  const double duration = sweep.experiment().scenario.duration_s;
  const auto progress = [&](std::uint64_t made, std::uint64_t of, std::uint64_t failed,
                            double wall_s) {
    line(std::to_string(made) + " of " + Count(of, "run") +
             (failed > 0 ? ", " + std::to_string(failed) + " failed" : ""),
         duration * static_cast<double>(made), duration * static_cast<double>(of), wall_s);
  };
  const SweepResults results = [&] {
    try {
      return RunSweep(sweep, {.out = given.out,
                              .jobs = given.jobs,
                              .shard = shard,
                              .progress = progress,
                              .stop = &StopSignals::requested,
                              .say = Say});
    } catch (const FailedRun& e) {
      line.End();
      throw CannotGoOn(e.what());
    }
  }();
  line.End();
  if (StopSignals::requested && !results.whole()) {
    Say("stopped; " + std::to_string(results.rows.size()) + " of " + Count(sweep.runs(), "run") +
        " are made and kept, and the same command goes on with the others");
    return kStopped;
  }
  if (shard.of > 1) {
    Say("`pliant merge` joins the parts in " + given.out.string() + " when all are made");
    return 0;
  }
  TellOfGaps(results);
  return WriteAndTell(results, given.out);
}

int Merge(const Arguments& given) {
  const fs::path out = given.out.empty() ? given.directories.front() : given.out;
  const SweepResults results = ReadSweep(given.directories);
  // Beside its parts a result may be made anew at any time.
  const bool beside = std::ranges::any_of(given.directories, [&](const fs::path& directory) {
    std::error_code none;
    return fs::equivalent(directory, out, none);
  });
  for (const char* name : {"results.csv", "results.h5", "report.html", "verdict.json"})
    if (std::error_code unknown; !beside && !given.force && fs::exists(out / name, unknown))
      throw Error((out / name).string() +
                  " exists; give --force to write over it, or another --out");
  for (const std::string& line : results.told) Say(line);
  TellOfGaps(results);
  const int code = WriteAndTell(results, out);
  return results.whole() && results.repeated.empty() ? code : kIncomplete;
}

int Rerun(const Arguments& given) {
  const SweepResults results = ReadSweep({given.folder});
  const Sweep& sweep = results.sweep;
  Require(given.index < sweep.runs(), "the sweep has runs 0 to " + Text(sweep.runs() - 1),
          given.index);
  const fs::path report = given.out / "report.html";
  if (std::error_code unknown; !given.force && fs::exists(report, unknown))
    throw Error(report.string() + " exists; give --force to write over it, or another --out");
  const ExperimentFile file = sweep.FileOf(given.index);
  std::vector<fs::path> logs;
  {
    const StopSignals signals;
    ProgressLine line;
    try {
      logs = RunExperiment(file, {.out = given.out,
                                  .force = given.force,
                                  .progress = std::ref(line),
                                  .stop = &StopSignals::requested});
    } catch (const FailedRun& e) {
      line.End();
      throw CannotGoOn(e.what());
    }
    if (StopSignals::requested) return kStopped;
  }
  const RunsReport of = ReportOf(logs);
  WriteReport(of.report, of.runs(), given.out);

  const RunData& run = *of.kept.front();
  SweepRow row{.run = given.index, .random = sweep.RandomValuesOf(given.index), .ended = run.ended};
  sweep.Measure(run.log, row);
  for (std::size_t i = 0; i < row.numbers.size(); ++i)
    std::printf("%s: %s %s\n", sweep.numbers()[i].name.c_str(),
                internal::YamlText(row.numbers[i]).c_str(), sweep.units()[i].c_str());
  std::printf("log: %s\nreport: %s\n", logs.front().c_str(),
              (fs::absolute(given.out) / "report.html").lexically_normal().c_str());
  const auto stored = std::ranges::find(results.rows, given.index, &SweepRow::run);
  if (stored == results.rows.end()) {
    std::printf("the parts do not have this run yet\n");
    return 0;
  }
  const bool same = row == *stored;
  std::printf("%s\n",
              same ? "the same as in the part, bit for bit"
                   : ("NOT the same as in the part: " + sweep.DifferenceOf(row, *stored)).c_str());
  if (!same && sweep.made_with() != Sweep::MadeWithHere())
    Say("the part was made with pliant " + sweep.made_with() + "; this is pliant " +
        Sweep::MadeWithHere());
  return same ? 0 : 1;
}

}  // namespace

void AddSweepCommands(CLI::App& app, std::vector<Command>& commands) {
  const auto given = std::make_shared<Arguments>();

  CLI::App* sweep =
      app.add_subcommand("sweep", "Makes many runs of a scenario file and measures their numbers");
  sweep->footer(
      "Example: pliant sweep my_arm.yaml --over controller.posture.compliance=0:1:3 --runs 6 --out "
      "out/sweep\n"
      "Values: a,b,c   from:to:count   from:to:count:log   uniform(a,b)   normal(mean,sigma)\n"
      "Lists make a grid, whose cells the runs take in turn. Runs that are there are not made "
      "again.");
  sweep->add_option("file", given->file, "scenario with 'numbers', YAML")
      ->required()
      ->check(SaysSomething());
  sweep->add_option("--over", given->over, "path=values, such as payload.mass=0.5:2:4")
      ->allow_extra_args(false);
  sweep->add_option("--runs", given->runs, "how many; as many as the grid has cells, if not given")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000}));
  sweep->add_option("--out", given->out, "folder of parts and results, made if it is not there")
      ->check(SaysSomething());
  sweep->add_option("--jobs", given->jobs, "runs at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  sweep
      ->add_option("--shard", given->shard,
                   "i/N: every N-th run, from the i-th on; else what mpirun, srun or a Slurm array "
                   "say")
      ->check(SaysSomething());
  sweep->add_option("--run", given->run, "which of the file's runs, if it has several")
      ->check(SaysSomething());
  sweep
      ->add_option("--set", given->set,
                   "path=value in the place of what the file says, such as station.ideal=true")
      ->allow_extra_args(false);
  sweep->add_flag("--check", given->check, "only says whether it can be swept; needs no --out");
  commands.push_back({sweep, [given] { return RunFile(*given); }});

  CLI::App* merge = app.add_subcommand(
      "merge",
      "Joins the parts of a sweep into tables and a report; ends with 3 if runs are missing");
  merge->footer("Example: pliant merge out/sweep --out out/merged");
  merge->add_option("folders", given->directories, "with parts of one sweep")->required();
  merge
      ->add_option("--out", given->out,
                   "folder of the results; the first of the others, if not given")
      ->check(SaysSomething());
  merge->add_flag("--force", given->force, "write over results that are there");
  commands.push_back({merge, [given] { return Merge(*given); }});

  CLI::App* rerun =
      app.add_subcommand("rerun", "Makes one run of a sweep again, with a log and a report");
  rerun->footer("Example: pliant rerun out/sweep 5 --out out/again");
  rerun->add_option("folder", given->folder, "with parts of a sweep")->required();
  rerun->add_option("index", given->index, "of the run, from 0")
      ->required()
      ->check(CLI::Range(0, 999'999'999));
  rerun->add_option("--out", given->out, "folder of log and report, made if it is not there")
      ->required()
      ->check(SaysSomething());
  rerun->add_flag("--force", given->force, "write over a log and a report that are there");
  commands.push_back({rerun, [given] { return Rerun(*given); }});
}

}  // namespace pliant
