#include "pliant/apps/graph_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/diagram_files.h"
#include "pliant/analysis/experiment.h"
#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/recorded_names.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/write_file.h"
#include "pliant/apps/says_something.h"
#include "pliant/apps/set_option.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/tick_cost.h"

namespace pliant {

namespace {

namespace fs = std::filesystem;

struct Told {
  fs::path file, out;
  std::vector<std::string> set;
  std::string run;
  int depth = 0;  // 0: not asked for
  bool time = false, inputs = false, all = false, force = false;
};

/// What is to be drawn.
struct Subject {
  Scenario scenario;
  std::string title;
  std::map<std::string, double> costs;
};

bool IsLog(const fs::path& file) { return file.extension() == ".mcap"; }

Subject SubjectOf(const ExperimentFile& file, const std::string& run) {
  const std::vector<RunOf>& runs = file.experiment.runs;
  std::vector<std::string> names;
  std::string known;
  for (const RunOf& one : runs) {
    names.push_back(one.name);
    known += (known.empty() ? "" : ", ") + one.name;
  }
  Require(!run.empty() || runs.size() == 1,
          "the file has several runs; name one with --run: " + known);
  const auto chosen = run.empty() ? names.begin() : std::ranges::find(names, run);
  if (chosen == names.end())
    throw Error("--run: there is no run '" + run + "'" + DidYouMean(run, names) +
                "\n  known: " + known);
  const auto place = static_cast<std::size_t>(chosen - names.begin());
  return {.scenario = file.scenarios[place],
          .title = Printable(file.experiment.title) +
                   (runs.size() > 1 ? ": " + Printable(runs[place].title) : ""),
          .costs = {}};
}

/// [s] At a tick, by block, as estimated before a run on an arm; empty of other runs.
std::map<std::string, double> CostsIn(const fs::path& log) {
  std::map<std::string, double> costs;
  const McapReader reader(log);
  const auto words = reader.metadata().find("pliant.costs");
  if (words == reader.metadata().end()) return costs;
  for (const auto& [block, text] : words->second)
    std::from_chars(text.data(), text.data() + text.size(), costs[block]);
  return costs;
}

Subject SubjectOf(const Told& told) {
  if (!IsLog(told.file))
    return SubjectOf(ExperimentFile::Read(told.file, OverridesOf(told.set)), told.run);
  Require(told.set.empty() && told.run.empty(),
          "--set and --run are about a scenario file, and a log is what one run was");
  const RunHeading log = RunHeading::Read(told.file);
  Subject subject = SubjectOf(
      ExperimentFile::ReadText(log.experiment, told.file.string() + ": experiment"), log.name);
  subject.costs = CostsIn(told.file);
  if (subject.costs.empty() && !told.time)
    std::fprintf(stderr,
                 "%s: it holds no costs of blocks, which runs on an arm estimate; --time measures "
                 "them here\n",
                 told.file.c_str());
  return subject;
}

std::string KindOf(const Told& told) {
  if (told.out.empty()) return ".dot";
  const std::string kind = told.out.extension().string();
  constexpr std::array<const char*, 4> kKinds{".svg", ".dot", ".mmd", ".json"};
  if (std::ranges::find(kKinds, kind) == kKinds.end())
    throw Error(told.out.string() + ": expected a file that ends in .svg, .dot, .mmd or .json");
  Require(kind != ".json" || (told.depth == 0 && !told.inputs && !told.all),
          "--depth, --inputs and --all are of pictures; a .json has everything");
  return kind;
}

std::string TextOf(const Diagram& diagram, const std::string& kind, const PictureOptions& options) {
  const DiagramStructure structure = DiagramStructure::Of(diagram);
  if (kind == ".json") return DiagramJson(structure, options);
  return kind == ".mmd" ? MermaidText(structure, options) : GraphvizText(structure, options);
}

int DrawGraph(const Told& told) {
  const std::string kind = KindOf(told);
  if (!told.out.empty()) internal::RequireNewFile(told.out, told.force);
  const Subject subject = SubjectOf(told);
  // As it would run: what is recorded is computed.
  const Diagram diagram =
      ScenarioDiagram(subject.scenario, std::make_shared<RecordedNames>()).builder.Build();
  PictureOptions options{
      .title = subject.title, .inputs = told.inputs, .recorders = told.all, .costs = subject.costs};
  if (told.depth > 0) options.depth = told.depth;
  if (told.time) {
    options.costs.clear();
    for (const TickCost::Block& block : EstimateTickCost(diagram).blocks)
      options.costs[block.path] = block.cost;
  }
  const std::string text = TextOf(diagram, kind, options);
  if (told.out.empty()) {
    std::fputs(text.c_str(), stdout);
    return 0;
  }
  if (told.out.has_parent_path()) internal::MakeDirectory(told.out.parent_path());
  if (kind != ".svg") {
    internal::WriteFile(told.out, text);
    return 0;
  }
  try {
    DrawDiagram(text, told.out);
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
  return 0;
}

}  // namespace

void AddGraph(CLI::App& app, std::vector<Command>& commands) {
  const auto told = std::make_shared<Told>();
  CLI::App* graph = app.add_subcommand("graph", "Draws the diagram of a scenario file or a log");
  graph->footer("Example: pliant graph my_arm.yaml --depth 2 --out my_arm.svg");
  graph->add_option("file", told->file, "scenario, YAML, or the log of a run, .mcap")
      ->required()
      ->check(SaysSomething());
  graph
      ->add_option("--out", told->out,
                   "ends in .svg, .dot (Graphviz), .mmd (Mermaid) or .json; without, Graphviz goes "
                   "to the standard output")
      ->check(SaysSomething());
  graph
      ->add_option("--set", told->set,
                   "path=value in the place of what the file says, such as station.ideal=true")
      ->allow_extra_args(false);
  graph->add_option("--run", told->run, "which of the file's runs")->check(SaysSomething());
  graph
      ->add_option("--depth", told->depth,
                   "composites that deep are one box; 1: only what is outermost")
      ->check(CLI::Range(1, 1000));
  graph->add_flag("--time", told->time, "measure what each block costs at a tick, here and now");
  graph->add_flag("--inputs", told->inputs, "show inputs that are not wired, too");
  graph->add_flag("--all", told->all, "show recorders and their wires, too");
  graph->add_flag("--force", told->force, "write over a file that is there");
  commands.push_back({graph, [told] { return DrawGraph(*told); }});
}

}  // namespace pliant
