#include "pliant/analysis/experiment.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <ranges>
#include <set>
#include <string_view>
#include <type_traits>

#include "pliant/analysis/recorded_names.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

/// Where a file of identified friction may stand instead of what it says.
constexpr std::array<std::string_view, 2> kFrictions{"station.friction", "assumed_friction"};
constexpr std::string_view kActuators = "station.actuators", kRobot = "robot";

/// The friction that a file says, so that a log needs no other file.
std::string FrictionIn(const std::filesystem::path& file) {
  const ParameterFile read = ParameterFile::Read(file);
  FrictionFile friction;
  read.Fill(friction);
  return read["joints"].yaml();
}

/// The actuators that a file says, as a scenario says them.
std::string ActuatorsIn(const std::filesystem::path& file, const std::string& robot) {
  Scenario scenario;
  scenario.robot = robot;
  const Joints joints = RobotOf(scenario).joints();
  const ArmActuators arm = ArmActuators::Read(file, joints);
  StationActuators actuators{.transmission = arm.transmission, .friction = arm.friction};
  for (int j = 0; j < joints.size(); ++j)
    actuators.joints.push_back({joints[j], arm.joint[static_cast<std::size_t>(j)]});
  return ParametersText(actuators);
}

/// The robot that a URDF file says, its text.
std::string RobotIn(const std::filesystem::path& file) {
  RobotModel::FromUrdf(file);  // with the file and the line of what is wrong
  return internal::YamlText(ParameterFile::TextOf(file));
}

/// What stands in the place of the name of a file, so that a log needs no other file. A path is
/// relative to `directory`.
std::string WithFile(std::string_view key, const std::string& yaml,
                     const std::filesystem::path& directory, const std::string& robot) {
  const auto named = [&] {
    return directory / ParameterFile::ReadText(yaml, std::string(key)).text();
  };
  const bool is_word = yaml.find_first_of("[{<~") == std::string::npos && yaml != "null";
  if (is_word && std::ranges::find(kFrictions, key) != kFrictions.end()) return FrictionIn(named());
  if (is_word && key == kActuators) return ActuatorsIn(named(), robot);
  if (is_word && key == kRobot && named().extension() == ".urdf") return RobotIn(named());
  return yaml;
}

/// A place in a file, if it is there.
std::optional<ParameterFile> PlaceAt(const ParameterFile& file, std::string_view path) {
  std::optional<ParameterFile> place = file;
  for (const auto key : std::views::split(path, '.'))
    if (place) place = place->Find(std::string_view(key.begin(), key.end()));
  return place;
}

/// A file, and what is put in the place of what it says.
class Changed {
 public:
  Changed(const std::string& text, const std::string& source)
      : source_{source},
        beside_{std::filesystem::path(source).parent_path()},
        file_{ParameterFile::ReadText(text, source)} {}

  Experiment Filled(const Overrides& set, const RunOf* run) {
    // The others may be about its joints.
    const auto of_robot = [](const auto& change) { return change.first == kRobot; };
    if (std::ranges::none_of(set, of_robot)) ReadFileAt(kRobot);
    for (const auto& [path, yaml] : set)
      if (path == kRobot) Set(path, yaml);
    for (const std::string_view key : {kFrictions[0], kFrictions[1], kActuators}) ReadFileAt(key);
    for (const auto& [path, yaml] : set)
      if (path != kRobot) Set(path, yaml);
    if (run)
      for (const auto& [path, yaml] : run->set)
        file_.Set(path, WithFile(path, yaml, beside_, robot()),
                  source_ + ": run '" + run->name + "', " + path + ": " + yaml);
    Experiment experiment;
    file_.Fill(experiment);
    return experiment;
  }

 private:
  std::string robot() const {
    const auto place = PlaceAt(file_, kRobot);
    return place ? place->text() : "";
  }

