#include "pliant/systems/block_tester.h"

#include <algorithm>
#include <set>
#include <string>

namespace pliant::internal {

namespace {

/// Collects the values that a value follows from, behind wires and rules.
void Follow(const Block& block, int index, std::set<const Value*>& seen) {
  const auto& declared = Access::Values(block)[static_cast<std::size_t>(index)];
  if (!seen.insert(declared.value).second) return;
  for (const auto& wire : declared.from) Follow(*wire.block, wire.value, seen);
  for (const Rule& rule : Access::Rules(block)) {
    if (std::ranges::find(rule.targets, index) == rule.targets.end()) continue;
    if (rule.trigger == Trigger::Guard) Follow(block, rule.guard, seen);
    for (const int argument : rule.arguments)
      if (argument != kClockIndex) Follow(block, argument, seen);
  }
}

}  // namespace

std::vector<const Value*> RequiredInputs(const Block& block) {
  std::vector<const Value*> inputs;
  for (const auto& declared : Access::Values(block))
    if (declared.kind == Kind::Input && declared.from.empty() && !declared.initial)
      inputs.push_back(declared.value);
  return inputs;
}

void RequireSet(const Value& value, const std::vector<const Value*>& unset) {
  if (unset.empty()) return;
  const auto& values = Access::Values(Access::BlockOf(value));
  const auto at = std::ranges::find_if(values, [&](const auto& d) { return d.value == &value; });
  std::set<const Value*> sources;
  Follow(Access::BlockOf(value), static_cast<int>(at - values.begin()), sources);
  std::string missing;
  for (const Value* input : unset)
    if (sources.contains(input)) missing += "\n  " + input->describe();
  if (!missing.empty())
    throw Error("cannot read " + value.path() +
                ", which depends on an input that was never set:" + missing + "\nSet it first");
}

}  // namespace pliant::internal
