#include "pliant/analysis/sweep.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <set>
#include <utility>

#include "pliant/analysis/advance_run.h"
#include "pliant/analysis/memory_sink.h"
#include "pliant/analysis/printable.h"
#include "pliant/analysis/read_number.h"
#include "pliant/analysis/recorded_names.h"
#include "pliant/analysis/run_log.h"
#include "pliant/plants/parameter_text.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

constexpr double kMostRuns = 1e9;
constexpr std::size_t kLongestCause = 2000, kMostNumbers = 1000;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What the random numbers of a run are for: other ones than those within it.
enum Use : std::uint64_t { kSweep = 500 };

bool AreIdentical(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool AreIdentical(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return AreIdentical(x, y); });
}

/// One run of an experiment, as an experiment of its own that says nothing of others.
Experiment OneOf(const ExperimentFile& file, const std::string& run) {
  const std::vector<RunOf>& runs = file.experiment.runs;
  std::vector<std::string> names;
  for (const RunOf& of : runs) names.push_back(of.name);
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  Require(!run.empty() || runs.size() == 1,
          "the file has " + Text(runs.size()) + " runs; name the one to sweep: " + list);
  const auto found = run.empty() ? names.begin() : std::ranges::find(names, run);
  if (found == names.end()) throw Error("there is no run '" + run + "'" + DidYouMean(run, names));
  Require(file.experiment.repeat == 1,
          "a sweep makes each run once, with a seed of its own: expected no 'repeat', and as many "
          "runs as are wanted",
          file.experiment.repeat);
  return {.title = file.experiment.title,
          .summary = file.experiment.summary,
          .scenario = file.scenarios[static_cast<std::size_t>(found - names.begin())],
          .numbers = file.experiment.numbers};
}

void RequireOfScenario(const SweptValue& swept) {
  std::vector<std::string> known;
  Scenario{}.Parameters([&](std::string_view name, auto&, std::string_view = {},
                            const Range& = kAnyNumber) { known.emplace_back(name); });
  const std::string key = swept.path().substr(0, swept.path().find('.'));
  if (std::ranges::find(known, key) == known.end())
    throw Error("swept " + swept.text() + ": a scenario has no key '" + key + "'" +
                DidYouMean(key, known));
  Require(key != "robot", "swept " + swept.text() + ": all runs of a sweep have one robot");
}

}  // namespace

bool SweepRow::operator==(const SweepRow& other) const {
  return run == other.run && AreIdentical(random, other.random) &&
         AreIdentical(numbers, other.numbers) && ended == other.ended && failed == other.failed;
}

/// What text() says.
struct Sweep::Description {
  std::string version = PLIANT_VERSION, built_with = PLIANT_BUILT_WITH;
  std::uint64_t runs = 0;
  std::vector<std::string> over = {};
  Experiment experiment = {};

  template <class F>
  void Parameters(F&& f) {
    f("version", version);
    f("built_with", built_with);
    f("runs", runs, "", Between(0, kMostRuns));
    f("over", over);
    f("experiment", experiment);
  }
};

Sweep::Sweep(const ExperimentFile& file, const std::string& run,
             const std::vector<std::string>& over, std::uint64_t runs)
    : Sweep(Description{.runs = runs, .over = over, .experiment = OneOf(file, run)}, "sweep") {}

Sweep Sweep::ReadText(const std::string& text, const std::string& source) {
  Description description;
  ParameterFile::ReadText(text, source).Fill(description);
  Sweep sweep(description, source);
  sweep.text_ = text;
  return sweep;
}

