#include <algorithm>
#include <cstring>
#include <string_view>

#include "pliant/systems/plan_builder.h"

namespace pliant::internal {

int PlanBuilder::NewSlot(const ValueType* type, const void* initial, Role role,
                         const Value* value) {
  plan_->slots.push_back({type, initial, 0, role, value});
  return static_cast<int>(plan_->slots.size()) - 1;
}

void PlanBuilder::Place() {
  static const double kZero = 0;
  NewSlot(TypeOf<double>(), &kZero, Role::Free, nullptr);  // the clock
  sources_ = 1;
  const auto stops = [](const HappeningRule& h) { return h.rule->kind == RuleKind::Stop; };
  static const bool kGoesOn = false;
  if (std::ranges::any_of(happenings_, stops))
    stop_slot_ = NewSlot(TypeOf<bool>(), &kGoesOn, Role::Scratch, nullptr);
  for (Node& node : nodes_) {
    const Block::Declared& d = *node.declared;
    if (!d.from.empty()) continue;
    const auto add = [&](Role role) {
      node.slot = NewSlot(d.type, d.initial.get(), role, d.value);
      if (role != Role::Computed && role != Role::Scratch) node.source = sources_++;
    };
    switch (d.kind) {
      case Kind::Input:
        add(Role::Free);
        break;
      case Kind::Output:
        add(RuleOf(node.rules[0]).rule->kind == RuleKind::Held ? Role::Held : Role::Computed);
        break;
      case Kind::Discrete:
        add(Role::Discrete);
        break;
      case Kind::Continuous:
        add(Role::Continuous);
        PlaceContinuous(node);
        break;
      case Kind::Scratch:
        add(Role::Scratch);
        break;
      case Kind::InputList:
        break;
    }
    if (!node.updates.empty())
      node.next_slot = NewSlot(d.type, d.initial.get(), Role::Next, d.value);
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i)  // what is wired shares the slot of its source
    if (!nodes_[i].declared->from.empty() && nodes_[i].declared->kind != Kind::InputList)
      nodes_[i].slot = At(ResolveOne(static_cast<int>(i))).slot;
}

void PlanBuilder::PlaceContinuous(Node& node) {
  const Block::Declared& d = *node.declared;
  if (!d.type->write || !d.rate_type->write)
    throw Error("a continuous value is made of numbers: " + d.value->describe());
  const std::size_t size = d.type->count(d.initial.get());
  const std::size_t rate_size = d.rate_type->count(d.rate.get());
  if (size != rate_size || size == 0)
    throw Error("a continuous value and its rate have as many numbers, at least one: " +
                d.value->describe() + ", got " + Text(size) + " and " + Text(rate_size));
  node.rate_slot = NewSlot(d.rate_type, d.rate.get(), Role::Rate, d.value);
  node.continuous = static_cast<int>(plan_->continuous.size());
  plan_->continuous.push_back(
      {d.type, d.rate_type, 0, 0, plan_->states, static_cast<int>(size), d.value});
  plan_->states += static_cast<int>(size);
}

void PlanBuilder::Bind() {
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const Numbered& r = Ordered(static_cast<int>(k));
    begins_.push_back(BindPlaces(*r.block, *r.rule));
    plan_->steps.push_back({r.rule->run, r.rule->function.get(), r.block, nullptr});
    plan_->rule_names.push_back({r.block, r.rule});
    if (r.rule->kind != RuleKind::Derivative)
      At(Index(*r.block, r.rule->targets[0])).rule = static_cast<int>(k);
  }
  for (const HappeningRule& h : happenings_)
    happening_begins_.push_back(BindPlaces(*h.block, *h.rule));
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].declared->kind != Kind::InputList)
      nodes_[i].rule = At(ResolveOne(static_cast<int>(i))).rule;
  plan_->words = static_cast<std::uint32_t>((order_.size() + 63) / 64);
}

/// Where a rule's places start in plan_->places: its targets, its arguments, then what its lists
/// join. They hold slot numbers until Layout.
std::size_t PlanBuilder::BindPlaces(const Block& block, const Rule& rule) {
  std::vector<std::uint32_t>& places = plan_->places;
  const std::size_t begin = places.size();
  for (const int t : rule.targets) {
    const Node& node = At(Index(block, t));
    places.push_back(static_cast<std::uint32_t>(rule.kind == RuleKind::Derivative ? node.rate_slot
                                                : rule.kind == RuleKind::Update   ? node.next_slot
                                                                                  : node.slot));
  }
  if (rule.kind == RuleKind::Stop) places.push_back(static_cast<std::uint32_t>(stop_slot_));
  const std::size_t arguments = places.size();
  places.resize(arguments + rule.arguments.size(), 0);  // the clock's slot is 0
  is_slot_.resize(places.size(), true);
  for (std::size_t i = 0; i < rule.arguments.size(); ++i) {
    if (rule.arguments[i] == kClockIndex) continue;
    const Node& node = At(Index(block, rule.arguments[i]));
    if (node.declared->kind != Kind::InputList) {
      places[arguments + i] = static_cast<std::uint32_t>(node.slot);
    } else {
      places[arguments + i] = static_cast<std::uint32_t>(places.size() - arguments);
      is_slot_[arguments + i] = false;
      BindList(node);
    }
  }
  return begin;
}

