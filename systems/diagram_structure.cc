#include "pliant/systems/diagram_structure.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <string_view>
#include <typeinfo>
#include <utility>

namespace pliant {

namespace {

using internal::Access;
using internal::Kind;
using internal::Rule;
using internal::RuleKind;
using internal::Trigger;

/// A value of a block, by the block and its place there.
using End = std::pair<const Block*, int>;

const auto& Declared(const End& end) {
  return Access::Values(*end.first)[static_cast<std::size_t>(end.second)];
}

/// What does not tell types apart for who reads a picture.
std::string Short(std::string type) {
  for (const std::string_view prefix : {"pliant::", "internal::", "(anonymous namespace)::"})
    for (std::size_t at; (at = type.find(prefix)) != std::string::npos;)
      type.erase(at, prefix.size());
  return type;
}

std::string RateText(Duration period) {
  const double hertz = 1 / seconds(period);
  if (hertz >= 999.5) return Text(hertz / 1000) + " kHz";
  return hertz >= 1 ? Text(hertz) + " Hz" : "every " + period.text();
}

class Reader {
 public:
  explicit Reader(const internal::Plan& plan) : plan_{plan} {}

  DiagramStructure Read() {
    DiagramStructure out;
    for (const Block* block : plan_.blocks) {
      if (block == plan_.root.get()) continue;
      places_[block] = static_cast<int>(out.blocks.size());
      out.blocks.push_back(ReadBlock(*block));
    }
    for (const Block* block : plan_.blocks)
      if (block != plan_.root.get()) ReadWires(*block, out);
    SpreadToComposites(out.blocks);
    return out;
  }

 private:
  DiagramStructure::Block ReadBlock(const Block& block) {
    DiagramStructure::Block out;
    out.path = block.path();
    out.name = block.name();
    out.type = Short(internal::TypeName(typeid(block)));
    const auto parent = places_.find(Access::Parent(block));
    if (parent != places_.end()) out.parent = parent->second;
    out.composite = dynamic_cast<const Composite*>(&block) != nullptr;
    const auto& values = Access::Values(block);
    for (std::size_t v = 0; v < values.size(); ++v) {
      out.integrates |= values[v].kind == Kind::Continuous;
      out.remembers |= values[v].kind == Kind::Discrete;
      out.records |= !values[v].type;
      if (values[v].kind == Kind::Input && Sources({&block, static_cast<int>(v)}).empty())
        out.free.push_back(values[v].value->path());
    }
    for (const Rule& rule : Access::Rules(block)) {
      out.rates |= RatesOf(block, rule);
      out.remembers |= rule.kind == RuleKind::Held &&
                       std::ranges::find(rule.arguments, rule.targets[0]) != rule.arguments.end();
    }
    return out;
  }

  void ReadWires(const Block& block, DiagramStructure& out) {
    const auto& values = Access::Values(block);
    for (int v = 0; v < static_cast<int>(values.size()); ++v) {
      if (!IsRead(block, v)) continue;
      for (const End& source : Sources({&block, v})) {
        const auto& output = Declared(source);
        out.wires.push_back({.from = places_.at(source.first),
                             .to = places_.at(&block),
                             .output = output.value->path(),
                             .input = values[static_cast<std::size_t>(v)].value->path(),
                             .type = Short(output.type->name),
                             .unit = output.type->unit,
                             .rates = RatesOf(source)});
      }
    }
  }

  /// A composite passes its inputs on; only what its own rules read ends there.
  static bool IsRead(const Block& block, int value) {
    const Kind kind = Declared({&block, value}).kind;
    if (kind != Kind::Input && kind != Kind::InputList) return false;
    if (!dynamic_cast<const Composite*>(&block)) return true;
    return std::ranges::any_of(Access::Rules(block), [&](const Rule& rule) {
      return std::ranges::find(rule.arguments, value) != rule.arguments.end();
    });
  }

  /// The outputs that a value follows, behind the ports of composites; none: a default.
  static std::vector<End> Sources(const End& end) {
    std::vector<End> sources;
    Follow(end, sources);
    return sources;
  }
  static void Follow(const End& end, std::vector<End>& sources) {
    for (const auto& wire : Declared(end).from) Follow({wire.block, wire.value}, sources);
    if (Declared(end).from.empty() && Declared(end).kind == Kind::Output) sources.push_back(end);
  }

  static Rates RatesOf(const Rule& rule) {
    Rates rates;
    // What ticks once in a lifetime is no rate.
    if (rule.trigger == Trigger::Periodic && rule.period < kOnce) rates.periods = {rule.period};
    rates.events = rule.trigger == Trigger::Guard;
    rates.steps = rule.trigger == Trigger::Step;
    rates.continuous = rule.kind == RuleKind::Derivative;
    return rates;
  }

  Rates RatesOf(const Block& block, const Rule& rule) {
    Rates rates = RatesOf(rule);
    if (rule.kind != RuleKind::Compute) return rates;
    for (const int argument : rule.arguments)
      if (argument == internal::kClockIndex)
        rates.continuous = true;
      else
        rates |= RatesOf({&block, argument});
    return rates;
  }

  /// Ends, since values that follow each other in a circle are refused when a diagram is built.
  Rates RatesOf(const End& end) {
    if (const auto known = rates_.find(end); known != rates_.end()) return known->second;
    Rates rates;
    if (Declared(end).kind == Kind::Continuous) rates.continuous = true;
    for (const auto& wire : Declared(end).from) rates |= RatesOf({wire.block, wire.value});
    for (const Rule& rule : Access::Rules(*end.first))
      if (std::ranges::find(rule.targets, end.second) != rule.targets.end())
        rates |= RatesOf(*end.first, rule);
    return rates_[end] = rates;
  }

  /// A composite has the rates and states of its parts.
  static void SpreadToComposites(std::vector<DiagramStructure::Block>& blocks) {
    for (std::size_t i = blocks.size(); i-- > 0;) {
      if (blocks[i].parent < 0) continue;
      DiagramStructure::Block& above = blocks[static_cast<std::size_t>(blocks[i].parent)];
      above.rates |= blocks[i].rates;
      above.integrates |= blocks[i].integrates;
      above.remembers |= blocks[i].remembers;
    }
  }

  const internal::Plan& plan_;
  std::map<const Block*, int> places_;
  std::map<End, Rates> rates_;
};

}  // namespace

Rates& Rates::operator|=(const Rates& other) {
  std::vector<Duration> both;
  std::ranges::set_union(periods, other.periods, std::back_inserter(both), std::less<>());
  periods = std::move(both);
  continuous |= other.continuous;
  events |= other.events;
  steps |= other.steps;
  return *this;
}

std::vector<std::string> Rates::texts() const {
  std::vector<std::string> texts;
  if (continuous) texts.emplace_back("continuous");
  for (const Duration& period : periods) texts.push_back(RateText(period));
  if (events) texts.emplace_back("events");
  if (steps) texts.emplace_back("steps");
  return texts;
}

DiagramStructure DiagramStructure::Of(const Diagram& diagram) {
  DiagramStructure out = Reader(diagram.plan()).Read();
  out.values = diagram.Values();
  for (ValueInfo& value : out.values) value.type = Short(value.type);
  return out;
}

}  // namespace pliant
