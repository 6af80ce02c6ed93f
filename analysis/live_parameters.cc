#include "pliant/analysis/live_parameters.h"

#include <algorithm>
#include <cmath>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::internal {

namespace {

using Json = LiveParameters::Json;
using TunableKind = TunableValue::Kind;

constexpr double kMostWhole = 2147483647;  // of an int
constexpr std::size_t kLongestName = 200;  // of what is wrong, in messages

std::string Quoted(const Json& value) {
  constexpr std::size_t kShown = 60, kMost = 8;
  const auto is_nested = [](const Json& x) { return x.is_structured(); };
  if (value.is_object()) return "an object";
  if (value.is_array() && (value.size() > kMost || std::ranges::any_of(value, is_nested)))
    return "an array of " + pliant::Text(value.size());
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "…";
  return text;
}

std::string List(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

}  // namespace

LiveParameters::LiveParameters(std::vector<TunableValue> tunables)
    : tunables_{std::move(tunables)} {
  for (std::size_t i = 0; i < tunables_.size(); ++i) {
    numbers_.push_back(tunables_[i].start);
    by_name_.emplace(tunables_[i].path, i);
  }
}

std::size_t LiveParameters::Find(std::string_view name) const {
  if (const auto found = by_name_.find(name); found != by_name_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [path, i] : by_name_) names.push_back(path);
  name = name.substr(0, kLongestName);
  throw Error("there is no parameter '" + std::string(name) + "'" + DidYouMean(name, names));
}

Json LiveParameters::Value(std::size_t i) const { return ValueOf(i, numbers_[i]); }

Json LiveParameters::ValueOf(std::size_t i, std::span<const double> numbers) const {
  const TunableValue& of = tunables_[i];
  switch (of.kind) {
    case TunableKind::Number:
      return numbers[0];
    case TunableKind::Flag:
      return numbers[0] != 0;
    case TunableKind::Word:
      return of.words.at(static_cast<std::size_t>(numbers[0]));
    case TunableKind::Numbers:
    case TunableKind::Matrix:
      break;
  }
  return std::vector<double>(numbers.begin(), numbers.end());
}

std::vector<double> LiveParameters::Read(std::size_t i, const Json& value) const {
  const TunableValue& of = tunables_[i];
  const auto refuse = [&](const std::string& expected) -> std::vector<double> {
    throw Error(of.path + ": expected " + expected + ", got " + Quoted(value));
  };
  const auto finite = [](const Json& x) { return x.is_number() && std::isfinite(x.get<double>()); };
  switch (of.kind) {
    case TunableKind::Number: {
      if (!finite(value)) return refuse("a finite number");
      const double x = value.get<double>();
      if (of.whole && (x != std::round(x) || std::abs(x) > kMostWhole))
        return refuse("a whole number");
      return {x};
    }
    case TunableKind::Flag:
      if (!value.is_boolean()) return refuse("true or false");
      return {value.get<bool>() ? 1.0 : 0.0};
    case TunableKind::Word: {
      const auto word = value.is_string()
                            ? std::ranges::find(of.words, value.get_ref<const std::string&>())
                            : of.words.end();
      if (word == of.words.end()) return refuse("one of " + List(of.words));
      return {static_cast<double>(word - of.words.begin())};
    }
    case TunableKind::Numbers:
    case TunableKind::Matrix:
      break;
  }
  if (!value.is_array() || value.size() != of.size() || !std::ranges::all_of(value, finite))
    return refuse(Text(of.size()) + " finite numbers");
  return value.get<std::vector<double>>();
}

Json LiveParameters::Description() const {
  Json all = Json::array();
  for (std::size_t i = 0; i < tunables_.size(); ++i) {
    const TunableValue& of = tunables_[i];
    Json json{{"name", of.path}, {"about", of.type}, {"kind", WordOf(of.kind)}};
    if (!of.units.front().empty()) json["unit"] = of.units.front();
    if (of.whole) json["whole"] = true;
    if (of.kind == TunableKind::Word) json["words"] = of.words;
    if (of.kind == TunableKind::Numbers) {
      Json& names = json["elements"] = Json::array();
      for (const std::string& name : of.elements) names.push_back(name.substr(1, name.size() - 2));
    }
    if (of.kind == TunableKind::Matrix) {
      json["rows"] = of.rows;
      json["cols"] = of.cols;
    }
    json["value"] = ValueOf(i, of.start);
    all.push_back(std::move(json));
  }
  return all;
}

}  // namespace pliant::internal
