#include <algorithm>
#include <vector>

#include "pliant/systems/plan_builder.h"

namespace pliant::internal {

namespace {

void Set(std::vector<std::uint64_t>& row, int bit) {
  row[static_cast<std::size_t>(bit / 64)] |= std::uint64_t{1} << (bit % 64);
}

void Or(std::vector<std::uint64_t>& to, const Bits& from, const std::vector<std::uint64_t>& pool) {
  for (std::uint32_t w = 0; w < from.size; ++w) to[from.first + w] |= pool[from.pool + w];
}

}  // namespace

void PlanBuilder::Or(Row& to, const Bits& from) const { internal::Or(to, from, plan_->pool); }

Bits PlanBuilder::Keep(const Row& row, std::vector<std::uint64_t>& pool) {
  const auto used = [](std::uint64_t word) { return word != 0; };
  const auto first = std::ranges::find_if(row, used);
  const auto last = std::find_if(row.rbegin(), std::make_reverse_iterator(first), used).base();
  const Bits bits{static_cast<std::uint32_t>(first - row.begin()),
                  static_cast<std::uint32_t>(last - first),
                  static_cast<std::uint32_t>(pool.size())};
  Require(pool.size() + bits.size < std::size_t{1} << 32, "a diagram is too large", pool.size());
  pool.insert(pool.end(), first, last);
  return bits;
}

/// What each rule needs: itself, and what the rules need that it reads. A held value is there.
void PlanBuilder::Needs() {
  Row row = Empty();
  for (int k = 0; k < static_cast<int>(order_.size()); ++k) {
    std::ranges::fill(row, 0);
    Set(row, k);
    for (const int g : Ordered(k).reads) {
      const int giver = RuleOf(g).number;
      if (!IsHeld(giver)) Or(row, plan_->needs[static_cast<std::size_t>(giver)]);
    }
    plan_->needs.push_back(Keep(row));
  }
}

/// What each source makes stale: the rules that read it and, from reader to reader, all that read
/// them. A held value stays.
void PlanBuilder::Stale() {
  const std::size_t n = order_.size();
  std::vector<std::vector<int>> readers(n), source_readers(static_cast<std::size_t>(sources_));
  std::vector<int> sources;
  for (int k = 0; k < static_cast<int>(n); ++k) {
    if (IsHeld(k)) continue;
    for (const int g : Ordered(k).reads)
      readers[static_cast<std::size_t>(RuleOf(g).number)].push_back(k);
    for (const int a : Ordered(k).rule->arguments) {
      sources.clear();
      if (a == kClockIndex)
        source_readers[0].push_back(k);
      else
        Resolve(Index(*Ordered(k).block, a), sources);
      for (const int s : sources)
        if (At(s).source >= 0) source_readers[static_cast<std::size_t>(At(s).source)].push_back(k);
    }
  }
  Row row = Empty();
  std::vector<std::uint64_t> pool;
  std::vector<Bits> stale(n);  // with each rule, from the last on
  for (std::size_t k = n; k-- > 0;) {
    if (IsHeld(static_cast<int>(k))) continue;
    std::ranges::fill(row, 0);
    Set(row, static_cast<int>(k));
    for (const int r : readers[k]) internal::Or(row, stale[static_cast<std::size_t>(r)], pool);
    stale[k] = Keep(row, pool);
  }
  for (const std::vector<int>& direct : source_readers) {
    std::ranges::fill(row, 0);
    for (const int r : direct) internal::Or(row, stale[static_cast<std::size_t>(r)], pool);
    plan_->sources.push_back(Keep(row));
  }
}

void PlanBuilder::Summarize() {
  Row moving = Empty(), derivatives = Empty(), held = Empty();
  Or(moving, plan_->sources[0]);
  for (const Node& node : nodes_)
    if (node.declared->kind == Kind::Continuous)
      Or(moving, plan_->sources[static_cast<std::size_t>(node.source)]);
  for (int k = 0; k < static_cast<int>(order_.size()); ++k) {
    if (Ordered(k).rule->kind == RuleKind::Derivative)
      Or(derivatives, plan_->needs[static_cast<std::size_t>(k)]);
    if (IsHeld(k)) Set(held, k);
  }
  watched_ = derivatives;
  plan_->moving_dependents = Keep(moving);
  plan_->derivatives = Keep(derivatives);
  plan_->initially_valid = Keep(held);
}

bool PlanBuilder::IsWatched(const Bits& stale) const {
  for (std::uint32_t w = 0; w < stale.size; ++w)
    if (plan_->pool[stale.pool + w] & watched_[stale.first + w]) return true;
  return false;
}

/// The bits a rule outside the numbering needs for its arguments.
void PlanBuilder::AddNeeds(const Block& block, const Rule& rule, Row& row) {
  std::vector<int> sources;
  for (const int a : rule.arguments)
    if (a != kClockIndex) Resolve(Index(block, a), sources);
  for (const int s : sources) {
    const int r = At(s).rule;
    if (r >= 0 && !IsHeld(r)) Or(row, plan_->needs[static_cast<std::size_t>(r)]);
  }
}

void PlanBuilder::AddAction(std::size_t happening, Happening& h) {
  const auto& [block, rule] = happenings_[happening];
  // Until Layout its slots are an index in disguise, since the places may still move.
  const auto* slots = reinterpret_cast<const std::uint32_t*>(happening_begins_[happening]);
  const Step step{rule->run, rule->function.get(), block, slots};
  if (rule->kind == RuleKind::Stop) {
    h.stops.push_back({step, static_cast<int>(plan_->endings.size())});
    plan_->endings.push_back({block->path(), rule->reason});
    return;
  }
  auto& actions = rule->kind == RuleKind::Publish ? h.publishes : h.updates;
  actions.push_back({step, block});
  for (const int t : rule->targets) {
    const Node& node = At(Index(*block, t));
    h.commits.push_back({node.declared->type, static_cast<std::uint32_t>(node.next_slot),
                         static_cast<std::uint32_t>(node.slot), node.source, node.continuous});
    if (node.continuous >= 0 || IsWatched(plan_->sources[static_cast<std::size_t>(node.source)]))
      h.stops_integration = true;
  }
}

template <class Belongs>
Happening PlanBuilder::Happens(const Belongs& belongs) {
  Happening h;
  Row publish = Empty(), update = Empty(), held = Empty(), stale = Empty();
  for (std::size_t i = 0; i < happenings_.size(); ++i) {
    const auto& [block, rule] = happenings_[i];
    if (!belongs(*block, *rule)) continue;
    AddNeeds(*block, *rule, rule->kind == RuleKind::Update ? update : publish);
    AddAction(i, h);
  }
  for (int k = 0; k < static_cast<int>(order_.size()); ++k) {
    const Numbered& r = Ordered(k);
    if (!IsHeld(k) || !belongs(*r.block, *r.rule)) continue;
    Or(held, plan_->needs[static_cast<std::size_t>(k)]);
    Set(stale, k);
    const Node& node = At(Index(*r.block, r.rule->targets[0]));
    Or(stale, plan_->sources[static_cast<std::size_t>(node.source)]);
  }
  h.held = Keep(held);
  h.stale = Keep(stale);
  h.stops_integration = h.stops_integration || IsWatched(h.stale);
  h.publish_needs = Keep(publish);
  h.update_needs = Keep(update);
  return h;
}

void PlanBuilder::Schedule() {
  for (const Block* block : plan_->blocks)  // first, since ticks must know what guards read
    for (const Rule& rule : Access::Rules(*block))
      if (rule.trigger == Trigger::Guard) AddGuard(*block, rule);
  for (GuardEntry& guard : plan_->guards)
    guard.event = Happens([&](const Block& b, const Rule& r) {
      return r.trigger == Trigger::Guard && r.direction == guard.direction &&
             At(Index(b, r.guard)).declared->value == guard.value;
    });
  for (const Block* block : plan_->blocks)
    for (const Rule& rule : Access::Rules(*block)) {
      const auto same = [&](const Rate& r) {
        return r.period == rule.period && r.offset == rule.offset;
      };
      if (rule.trigger != Trigger::Periodic || std::ranges::any_of(plan_->rates, same)) continue;
      plan_->rates.push_back({rule.period, rule.offset, Happens([&](const Block&, const Rule& r) {
                                return r.trigger == Trigger::Periodic && r.period == rule.period &&
                                       r.offset == rule.offset;
                              })});
    }
  plan_->start = Happens([](const Block&, const Rule& r) { return r.trigger == Trigger::Start; });
  plan_->step = Happens([](const Block&, const Rule& r) { return r.trigger == Trigger::Step; });
  for (const Action& a : plan_->step.updates)
    throw Error(a.block->path() +
                ": AtEveryStep() publishes and does not update, since steps differ from integrator "
                "to integrator; use Every(period).Update(…)");
}

void PlanBuilder::AddGuard(const Block& block, const Rule& rule) {
  const Node& node = At(Index(block, rule.guard));
  const auto same = [&](const GuardEntry& g) {
    return g.value == node.declared->value && g.direction == rule.direction;
  };
  if (std::ranges::any_of(plan_->guards, same)) return;
  if (node.rule >= 0) Or(watched_, plan_->needs[static_cast<std::size_t>(node.rule)]);
  plan_->guards.push_back(
      {node.declared->value, static_cast<std::uint32_t>(node.slot), node.rule, rule.direction, {}});
}

}  // namespace pliant::internal