  void ReadFileAt(std::string_view key) {
    const auto place = PlaceAt(file_, key);
    if (!place) return;
    const auto read = [&] {
      file_.Set(std::string(key), WithFile(key, place->yaml(), beside_, robot()), source_);
    };
    if (key != kRobot && key != kActuators) return read();
    try {
      read();
    } catch (const Error& e) {
      place->Fail(e.what());
    }
  }

  void Set(const std::string& path, const std::string& yaml) {
    const std::string source = "--set " + path + "=" + yaml;
    if (path != kRobot && path != kActuators)
      return file_.Set(path, WithFile(path, yaml, {}, robot()), source);
    std::string with;
    try {
      with = WithFile(path, yaml, {}, robot());
    } catch (const Error& e) {
      throw Error(source + ": " + e.what());
    }
    file_.Set(path, with, source);
  }

  const std::string source_;
  const std::filesystem::path beside_;
  ParameterFile file_;
};

Experiment Filled(const std::string& text, const std::string& source, const Overrides& set,
                  const RunOf* run) {
  return Changed(text, source).Filled(set, run);
}

bool IsOfAName(unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; }

constexpr std::size_t kLongestName = 100;  // and of its log, with a number and a suffix

void CheckRunNames(const std::vector<RunOf>& runs) {
  std::set<std::string> names;
  for (const RunOf& run : runs) {
    Require(std::ranges::all_of(run.name, IsOfAName),
            "the name of a run, which names its log, has letters, digits, '_' and '-'",
            "'" + run.name + "'");
    Require(run.name.size() <= kLongestName,
            "the name of a run has at most " + Text(kLongestName) + " letters", run.name.size());
    Require(names.insert(run.name).second, "two runs are named '" + run.name + "'");
  }
}

/// What is known of a run before it is run.
struct KnownRun {
  std::string name;
  Scenario scenario;
  Recording recorded;  // what it will record, without rows
};

/// Puts the place in front of what is wrong.
template <class Check>
void At(const std::string& where, const Check& check) {
  try {
    check();
  } catch (const Error& e) {
    throw Error(where + ": " + e.what());
  }
}

class NamesCheck {
 public:
  explicit NamesCheck(const std::vector<KnownRun>& runs) : runs_{runs} {
    for (const KnownRun& run : runs) names_.push_back(run.name);
  }

  void operator()(const Experiment& experiment) const {
    std::set<std::string> ids, figures;
    for (const ClaimCheck& check : experiment.claims)
      std::visit(
          [&](const auto& of) {
            const std::string where = "claim '" + of.claim.id + "'";
            Require(ids.insert(of.claim.id).second, where + ": there are two of that id");
            At(where, [&] { CheckPart(of); });
          },
          check);
    for (const FigureOf& figure : experiment.figures)
      std::visit(
          [&](const auto& of) {
            const std::string where = "figure !" + std::string(of.kTag);
            At(where, [&] { CheckPart(of); });
            Require(figures.insert(of.file()).second,
                    where + ": there are two figures named '" + of.file() + "'");
          },
          figure);
    for (const NumberTable& table : experiment.tables)
      At("table '" + table.title + "'", [&] { CheckPart(table); });
    std::set<std::string> numbers;
    for (const NamedNumber& number : experiment.numbers)
      At("number '" + number.name + "'", [&] {
        Require(numbers.insert(number.name).second, "there are two of that name");
        CheckNumber(number);
      });
  }

 private:
  void CheckNumber(const NamedNumber& number) const {
    Require(std::ranges::all_of(number.name, IsOfAName),
            "the name of a number, which names its column, has letters, digits, '_' and '-'");
    for (const KnownRun& run : runs_) {
      number.number.RequireSound(run.recorded[number.number.signal]);
      number.number.RequireFit(run.scenario);
    }
  }

  const KnownRun& Run(const std::string& name) const {
    const auto found = std::ranges::find(runs_, name, &KnownRun::name);
    if (found == runs_.end())
      throw Error("there is no run '" + name + "'" + DidYouMean(name, names_));
    return *found;
  }

