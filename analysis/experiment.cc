#include "pliant/analysis/experiment.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "pliant/analysis/parameter_schema.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

constexpr std::size_t kLongestName = 100;  // with "-99999.mcap.part" a file still bears it

/// Takes the names of what would be recorded, and nothing else.
class NamesOnly final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    for (RecordedValue& value : values) {
      const Eigen::MatrixXd none(value.elements.size(), 0);
      signals.push_back({std::move(value), {}, none});
    }
    return 0;
  }
  std::span<double> Begin(int, std::int64_t) noexcept override { return {}; }
  void Commit() noexcept override {}

  std::vector<RecordedSignal> signals;
};

Experiment Filled(const std::string& text, const std::string& source, const Overrides& set,
                  const RunOf* run) {
  ParameterFile file = ParameterFile::ReadText(text, source);
  for (const auto& [path, yaml] : set) file.Set(path, yaml, "--set " + path + "=" + yaml);
  if (run)
    for (const auto& [path, yaml] : run->set)
      file.Set(path, yaml, source + ": run '" + run->name + "', " + path + ": " + yaml);
  Experiment experiment;
  file.Fill(experiment);
  return experiment;
}

void CheckRunNames(const std::vector<RunOf>& runs) {
  std::set<std::string> names;
  for (const RunOf& run : runs) {
    const bool fit = std::ranges::all_of(
        run.name, [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
    Require(fit, "the name of a run, which names its log, has letters, digits, '_' and '-'",
            "'" + run.name + "'");
    Require(run.name.size() <= kLongestName,
            "the name of a run has at most " + Text(kLongestName) + " letters", run.name.size());
    Require(names.insert(run.name).second, "two runs are named '" + run.name + "'");
  }
}

/// A run and what its log will hold, before there is one.
struct Planned {
  std::string name;
  Scenario scenario;
  Recording recorded;
};

const Planned& Find(const std::string& name, const std::vector<Planned>& runs) {
  const auto found = std::ranges::find(runs, name, &Planned::name);
  if (found != runs.end()) return *found;
  std::vector<std::string> names;
  for (const Planned& run : runs) names.push_back(run.name);
  throw Error("there is no run '" + name + "'" + DidYouMean(name, names));
}

/// What a claim or a figure names must be there, and give sense.
template <class Part>
void Check(const Part& part, const std::vector<Planned>& runs) {
  if constexpr (requires { part.run; }) {
    const Planned& run = Find(part.run, runs);
    if constexpr (requires { part.RequireFits(run.scenario); }) part.RequireFits(run.scenario);
    if constexpr (requires { part.signal; }) part.RequireSound(run.recorded[part.signal]);
  }
  if constexpr (requires { part.runs; })
    for (const std::string& name : part.runs) {
      const Planned& run = Find(name, runs);
      if constexpr (requires { part.signals; })
        for (const std::string& signal : part.signals) run.recorded[signal];
    }
  if constexpr (requires { part.behind_observer; })
    for (const auto* names : {&part.behind_observer, &part.as_if_static})
      for (const std::string& name : *names) Find(name, runs);
}

template <class Part>
void CheckAt(const std::string& where, const Part& part, const std::vector<Planned>& runs) {
  try {
    Check(part, runs);
  } catch (const Error& e) {
    throw Error(where + ": " + e.what());
  }
}

template <class Figure>
std::string NameOf(const Figure& figure) {
  if constexpr (requires { figure.name; })
    return figure.name;
  else
    return Figure::kName;
}

void CheckParts(const Experiment& experiment, const std::vector<Planned>& runs) {
  std::set<std::string> ids, figures;
  for (const ClaimCheck& check : experiment.claims)
    std::visit(
        [&](const auto& of) {
          const std::string where = "claim '" + of.claim.id + "'";
          Require(ids.insert(of.claim.id).second, where + ": there are two of that id");
          CheckAt(where, of, runs);
        },
        check);
  for (const FigureOf& figure : experiment.figures)
    std::visit(
        [&](const auto& of) {
          const std::string where = "figure '" + NameOf(of) + "'";
          Require(figures.insert(NameOf(of)).second, where + ": there are two of that name");
          CheckAt(where, of, runs);
        },
        figure);
}

}  // namespace

ExperimentFile ExperimentFile::ReadText(const std::string& text, const std::string& source,
                                        const Overrides& set) {
  ExperimentFile file{.experiment = Filled(text, source, set, nullptr), .scenarios = {}};
  std::vector<RunOf>& runs = file.experiment.runs;
  if (runs.empty()) runs.push_back({.name = "run", .title = file.experiment.title});
  std::string at = source;
  try {
    CheckRunNames(runs);
    std::vector<Planned> planned;
    for (const RunOf& run : runs) {
      at = source + ": run '" + run.name + "'";
      const auto names = std::make_shared<NamesOnly>();
      const Experiment changed = Filled(text, source, set, &run);
      file.scenarios.push_back(changed.scenario);
      ScenarioDiagram(changed.scenario, names).builder.Build();
      planned.push_back({run.name, changed.scenario, Recording(names->signals, {})});
    }
    at = source;
    CheckParts(file.experiment, planned);
  } catch (const Error& e) {
    const std::string_view what = e.what();
    throw what.starts_with(source) || what.starts_with("--set") ? e : Error(at + ": " + e.what());
  }
  return file;
}

ExperimentFile ExperimentFile::Read(const std::filesystem::path& file, const Overrides& set) {
  return ReadText(ParameterFile::TextOf(file), file.string(), set);
}

std::string ExperimentFile::text() const { return ParametersText(experiment); }

std::vector<NamedExperiment> Experiments() {
  std::vector<NamedExperiment> all;
  for (const auto& entry : std::filesystem::directory_iterator(SharedFile("experiments")))
    if (entry.path().extension() == ".yaml")
      all.push_back({entry.path().stem().string(),
                     ParameterFile::Read(entry.path())["title"].text(), entry.path()});
  std::ranges::sort(all, {}, &NamedExperiment::name);
  return all;
}

NamedExperiment FindExperiment(std::string_view name) {
  const std::vector<NamedExperiment> all = Experiments();
  const auto found = std::ranges::find(all, name, &NamedExperiment::name);
  if (found != all.end()) return *found;
  std::vector<std::string> names;
  for (const NamedExperiment& e : all) names.push_back(e.name);
  throw Error("there is no experiment '" + std::string(name) + "'" + DidYouMean(name, names) +
              "\n`pliant experiment list` names them");
}

std::string ExperimentSchema() {
  internal::Json schema = internal::SchemaOfStruct<Experiment>();
  internal::Json all{{"$schema", "http://json-schema.org/draft-07/schema#"},
                     {"title", "An experiment of pliant"}};
  all.update(schema);
  return all.dump(2) + "\n";
}

}  // namespace pliant