/// The length of a list, its places and, for values of any types, where their types stand.
void PlanBuilder::BindList(const Node& list) {
  std::vector<std::uint32_t>& places = plan_->places;
  std::vector<int> joined;
  Resolve(Index(*list.block, list.declared->value->index_), joined);
  places.push_back(static_cast<std::uint32_t>(joined.size()));
  is_slot_.resize(places.size(), false);
  for (const int j : joined) places.push_back(static_cast<std::uint32_t>(At(j).slot));
  is_slot_.resize(places.size(), true);
  if (list.declared->type) return;
  type_lists_.push_back({places.size(), plan_->types.size()});
  places.resize(places.size() + sizeof(void*) / sizeof(std::uint32_t), 0);
  is_slot_.resize(places.size(), false);
  for (const int j : joined) plan_->types.push_back(At(j).declared->type);
}

/// Places all values in one arena and turns slot numbers into offsets.
void PlanBuilder::Layout() {
  plan_->fingerprint = Fingerprint();
  std::size_t at = 0;
  const auto reserve = [&](std::size_t size, std::size_t alignment) {
    const std::size_t offset = (at + alignment - 1) / alignment * alignment;
    at = offset + size;
    Require(at < std::size_t{1} << 32, "a context has at most 4 GiB", at);
    plan_->alignment = std::max(plan_->alignment, alignment);
    return static_cast<std::uint32_t>(offset);
  };
  for (Slot& slot : plan_->slots) slot.offset = reserve(slot.type->size, slot.type->alignment);
  if (stop_slot_ >= 0)
    plan_->stop_offset = plan_->slots[static_cast<std::size_t>(stop_slot_)].offset;
  plan_->valid_offset = reserve(plan_->words * sizeof(std::uint64_t), 64);
  plan_->state_offset = reserve(static_cast<std::size_t>(plan_->states) * sizeof(double), 64);
  plan_->bytes = at;

  for (std::size_t i = 0; i < plan_->places.size(); ++i)
    if (is_slot_[i]) plan_->places[i] = plan_->slots[plan_->places[i]].offset;
  for (const auto& [place, type] : type_lists_) {
    const ValueType* const* types = plan_->types.data() + type;
    std::memcpy(&plan_->places[place], &types, sizeof(types));
  }
  plan_->functions.resize(plan_->steps.size());
  for (std::size_t k = 0; k < plan_->steps.size(); ++k) {
    Step& step = plan_->steps[k];
    step.slots = plan_->places.data() + begins_[k];
    const std::size_t size = Ordered(static_cast<int>(k)).rule->function_size;
    if (size == 0 || size > sizeof(SmallFunction)) continue;
    std::memcpy(plan_->functions[k].bytes, step.function, size);
    step.function = &plan_->functions[k];
  }
  for (Rate& rate : plan_->rates) LayOutHappening(rate.tick);
  for (GuardEntry& guard : plan_->guards) {
    LayOutHappening(guard.event);
    guard.offset = plan_->slots[guard.offset].offset;
  }
  LayOutHappening(plan_->start);
  LayOutHappening(plan_->step);
  for (const Node& node : nodes_) Publish(node);
}

void PlanBuilder::LayOutHappening(Happening& h) {
  const auto place = [&](auto& actions) {
    for (auto& a : actions)
      a.step.slots = plan_->places.data() + reinterpret_cast<std::size_t>(a.step.slots);
  };
  place(h.publishes);
  place(h.updates);
  place(h.stops);
  for (Commit& c : h.commits) {
    c.from = plan_->slots[c.from].offset;
    c.to = plan_->slots[c.to].offset;
  }
}

/// Tells a value where it stands.
void PlanBuilder::Publish(const Node& node) {
  Value& value = *node.declared->value;
  value.plan_ = plan_.get();
  if (node.slot < 0) return;
  value.offset_ = plan_->slots[static_cast<std::size_t>(node.slot)].offset;
  value.rule_ = node.rule;
  value.source_ = node.source;
  value.state_ = node.continuous;
  if (node.continuous < 0) return;
  ContinuousEntry& entry = plan_->continuous[static_cast<std::size_t>(node.continuous)];
  entry.offset = value.offset_;
  entry.rate_offset = plan_->slots[static_cast<std::size_t>(node.rate_slot)].offset;
}

/// FNV-1a of all names, types, wires, rules and rates.
std::uint64_t PlanBuilder::Fingerprint() const {
  std::uint64_t hash = kFingerprintSeed;
  const auto mix = [&](std::string_view text) { hash = Mixed(hash, text); };
  const auto mix_number = [&](auto x) { mix({reinterpret_cast<const char*>(&x), sizeof(x)}); };
  for (const Block* block : plan_->blocks) {
    mix(block->name());
    mix_number(block->parent_ ? static_cast<const Block*>(block->parent_)->number_ : -1);
    for (const Rule& rule : block->rules_) {
      mix_number(static_cast<int>(rule.kind));
      mix_number(static_cast<int>(rule.trigger));
      mix(rule.period.text());
      mix(rule.offset.text());
    }
  }
  for (const Node& node : nodes_) {
    mix(node.declared->name);
    mix(node.declared->type ? node.declared->type->name : "any");
    mix_number(node.declared->space.size());
  }
  for (const std::uint32_t place : plan_->places) mix_number(place);
  return hash;
}

}  // namespace pliant::internal
