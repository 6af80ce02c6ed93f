#include "pliant/systems/plan.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <string_view>
#include <unordered_set>

#include "pliant/systems/plan_builder.h"

namespace pliant::internal {

std::string Plan::StateName(int element) const {
  for (const ContinuousEntry& x : continuous)
    if (element >= x.first && element < x.first + x.size) {
      std::vector<Column> columns;
      const Block::Declared& declared = Access::Of(*x.value);
      x.type->columns(declared.initial.get(), declared.space, columns);
      return x.value->path() + columns[static_cast<std::size_t>(element - x.first)].name;
    }
  return "state " + Text(element);
}

std::unique_ptr<Plan> MakePlan(std::unique_ptr<Composite> root) {
  return PlanBuilder(std::move(root)).Build();
}

std::unique_ptr<Plan> PlanBuilder::Build() {
  AddBlock(plan_->root.get());
  Flatten(plan_->root.get());
  CollectRules();
  CheckRuled();
  CheckWires();
  ShapeValues();
  Place();
  Sort();
  Bind();
  Needs();
  Stale();
  Summarize();
  Schedule();
  Layout();
  return std::move(plan_);
}

void PlanBuilder::Flatten(Composite* composite) {
  std::unordered_set<std::string_view> names;
  for (const std::unique_ptr<Block>& part : composite->parts_) {
    if (!names.insert(part->name()).second)
      throw Error("two blocks are named '" + part->path() + "'; rename one of them");
    AddBlock(part.get());
    if (auto* inner = dynamic_cast<Composite*>(part.get())) Flatten(inner);
  }
}

void PlanBuilder::AddBlock(Block* block) {
  block->number_ = static_cast<int>(plan_->blocks.size());
  plan_->blocks.push_back(block);
  blocks_.push_back(block);
  base_.push_back(static_cast<int>(nodes_.size()));
  for (const Block::Declared& d : block->values_) nodes_.push_back({block, &d});
}

void PlanBuilder::CollectRules() {
  for (const Block* block : plan_->blocks)
    for (const Rule& rule : Access::Rules(*block)) {
      if (rule.kind == RuleKind::Update || rule.kind == RuleKind::Publish ||
          rule.kind == RuleKind::Stop) {
        happenings_.push_back({block, &rule});
        for (const int t : rule.targets) CheckUpdate(At(Index(*block, t)), rule);
        continue;
      }
      Node& target = At(Index(*block, rule.targets[0]));
      if (!target.rules.empty())
        throw Error("a value is ruled twice: " + target.declared->value->describe() +
                    "\nkeep one of its rules");
      target.rules.push_back(static_cast<int>(rules_.size()));
      rules_.push_back({block, &rule});
    }
}

void PlanBuilder::CheckUpdate(Node& node, const Rule& rule) {
  for (const int u : node.updates) {
    const Rule& other = *happenings_[static_cast<std::size_t>(u)].rule;
    if (other.trigger == rule.trigger &&
        (rule.trigger != Trigger::Guard ||
         (other.guard == rule.guard && other.direction == rule.direction)))
      throw Error("a value is ruled twice: " + node.declared->value->describe() +
                  " has two updates by the same kind of event; keep one of them");
  }
  node.updates.push_back(static_cast<int>(happenings_.size()) - 1);
}

void PlanBuilder::CheckRuled() {
  std::string missing;
  for (const Node& node : nodes_) {
    const Kind kind = node.declared->kind;
    const bool wired = !node.declared->from.empty();
    const auto refuse = [&](const std::string& what, const std::string& way_out) {
      throw Error(what + ": " + node.declared->value->describe() + "\n" + way_out);
    };
    if (kind == Kind::Output && wired && !node.rules.empty())
      refuse("a value is ruled twice, by a wire and by a rule", "keep one of the two");
    if (kind == Kind::Output && !wired && node.rules.empty())
      refuse("output without a rule",
             "give it Compute(…).From(…).As(…) in the constructor of its block");
    if (kind == Kind::Continuous && node.rules.empty())
      refuse("continuous value without a Derivative rule",
             "give it Derivative(…).From(…).As(…), or make it Discrete");
    if (kind == Kind::Input && !wired && !node.declared->initial)
      missing += "\n  " + node.declared->value->describe();
  }
  if (!missing.empty())
    throw Error("input is not connected:" + missing +
                "\nconnect an output to it, or give it a default");
}

/// Wires may pass through composites: no circle of wires alone, and the spaces at both ends agree,
/// though the ports between may say nothing.
void PlanBuilder::CheckWires() {
  enum class Seen { kNo, kOnTheWay, kDone };
  std::vector<Seen> seen(nodes_.size(), Seen::kNo);
  const auto follow = [&](const auto& self, int i) -> void {
    Seen& mark = seen[static_cast<std::size_t>(i)];
    if (mark == Seen::kDone) return;
    const Block::Declared& declared = *At(i).declared;
    if (mark == Seen::kOnTheWay)
      throw Error("algebraic loop; wires alone lead from this port back to it:\n  " +
                  declared.value->describe());
    mark = Seen::kOnTheWay;
    for (const Block::Wire& wire : declared.from) self(self, Index(*wire.block, wire.value));
    seen[static_cast<std::size_t>(i)] = Seen::kDone;
  };
  std::vector<int> ends;
  for (int i = 0; i < static_cast<int>(nodes_.size()); ++i) {
    if (At(i).declared->from.empty()) continue;
    follow(follow, i);
    ends.clear();
    Resolve(i, ends);
    for (const int end : ends) CheckSpaces(*At(end).declared->value, *At(i).declared->value);
  }
}

/// Initial values that are made from what is wired to a list. A value goes by the name of the port
/// its wire comes from, be it that of a composite.
void PlanBuilder::ShapeValues() {
  std::vector<int> ends;
  for (Block* block : blocks_)
    for (Block::Declared& d : block->values_) {
      if (!d.shape) continue;
      std::vector<Source> sources;
      for (const Block::Wire& wire : block->values_[static_cast<std::size_t>(d.shaped_by)].from) {
        const int port = Index(*wire.block, wire.value);
        ends.clear();
        Resolve(port, ends);
        for (const int end : ends) {
          const Block::Declared& from = *At(end).declared;
          const Value& named = ends.size() == 1 ? *At(port).declared->value : *from.value;
          sources.push_back({named.path(), from.type, from.space, from.initial.get()});
        }
      }
      try {
        d.initial = d.shape(sources);
      } catch (const Error& e) {
        throw Error(block->path() + ": " + e.what());
      }
    }
}

void PlanBuilder::Resolve(int i, std::vector<int>& out) {
  const Node& node = At(i);
  for (const Block::Wire& wire : node.declared->from) Resolve(Index(*wire.block, wire.value), out);
  if (node.declared->from.empty() && node.declared->kind != Kind::InputList) out.push_back(i);
}

int PlanBuilder::ResolveOne(int i) {
  while (!At(i).declared->from.empty()) {
    const Block::Wire& wire = At(i).declared->from[0];
    i = Index(*wire.block, wire.value);
  }
  return i;
}

/// Topological order of the numbered rules, ties in the order of declaration.
void PlanBuilder::Sort() {
  std::vector<std::vector<int>> readers(rules_.size());
  std::vector<int> waits(rules_.size(), 0);
  std::vector<int> sources;
  for (std::size_t r = 0; r < rules_.size(); ++r) {
    Numbered& rule = rules_[r];
    sources.clear();
    for (const int a : rule.rule->arguments)
      if (a != kClockIndex) Resolve(Index(*rule.block, a), sources);
    for (const int s : sources) {
      if (At(s).declared->kind != Kind::Output) continue;
      const int giver = At(s).rules[0];
      const bool own_last = giver == static_cast<int>(r) && rule.rule->kind == RuleKind::Held;
      if (!own_last) rule.reads.push_back(giver);
    }
    for (const int giver : rule.reads)
      readers[static_cast<std::size_t>(giver)].push_back(static_cast<int>(r));
    waits[r] = static_cast<int>(rule.reads.size());
  }
  std::priority_queue<int, std::vector<int>, std::greater<>> ready;
  for (std::size_t r = 0; r < rules_.size(); ++r)
    if (waits[r] == 0) ready.push(static_cast<int>(r));
  while (!ready.empty()) {
    const int r = ready.top();
    ready.pop();
    RuleOf(r).number = static_cast<int>(order_.size());
    order_.push_back(r);
    for (const int reader : readers[static_cast<std::size_t>(r)])
      if (--waits[static_cast<std::size_t>(reader)] == 0) ready.push(reader);
  }
  if (order_.size() < rules_.size()) ThrowLoop();
}

void PlanBuilder::ThrowLoop() {
  int r = 0;
  while (RuleOf(r).number >= 0) ++r;
  std::vector<int> way;
  while (std::ranges::find(way, r) == way.end()) {  // every unnumbered rule reads an unnumbered one
    way.push_back(r);
    r = *std::ranges::find_if(RuleOf(r).reads, [&](int g) { return RuleOf(g).number < 0; });
  }
  way.erase(way.begin(), std::ranges::find(way, r));
  const auto target = [&](std::size_t i) {
    const Numbered& rule = RuleOf(way[i % way.size()]);
    return At(Index(*rule.block, rule.rule->targets[0])).declared->value->path();
  };
  std::string text = "algebraic loop; let one of these rules read a Discrete value instead:";
  for (std::size_t i = 0; i < way.size(); ++i)
    text += "\n  " + target(i) + "  from  " + target(i + 1);
  throw Error(text);
}

}  // namespace pliant::internal
