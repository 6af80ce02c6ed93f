#include "pliant/analysis/run_data.h"

#include <algorithm>
#include <charconv>

#include "pliant/analysis/mcap_reader.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

using Texts = std::map<std::string, std::string>;

const std::string& TextOf(const Texts& words, const std::string& key, const std::string& file) {
  const auto found = words.find(key);
  if (found == words.end())
    throw Error(file + ": its record 'pliant' says nothing under '" + key +
                "'; expected a log that `pliant run` wrote");
  return found->second;
}

/// 0 where the record has no such number: a run that was killed could not write it.
template <class Number>
Number NumberOf(const Texts& words, const std::string& key) {
  Number number{};
  if (const auto found = words.find(key); found != words.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), number);
  return number;
}

RunHeading HeadingOf(const std::filesystem::path& file, const Recording::Metadata& metadata) {
  RunHeading run;
  run.file = file;
  const auto pliant = metadata.find("pliant");
  if (pliant == metadata.end())
    throw Error(file.string() +
                ": it has no record 'pliant'; expected a log that `pliant run` wrote");
  run.name = TextOf(pliant->second, "run", file.string());
  run.title = TextOf(pliant->second, "title", file.string());
  run.version = TextOf(pliant->second, "version", file.string());
  run.built_with = TextOf(pliant->second, "built_with", file.string());
  run.experiment = TextOf(pliant->second, "experiment", file.string());
  run.repetition = NumberOf<int>(pliant->second, "repetition");
  const auto ended = metadata.find("pliant.run");
  const Texts none, &end = ended == metadata.end() ? none : ended->second;
  run.timing = {.simulated_s = NumberOf<double>(end, "simulated_s"),
                .wall_s = NumberOf<double>(end, "wall_s"),
                .ticks = NumberOf<std::int64_t>(end, "ticks"),
                .integrator_steps = NumberOf<std::int64_t>(end, "integrator_steps"),
                .derivative_calls = NumberOf<std::int64_t>(end, "derivative_calls")};
  run.whole = NumberOf<int>(end, "whole") == 1;
  if (const auto text = end.find("ended"); text != end.end()) run.ended = text->second;
  if (const auto text = end.find("integrator"); text != end.end()) run.integrator = text->second;
  return run;
}

}  // namespace

RunHeading RunHeading::Read(const std::filesystem::path& file) {
  const McapReader reader(file);
  // What it lacks may be what is damaged, which reading it all finds out and says.
  if (!reader.fault().empty()) Recording::Read(file);
  return HeadingOf(file, reader.metadata());
}

RunData RunData::Read(const std::filesystem::path& file) {
  Recording log = Recording::Read(file);
  RunData run{HeadingOf(file, log.metadata())};
  const Texts& pliant = log.metadata().at("pliant");
  ParameterFile::ReadText(TextOf(pliant, "scenario", file.string()), file.string() + ": scenario")
      .Fill(run.scenario);
  run.arm = StationOf(run.scenario);
  run.control = ControllerOf(run.scenario, run.arm);
  run.log = std::move(log);
  return run;
}

const Eigen::VectorXd& RunData::times() const { return log["arm.measured_position"].times; }

const RunData& Runs::operator[](std::string_view name) const {
  const auto found = std::ranges::find(runs_, name, &RunData::name);
  if (found != runs_.end()) return **found;
  std::vector<std::string> names;
  for (const RunData* run : runs_) names.push_back(run->name);
  throw Error("there is no run '" + std::string(name) + "'" + DidYouMean(name, names));
}

}  // namespace pliant
