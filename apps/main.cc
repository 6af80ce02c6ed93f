#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/report.h"
#include "pliant/systems/error.h"

namespace {

/// A line that is written over on a terminal; elsewhere a line for each phase's end.
class ProgressLine {
 public:
  void operator()(const std::string& phase, double done_s, double total_s, double wall_s) {
    const bool terminal = isatty(STDERR_FILENO) != 0;
    const bool end = done_s >= total_s;
    if (!terminal && !end) return;
    std::fprintf(stderr, "%s%-28s %5.1f of %.1f s, %5.1f x real time%s", terminal ? "\r" : "",
                 phase.c_str(), done_s, total_s, wall_s > 0 ? done_s / wall_s : 0, end ? "\n" : "");
    std::fflush(stderr);
  }
};

int ListExperiments() {
  for (const pliant::Experiment& e : pliant::Experiments())
    std::printf("%-24s %s\n", e.name.c_str(), e.summary.c_str());
  return 0;
}

int RunExperiment(const pliant::Experiment& experiment, const pliant::ExperimentOptions& options,
                  const std::filesystem::path& out, bool strict) {
  const pliant::Report report = experiment.run(options, ProgressLine{});
  pliant::WriteReport(report, out);
  bool all = true;
  for (const pliant::Claim& claim : report.claims) {
    std::printf("%-8s %s: %s\n", claim.holds ? "holds" : "FAILS", claim.id.c_str(),
                claim.measured.c_str());
    all = all && claim.holds;
  }
  std::printf("report: %s\n",
              (std::filesystem::absolute(out) / "report.html").lexically_normal().c_str());
  return strict && !all ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Torque control of robot arms as diagrams of blocks", "pliant"};
  app.set_version_flag("--version", PLIANT_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 it ran, 1 a claim fails (--strict), 2 wrong use or input, 3 it could not go "
      "on.\n"
      "Example: pliant experiment run null-space-compliance --out out");

  CLI::App* experiments = app.add_subcommand("experiment", "Experiments of the papers, simulated");
  experiments->require_subcommand(1);
  CLI::App* list = experiments->add_subcommand("list", "Names them");
  CLI::App* run = experiments->add_subcommand("run", "Runs one and writes its report");
  run->footer("Example: pliant experiment run null-space-compliance --out out");
  std::string name;
  std::filesystem::path out = "out";
  bool strict = false;
  run->add_option("name", name, "of the experiment")->required();
  run->add_option("--out", out, "folder of the report, made if it is not there")
      ->capture_default_str();
  pliant::ExperimentOptions options;
  run->add_flag("--ideal", options.ideal,
                "torque sources and sensors without error: no motors, friction, gears, noise");
  run->add_flag("--strict", strict, "exit with 1 if a claim fails");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  int on_error = 2;
  try {
    if (*list) return ListExperiments();
    const pliant::Experiment& experiment = pliant::FindExperiment(name);
    std::filesystem::create_directories(out);
    on_error = 3;
    return RunExperiment(experiment, options, out, strict);
  } catch (const std::exception& e) {
    std::cerr << "pliant: " << e.what() << '\n';
    return on_error;
  }
}