Sweep::Sweep(const Description& description, const std::string& source)
    : experiment_{description.experiment},
      made_with_{description.version + ", " + description.built_with},
      scenario_{ParameterFile::ReadText(ParametersText(description.experiment.scenario), source)} {
  Require(ParametersText(description).size() <= kMostText,
          "what is swept may take " + Text(kMostText) +
              " bytes to say; sweep fewer values, or from:to:count",
          ParametersText(description).size());
  // All that is refused of an experiment is refused of one in a file of somebody else.
  ExperimentFile::ReadText(ParametersText(experiment_), source);
  Require(!IsHardware(experiment_.scenario),
          "a sweep simulates, and station !Gen3 is an arm that is there");
  Require(experiment_.numbers.size() <= kMostNumbers && description.over.size() <= kMostNumbers,
          "a sweep has at most " + Text(kMostNumbers) + " numbers, and as many swept values");
  Require(!experiment_.numbers.empty(),
          "there is no number to measure: the file has no 'numbers', a list of {name, title, "
          "signal, statistic, …}");

  std::set<std::string> columns{"run", "ended", "failed", "sweep", "seed"};
  double cells = 1;
  for (const std::string& text : description.over) {
    Add(SweptValue(text));
    columns.insert(over_.back().path());
    cells *= static_cast<double>(std::max<std::size_t>(1, over_.back().values().size()));
  }
  Require(static_cast<double>(description.runs) <= kMostRuns,
          "a sweep has at most " + Text(kMostRuns) + " runs", description.runs);
  Require(cells <= kMostRuns, "a sweep has at most " + Text(kMostRuns) + " cells", cells);
  for (const NamedNumber& number : experiment_.numbers)
    Require(columns.insert(number.name).second,
            "number '" + number.name + "': another column of the results has that name");
  cells_ = static_cast<std::uint64_t>(cells);
  runs_ = description.runs == 0 ? cells_ : description.runs;

  Description all = description;
  all.runs = runs_;
  text_ = ParametersText(all);
  const auto names = std::make_shared<RecordedNames>();
  ScenarioDiagram(experiment_.scenario, names).builder.Build();
  const Recording recorded(names->signals, {});
  for (const NamedNumber& number : experiment_.numbers)
    units_.push_back(number.number.unit(recorded[number.number.signal]));
}

void Sweep::Add(const SweptValue& swept) {
  RequireOfScenario(swept);
  for (const SweptValue& other : over_)
    Require(!LiesIn(swept.path(), other.path()) && !LiesIn(other.path(), swept.path()),
            "swept " + swept.text() + ": " + other.path() +
                " is swept too, and one would hide the other");
  std::vector<std::string> values = swept.values();
  // What is drawn is hardly ever a whole number, even if the mean is one.
  const double mean = swept.mean(), beside = mean + 1e-9 * std::max(1.0, std::abs(mean));
  if (swept.is_random()) values = {internal::YamlText(mean), internal::YamlText(beside)};
  for (const std::string& value : values) {
    ParameterFile changed = scenario_;
    changed.Set(swept.path(), value, "swept " + swept.path() + "=" + value);
    Scenario filled;
    changed.Fill(filled);
    // A word may be the name of what there is not.
    if (!internal::ReadNumber(value)) ScenarioDiagram(filled, nullptr).builder.Build();
  }
  over_.push_back(swept);
  sweeps_seed_ = sweeps_seed_ || swept.path() == "seed";
}

std::string Sweep::MadeWithHere() {
  const Description here;
  return here.version + ", " + here.built_with;
}

RandomStream Sweep::StreamOf(std::uint64_t run) const {
  return RandomStream(experiment_.scenario.seed).Part(kSweep).Part(run);
}

std::vector<std::size_t> Sweep::IndicesOf(std::uint64_t run) const {
  std::vector<std::size_t> indices(over_.size());
  std::uint64_t cell = run % cells_;
  for (std::size_t i = over_.size(); i-- > 0;) {
    const std::size_t count = std::max<std::size_t>(1, over_[i].values().size());
    indices[i] = cell % count;
    cell /= count;
  }
  return indices;
}

std::vector<double> Sweep::RandomValuesOf(std::uint64_t run) const {
  std::vector<double> drawn;
  for (const SweptValue& swept : over_)
    if (swept.is_random()) drawn.push_back(swept.Draw(StreamOf(run).Part(1 + drawn.size())));
  return drawn;
}

