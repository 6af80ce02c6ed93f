#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "pliant/analysis/replay.h"
#include "pliant/analysis/run_data.h"
#include "pliant/apps/commands.h"

namespace pliant {

namespace {

struct Told {
  std::string log, part = "control";
};

int ReplayLog(const Told& told) {
  const RunData run = RunData::Read(told.log);
  const ReplayResult result =
      Replay(std::move(ScenarioDiagram(run.scenario).builder), told.part, run.log);
  std::fputs(result.text().c_str(), stdout);
  return result.identical() ? 0 : 1;
}

}  // namespace

void AddLogCommands(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* replay = app.add_subcommand(
      "replay", "Runs a part of the diagram on a log in the place of the arm, and compares");
  replay->footer("Example: pliant replay out/logs/stiff.mcap --part control.observer");
  replay->add_option("log", told->log, "of a run")->required();
  replay->add_option("--part", told->part, "path of a block")->capture_default_str();
  commands.push_back({replay, [told] { return ReplayLog(*told); }});
}

}  // namespace pliant