  /// What a claim or a figure names must be there, in the runs it is about.
  template <class Part>
  void CheckPart(const Part& part) const {
    std::vector<std::string> runs;
    const auto about = [&](const std::vector<std::string>& more) {
      runs.insert(runs.end(), more.begin(), more.end());
    };
    if constexpr (requires { part.run; }) about({part.run});
    if constexpr (requires { part.runs; }) about(part.runs);
    if constexpr (requires { part.than; }) about({part.than});
    if constexpr (requires { part.to; }) about({part.to});
    if constexpr (requires { part.others; }) about(part.others);
    if constexpr (requires { part.behind_observer; }) {
      about(part.behind_observer);
      about(part.as_if_static);
    }
    if constexpr (std::is_same_v<Part, KeepsLimits>) about(names_);
    Require(!runs.empty(), "it is about no run");
    for (const std::string& name : runs) {
      const KnownRun& run = Run(name);
      if constexpr (requires { part.number; }) part.RequireSound(run.recorded[part.number.signal]);
      if constexpr (requires { part.RequireSound(run.recorded); }) part.RequireSound(run.recorded);
      if constexpr (requires { part.signals; }) {
        Require(!part.signals.empty(), "it shows no signal");
        for (const std::string& signal : part.signals) run.recorded[signal];
      }
      if constexpr (requires { part.RequireFit(run.scenario); }) part.RequireFit(run.scenario);
    }
  }

  const std::vector<KnownRun>& runs_;
  std::vector<std::string> names_;
};

/// The keys of a scenario, which a run may change.
void CheckChanges(const RunOf& run) {
  std::vector<std::string> known;
  Scenario{}.Parameters([&](std::string_view name, auto&, std::string_view = {},
                            const Range& = kAnyNumber) { known.emplace_back(name); });
  std::vector<std::string> others;
  Experiment{}.Parameters(
      [&](std::string_view name, auto&, std::string_view = {}, const Range& = kAnyNumber) {
        if (std::ranges::find(known, name) == known.end()) others.emplace_back(name);
      });
  for (const auto& [path, yaml] : run.set)
    Require(std::ranges::find(others, path.substr(0, path.find('.'))) == others.end(),
            "a run changes its scenario only, not '" + path + "'");
  const auto of_robot = [](const auto& change) { return change.first == "robot"; };
  Require(std::ranges::none_of(run.set, of_robot), "all runs of an experiment have one robot");
}

}  // namespace

void RequireRepetitions(const Experiment& experiment, int repetitions) {
  for (const ClaimCheck& check : experiment.claims)
    std::visit(
        [&](const auto& of) {
          if constexpr (requires { of.RequireRepetitions(repetitions); })
            At("claim '" + of.claim.id + "'", [&] { of.RequireRepetitions(repetitions); });
        },
        check);
}

ExperimentFile ExperimentFile::ReadText(const std::string& text, const std::string& source,
                                        const Overrides& set) {
  ExperimentFile file{.experiment = Filled(text, source, set, nullptr), .scenarios = {}};
  std::vector<RunOf>& runs = file.experiment.runs;
  if (runs.empty()) runs.push_back({.name = "run", .title = file.experiment.title});
  std::string at = source;
  try {
    CheckRunNames(runs);
    std::vector<KnownRun> known;
    for (const RunOf& run : runs) {
      at = source + ": run '" + run.name + "'";
      CheckChanges(run);
      for (const auto& [path, yaml] : set)
        if (std::ranges::find(run.set, path, &Overrides::value_type::first) != run.set.end())
          throw Error("--set " + path + "=" + yaml + ": run '" + run.name +
                      "' sets it too, and would have its way");
      const auto names = std::make_shared<RecordedNames>();
      const Experiment changed = Filled(text, source, set, &run);
      file.scenarios.push_back(changed.scenario);
      ScenarioDiagram(changed.scenario, names).builder.Build();
      known.push_back({run.name, changed.scenario, Recording(names->signals, {})});
    }
    at = source;
    NamesCheck{known}(file.experiment);
    RequireRepetitions(file.experiment, file.experiment.repeat);
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

}  // namespace pliant