std::uint64_t Sweep::SeedOf(std::uint64_t run) const {
  return static_cast<std::uint64_t>(StreamOf(run).Part(0).Uniform(0) * 0x1p53);
}

Scenario Sweep::ScenarioOf(std::uint64_t run) const {
  ParameterFile changed = scenario_;
  if (!sweeps_seed_) changed.Set("seed", std::to_string(SeedOf(run)), "seed");
  const std::vector<std::size_t> indices = IndicesOf(run);
  const std::vector<double> drawn = RandomValuesOf(run);
  std::size_t random = 0;
  for (std::size_t i = 0; i < over_.size(); ++i) {
    const std::string value =
        over_[i].is_random() ? internal::YamlText(drawn[random++]) : over_[i].values()[indices[i]];
    changed.Set(over_[i].path(), value, over_[i].path() + "=" + value);
  }
  Scenario scenario;
  changed.Fill(scenario);
  return scenario;
}

ExperimentFile Sweep::FileOf(std::uint64_t run) const {
  Experiment experiment = experiment_;
  experiment.scenario = ScenarioOf(run);
  experiment.title += ", run " + std::to_string(run) + " of a sweep";
  return ExperimentFile::ReadText(ParametersText(experiment), "run " + std::to_string(run));
}

std::optional<SweepRow> Sweep::Make(std::uint64_t run, const std::atomic<bool>* stop) const {
  SweepRow row{.run = run,
               .random = RandomValuesOf(run),
               .numbers = std::vector<double>(numbers().size(), kNone)};
  try {
    const Scenario scenario = ScenarioOf(run);
    std::vector<std::string> paths;
    for (const NamedNumber& number : numbers()) paths.push_back(number.number.signal);
    const auto sink = std::make_shared<MemorySink>(paths);
    ScenarioDiagram scene(scenario, sink);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    if (!internal::AdvanceInParts(sim, scenario.duration_s, [&] { return !stop || !*stop; }))
      return std::nullopt;
    TickAtEnd(sim, scenario.duration_s, scene.control_period);
    if (const std::optional<Simulator::Ending> ending = sim.ended()) row.ended = ending->text();
    if (sink->is_full()) throw std::bad_alloc();  // no fault of the run
    Measure(sink->recording(), row);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    row.failed = e.what();
  }
  for (std::string* words : {&row.ended, &row.failed}) *words = FirstBytes(*words, kLongestCause);
  return row;
}

void Sweep::RequireOwn(const SweepRow& row, const std::string& where) const {
  const auto random = std::ranges::count_if(over_, &SweptValue::is_random);
  Require(
      row.run < runs_ && std::ssize(row.random) == random && row.numbers.size() == numbers().size(),
      where + ": expected rows of runs 0 to " + Text(runs_ - 1) + ", of " + Text(random) +
          " random values and " + Text(numbers().size()) + " numbers",
      "run " + Text(row.run) + " of " + Text(row.random.size()) + " and " +
          Text(row.numbers.size()));
}

std::string Sweep::DifferenceOf(const SweepRow& a, const SweepRow& b) const {
  if (!AreIdentical(a.random, b.random)) return "the random values";
  for (std::size_t i = 0; i < a.numbers.size(); ++i)
    if (!AreIdentical(a.numbers[i], b.numbers[i]))
      return numbers()[i].name + ", " + internal::YamlText(a.numbers[i]) + " and " +
             internal::YamlText(b.numbers[i]);
  return a.ended != b.ended ? "how it ended" : "why it failed";
}

void Sweep::Measure(const Recording& recording, SweepRow& row) const {
  row.numbers.assign(numbers().size(), kNone);
  for (std::size_t i = 0; i < numbers().size(); ++i) {
    const auto fail = [&](const std::string& why) {
      if (row.failed.empty()) row.failed = numbers()[i].name + why;
    };
    try {
      const double value = numbers()[i].number.Of(recording);
      if (std::isnan(value))
        fail(" is not a number");
      else
        row.numbers[i] = value;
    } catch (const Error& e) {
      fail(std::string(": ") + e.what());
    }
  }
}

}  // namespace pliant
