#include "pliant/systems/plan.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <queue>
#include <unordered_set>

namespace pliant::internal {

std::string Plan::StateName(int element) const {
  for (const ContinuousEntry& x : continuous)
    if (element >= x.first && element < x.first + x.size) {
      std::vector<Column> columns;
      const Block::Declared& declared = Access::Of(*x.value);
      x.type->columns(declared.initial.get(), declared.space, columns);
      const Column& column = columns[static_cast<std::size_t>(element - x.first)];
      return x.value->path() + column.name;
    }
  return "state " + Text(element);
}

/// One use: Build() consumes it.
class PlanBuilder {
 public:
  explicit PlanBuilder(std::unique_ptr<Composite> root) { plan_->root = std::move(root); }

  std::unique_ptr<Plan> Build() {
    Flatten(plan_->root.get());
    CollectRules();
    Place();
    Sort();
    Bind();
    Reach();
    Schedule();
    Layout();
    return std::move(plan_);
  }

 private:
  using Row = std::vector<std::uint64_t>;

  /// A value during the build; indices run over all values of all blocks.
  struct Node {
    const Block* block;
    const Block::Declared* declared;
    std::vector<int> rules;  // Compute, Held and Derivative rules that give it
    std::vector<int> updates;
    int slot = -1, rate_slot = -1, next_slot = -1;
    int source = -1;
    int rule = -1;
  };
  struct Numbered {
    const Block* block;
    const Rule* rule;
    std::vector<int> reads;  // numbered rules whose values it reads
    int number = -1;
  };

  static std::string Ref(const Block& block, int value) {
    return value == kClockIndex ? "time" : Access::Values(block)[static_cast<std::size_t>(value)].value->path();
  }

  void Flatten(Composite* composite) {
    if (composite->number_ < 0) Number(composite);
    std::unordered_set<std::string_view> names;
    for (const std::unique_ptr<Block>& part : composite->parts_) {
      if (!names.insert(part->name()).second)
        throw Error("two blocks are named '" + part->path() + "'; rename one of them");
      Number(part.get());
      if (auto* inner = dynamic_cast<Composite*>(part.get())) Flatten(inner);
    }
  }
  void Number(Block* block) {
    block->number_ = static_cast<int>(plan_->blocks.size());
    plan_->blocks.push_back(block);
    base_.push_back(static_cast<int>(nodes_.size()));
    for (const Block::Declared& d : block->values_) nodes_.push_back({block, &d, {}, {}, -1, -1, -1, -1, -1});
  }

  int Index(const Block& block, int value) const {
    return base_[static_cast<std::size_t>(block.number_)] + value;
  }
  Node& At(int i) { return nodes_[static_cast<std::size_t>(i)]; }

  void CollectRules() {
    for (const Block* block : plan_->blocks)
      for (const Rule& rule : Access::Rules(*block)) {
        if (rule.kind == RuleKind::Update) {
          for (const int t : rule.targets) CheckUpdate(At(Index(*block, t)), *block, rule);
          happenings_.push_back({block, &rule});
        } else if (rule.kind == RuleKind::Publish) {
          happenings_.push_back({block, &rule});
        } else {
          Node& target = At(Index(*block, rule.targets[0]));
          const int number = static_cast<int>(rules_.size());
          if (!target.rules.empty()) throw Error("a value is ruled twice: " + target.declared->value->describe() +
                                                "\nkeep one of its rules");
          target.rules.push_back(number);
          rules_.push_back({block, &rule, {}, -1});
        }
      }
    std::string missing;
    for (Node& node : nodes_) {
      const Kind kind = node.declared->kind;
      const bool wired = !node.declared->from.empty();
      if (kind == Kind::Output && wired && !node.rules.empty())
        throw Error("a value is ruled twice, by a wire and by a rule: " + node.declared->value->describe());
      if (kind == Kind::Output && !wired && node.rules.empty())
        throw Error("output without a rule: " + node.declared->value->describe() +
                    "\ngive it Compute(…).From(…).As(…) in the constructor of its block");
      if (kind == Kind::Continuous && node.rules.empty())
        throw Error("continuous value without a Derivative rule: " + node.declared->value->describe() +
                    "\ngive it Derivative(…).From(…).As(…), or make it Discrete");
      if (kind == Kind::Input && !wired && !node.declared->initial)
        missing += "\n  " + node.declared->value->describe();
    }
    if (!missing.empty())
      throw Error("input is not connected:" + missing + "\nconnect an output to it, or give it a default");
  }

  void CheckUpdate(Node& node, const Block& block, const Rule& rule) {
    for (const int u : node.updates) {
      const Rule& other = *happenings_[static_cast<std::size_t>(u)].rule;
      const bool same = other.trigger == rule.trigger &&
                        (rule.trigger != Trigger::Guard ||
                         (other.guard == rule.guard && other.direction == rule.direction));
      if (same)
        throw Error("a value is ruled twice: " + node.declared->value->describe() +
                    " has two updates by the same kind of event; keep one of them");
    }
    node.updates.push_back(static_cast<int>(happenings_.size()));
    (void)block;
  }

  /// The values a value stands for: itself, or what is wired to it.
  void Resolve(int i, std::vector<int>& out) {
    const Node& node = At(i);
    const Kind kind = node.declared->kind;
    if ((kind == Kind::Input || kind == Kind::InputList || kind == Kind::Output) &&
        !node.declared->from.empty()) {
      for (const Block::Wire& wire : node.declared->from) Resolve(Index(*wire.block, wire.value), out);
    } else if (kind != Kind::InputList) {
      out.push_back(i);
    }
  }
  int ResolveOne(int i) {
    for (;;) {
      const Node& node = At(i);
      if (node.declared->from.empty()) return i;
      i = Index(*node.declared->from[0].block, node.declared->from[0].value);
    }
  }

  int NewSlot(const ValueType* type, const void* initial, Role role, const Value* value) {
    plan_->slots.push_back({type, initial, 0, role, value});
    return static_cast<int>(plan_->slots.size()) - 1;
  }

  void Place() {
    static const double kZero = 0;
    NewSlot(TypeOf<double>(), &kZero, Role::Free, nullptr);  // the clock
    sources_ = 1;
    for (Node& node : nodes_) {
      const Block::Declared& d = *node.declared;
      const auto add = [&](Role role) { return NewSlot(d.type, d.initial.get(), role, d.value); };
      switch (d.kind) {
        case Kind::Output:
          if (node.rules.empty()) break;  // wired
          if (rules_[static_cast<std::size_t>(node.rules[0])].rule->kind == RuleKind::Held) {
            node.slot = add(Role::Held);
            node.source = sources_++;
          } else {
            node.slot = add(Role::Computed);
          }
          break;
        case Kind::Input:
          if (!d.from.empty()) break;
          node.slot = add(Role::Free);
          node.source = sources_++;
          break;
        case Kind::Discrete:
          node.slot = add(Role::Discrete);
          node.source = sources_++;
          if (!node.updates.empty()) node.next_slot = add(Role::Next);
          break;
        case Kind::Continuous: {
          node.slot = add(Role::Continuous);
          node.source = sources_++;
          node.rate_slot = NewSlot(d.rate_type, d.rate.get(), Role::Rate, d.value);
          if (!node.updates.empty()) node.next_slot = add(Role::Next);
          if (!d.type->write)
            throw Error("a continuous value is made of numbers: " + d.value->describe());
          std::vector<double> x, v;
          d.type->numbers(d.initial.get(), x);
          d.rate_type->numbers(d.rate.get(), v);
          if (x.size() != v.size() || x.empty())
            throw Error("a continuous value and its rate have as many numbers, at least one: " +
                        d.value->describe() + ", got " + Text(x.size()) + " and " + Text(v.size()));
          plan_->continuous.push_back({d.type, d.rate_type, 0, 0, plan_->states,
                                       static_cast<int>(x.size()), d.value});
          plan_->states += static_cast<int>(x.size());
          break;
        }
        case Kind::Scratch:
          node.slot = add(Role::Scratch);
          break;
        case Kind::InputList:
          break;
      }
    }
    for (Node& node : nodes_)  // what is wired shares the slot of its source
      if (node.slot < 0 && node.declared->kind != Kind::InputList) {
        const Node& source = At(ResolveOne(static_cast<int>(&node - nodes_.data())));
        node.slot = source.slot;
        node.source = source.source;
      }
  }

  /// Topological order of the numbered rules, ties in the order of declaration.
  void Sort() {
    std::vector<std::vector<int>> readers(rules_.size());
    std::vector<int> waits(rules_.size(), 0);
    std::vector<int> sources;
    for (std::size_t r = 0; r < rules_.size(); ++r) {
      for (const int a : rules_[r].rule->arguments) {
        if (a == kClockIndex) continue;
        sources.clear();
        Resolve(Index(*rules_[r].block, a), sources);
        for (const int s : sources) {
          const Node& node = At(s);
          if (node.declared->kind != Kind::Output) continue;
          const int giver = node.rules[0];
          if (giver == static_cast<int>(r) && rules_[r].rule->kind == RuleKind::Held) continue;
          rules_[r].reads.push_back(giver);
        }
      }
      for (const int giver : rules_[r].reads) readers[static_cast<std::size_t>(giver)].push_back(static_cast<int>(r));
      waits[r] = static_cast<int>(rules_[r].reads.size());
    }
    std::priority_queue<int, std::vector<int>, std::greater<>> ready;
    for (std::size_t r = 0; r < rules_.size(); ++r)
      if (waits[r] == 0) ready.push(static_cast<int>(r));
    while (!ready.empty()) {
      const int r = ready.top();
      ready.pop();
      rules_[static_cast<std::size_t>(r)].number = static_cast<int>(order_.size());
      order_.push_back(r);
      for (const int reader : readers[static_cast<std::size_t>(r)])
        if (--waits[static_cast<std::size_t>(reader)] == 0) ready.push(reader);
    }
    if (order_.size() < rules_.size()) ThrowLoop();
  }

  [[noreturn]] void ThrowLoop() {
    std::size_t r = 0;
    while (rules_[r].number >= 0) ++r;
    std::vector<std::size_t> way;
    std::vector<bool> seen(rules_.size(), false);
    while (!seen[r]) {  // every unnumbered rule reads an unnumbered one
      seen[r] = true;
      way.push_back(r);
      r = static_cast<std::size_t>(*std::ranges::find_if(
          rules_[r].reads, [&](int g) { return rules_[static_cast<std::size_t>(g)].number < 0; }));
    }
    way.erase(way.begin(), std::ranges::find(way, r));
    std::string text = "algebraic loop; let one of these rules read a Discrete value instead:";
    for (std::size_t i = 0; i < way.size(); ++i) {
      const auto target = [&](std::size_t k) {
        return Ref(*rules_[k].block, rules_[k].rule->targets[0]);
      };
      text += "\n  " + target(way[i]) + "  from  " + target(way[(i + 1) % way.size()]);
    }
    throw Error(text);
  }

  std::uint32_t SlotIndex(const Block& block, int value) {
    return static_cast<std::uint32_t>(value == kClockIndex ? 0 : At(Index(block, value)).slot);
  }

  /// Where a rule's places start in plan_->places; holds slot numbers until Layout.
  std::size_t BindPlaces(const Block& block, const Rule& rule) {
    std::vector<std::uint32_t>& places = plan_->places;
    const std::size_t begin = places.size();
    for (const int t : rule.targets) {
      const Node& node = At(Index(block, t));
      places.push_back(static_cast<std::uint32_t>(rule.kind == RuleKind::Derivative ? node.rate_slot
                                                  : rule.kind == RuleKind::Update   ? node.next_slot
                                                                                    : node.slot));
      is_slot_.push_back(true);
    }
    const std::size_t arguments = places.size();
    places.resize(arguments + rule.arguments.size());
    is_slot_.resize(places.size(), true);
    std::vector<int> joined;
    for (std::size_t i = 0; i < rule.arguments.size(); ++i) {
      const int a = rule.arguments[i];
      const bool list = a != kClockIndex && At(Index(block, a)).declared->kind == Kind::InputList;
      if (!list) {
        places[arguments + i] = SlotIndex(block, a);
        continue;
      }
      places[arguments + i] = static_cast<std::uint32_t>(places.size() - arguments);
      is_slot_[arguments + i] = false;
      joined.clear();
      Resolve(Index(block, a), joined);
      places.push_back(static_cast<std::uint32_t>(joined.size()));
      is_slot_.push_back(false);
      for (const int j : joined) {
        places.push_back(static_cast<std::uint32_t>(At(j).slot));
        is_slot_.push_back(true);
      }
      if (!At(Index(block, a)).declared->type) {  // AnyInputs: the types stand behind the offsets
        type_lists_.push_back({places.size(), plan_->types.size()});
        places.resize(places.size() + sizeof(void*) / sizeof(std::uint32_t));
        is_slot_.resize(places.size(), false);
        for (const int j : joined) plan_->types.push_back(At(j).declared->type);
      }
    }
    return begin;
  }

  void Bind() {
    std::size_t happening_rules = happenings_.size();
    plan_->steps.reserve(order_.size());
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const Numbered& r = rules_[static_cast<std::size_t>(order_[k])];
      begins_.push_back(BindPlaces(*r.block, *r.rule));
      plan_->steps.push_back({r.rule->run, r.rule->function.get(), r.block, nullptr});
      plan_->rule_names.push_back({r.block, r.rule});
      if (r.rule->kind != RuleKind::Derivative)
        At(Index(*r.block, r.rule->targets[0])).rule = static_cast<int>(k);
    }
    for (std::size_t h = 0; h < happening_rules; ++h)
      happening_begins_.push_back(BindPlaces(*happenings_[h].block, *happenings_[h].rule));
    for (Node& node : nodes_)
      if (node.rule < 0 && node.declared->kind != Kind::InputList)
        node.rule = At(ResolveOne(static_cast<int>(&node - nodes_.data()))).rule;
    plan_->words = static_cast<std::uint32_t>((order_.size() + 63) / 64);
  }

  static void Set(Row& row, int bit) {
    row[static_cast<std::size_t>(bit / 64)] |= std::uint64_t{1} << (bit % 64);
  }
  static void Or(Row& to, const Row& from) {
    for (std::size_t w = 0; w < to.size(); ++w) to[w] |= from[w];
  }
  Row Empty() const { return Row(plan_->words, 0); }

  Bits Keep(const Row& row) {
    std::size_t first = 0, last = row.size();
    while (first < last && row[first] == 0) ++first;
    while (last > first && row[last - 1] == 0) --last;
    const Bits bits{static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first),
                    static_cast<std::uint32_t>(plan_->pool.size())};
    plan_->pool.insert(plan_->pool.end(), row.begin() + static_cast<std::ptrdiff_t>(first),
                       row.begin() + static_cast<std::ptrdiff_t>(last));
    return bits;
  }

  const Rule& RuleAt(int number) const {
    return *rules_[static_cast<std::size_t>(order_[static_cast<std::size_t>(number)])].rule;
  }

  /// What each rule needs, and what each source makes stale.
  void Reach() {
    const int n = static_cast<int>(order_.size());
    needs_.assign(static_cast<std::size_t>(n), {});
    for (int k = 0; k < n; ++k) {
      Row row = Empty();
      Set(row, k);
      for (const int g : rules_[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])].reads) {
        const int giver = rules_[static_cast<std::size_t>(g)].number;
        if (RuleAt(giver).kind != RuleKind::Held) Or(row, needs_[static_cast<std::size_t>(giver)]);
      }
      needs_[static_cast<std::size_t>(k)] = std::move(row);
    }
    for (int k = 0; k < n; ++k) plan_->needs.push_back(Keep(needs_[static_cast<std::size_t>(k)]));

    // Transitive readers: a rule is stale with what it reads, but a held value stays.
    std::vector<Row> stale(static_cast<std::size_t>(n), Empty());
    source_rows_.assign(static_cast<std::size_t>(sources_), Empty());
    std::vector<int> sources;
    for (int k = n - 1; k >= 0; --k) {
      const Numbered& r = rules_[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])];
      if (r.rule->kind == RuleKind::Held) continue;
      Row& row = stale[static_cast<std::size_t>(k)];
      Set(row, k);
      for (const int g : r.reads) {
        const int giver = rules_[static_cast<std::size_t>(g)].number;
        if (RuleAt(giver).kind != RuleKind::Held) Or(stale[static_cast<std::size_t>(giver)], row);
      }
      for (const int a : r.rule->arguments) {
        if (a == kClockIndex) {
          Or(source_rows_[0], row);
          continue;
        }
        sources.clear();
        Resolve(Index(*r.block, a), sources);
        for (const int s : sources)
          if (At(s).source >= 0) Or(source_rows_[static_cast<std::size_t>(At(s).source)], row);
      }
    }
    Row state = Empty(), moving = Empty(), derivatives = Empty(), valid = Empty();
    for (const Node& node : nodes_)
      if (node.declared->kind == Kind::Continuous) {
        Or(state, source_rows_[static_cast<std::size_t>(node.source)]);
      }
    for (int k = 0; k < n; ++k) {
      if (RuleAt(k).kind == RuleKind::Derivative) Or(derivatives, needs_[static_cast<std::size_t>(k)]);
      if (RuleAt(k).kind == RuleKind::Held) Set(valid, k);
    }
    Or(moving, state);
    Or(moving, source_rows_[0]);
    derivative_row_ = derivatives;
    for (const Row& row : source_rows_) plan_->sources.push_back(Keep(row));
    plan_->time_dependents = plan_->sources[0];
    plan_->state_dependents = Keep(state);
    plan_->moving_dependents = Keep(moving);
    plan_->derivatives = Keep(derivatives);
    plan_->initially_valid = Keep(valid);
  }

  bool TouchesDerivatives(const Row& stale) const {
    for (std::size_t w = 0; w < stale.size(); ++w)
      if (stale[w] & derivative_row_[w]) return true;
    return false;
  }

  /// The bits a rule outside the numbering needs for its arguments.
  void AddNeeds(const Block& block, const Rule& rule, Row& row) {
    std::vector<int> sources;
    for (const int a : rule.arguments) {
      if (a == kClockIndex) continue;
      Resolve(Index(block, a), sources);
    }
    for (const int s : sources) {
      const int r = At(s).rule;
      if (r >= 0 && RuleAt(r).kind != RuleKind::Held) Or(row, needs_[static_cast<std::size_t>(r)]);
    }
  }

  template <class Belongs>
  Happening Happens(const Belongs& belongs) {
    Happening h;
    Row publish = Empty(), update = Empty(), held = Empty(), stale = Empty();
    for (std::size_t i = 0; i < happenings_.size(); ++i) {
      const auto& [block, rule] = happenings_[i];
      if (!belongs(*block, *rule)) continue;
      const Action action{{rule->run, rule->function.get(), block, nullptr}, block};
      const bool publishes = rule->kind == RuleKind::Publish;
      AddNeeds(*block, *rule, publishes ? publish : update);
      (publishes ? h.publishes : h.updates).push_back(action);
      (publishes ? h.publishes : h.updates).back().step.slots = Begin(happening_begins_[i]);
      for (const int t : rule->targets) {
        const Node& node = At(Index(*block, t));
        const bool continuous = node.declared->kind == Kind::Continuous;
        int entry = -1;
        if (continuous) {
          entry = static_cast<int>(std::ranges::find(plan_->continuous, node.declared->value,
                                                     &ContinuousEntry::value) -
                                   plan_->continuous.begin());
          h.resets_states = true;
        }
        h.commits.push_back({node.declared->type, static_cast<std::uint32_t>(node.next_slot),
                             static_cast<std::uint32_t>(node.slot), node.source, entry});
        if (TouchesDerivatives(source_rows_[static_cast<std::size_t>(node.source)]))
          h.stops_integration = true;
      }
    }
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const Numbered& r = rules_[static_cast<std::size_t>(order_[k])];
      if (r.rule->kind != RuleKind::Held || !belongs(*r.block, *r.rule)) continue;
      Or(held, needs_[k]);
      Set(stale, static_cast<int>(k));
      const Node& node = At(Index(*r.block, r.rule->targets[0]));
      Or(stale, source_rows_[static_cast<std::size_t>(node.source)]);
    }
    h.stops_integration = h.stops_integration || h.resets_states || TouchesDerivatives(stale);
    h.held = Keep(held);
    h.stale = Keep(stale);
    h.publish_needs = Keep(publish);
    h.update_needs = Keep(update);
    return h;
  }

  /// Until Layout a step's slots are an index in disguise, since places_ may still move.
  static const std::uint32_t* Begin(std::size_t index) {
    return reinterpret_cast<const std::uint32_t*>(index);
  }

  void Schedule() {
    std::vector<std::pair<Duration, Duration>> seen;
    const auto add_rate = [&](const Rule& rule) {
      if (rule.trigger != Trigger::Periodic) return;
      const std::pair key{rule.period, rule.offset};
      if (std::ranges::find(seen, key) != seen.end()) return;
      seen.push_back(key);
      plan_->rates.push_back({rule.period, rule.offset, Happens([&](const Block&, const Rule& r) {
                                return r.trigger == Trigger::Periodic && r.period == rule.period &&
                                       r.offset == rule.offset;
                              })});
    };
    for (const Block* block : plan_->blocks)
      for (const Rule& rule : Access::Rules(*block)) {
        add_rate(rule);
        if (rule.trigger == Trigger::Guard) AddGuard(*block, rule);
      }
    plan_->start = Happens([](const Block&, const Rule& r) { return r.trigger == Trigger::Start; });
    plan_->step = Happens([](const Block&, const Rule& r) { return r.trigger == Trigger::Step; });
    for (const Action& a : plan_->step.updates)
      throw Error(a.block->path() + ": AtEveryStep() publishes and does not update, since steps differ from "
                  "integrator to integrator; use Every(period).Update(…)");
  }

  void AddGuard(const Block& block, const Rule& rule) {
    const Node& node = At(Index(block, rule.guard));
    const auto same = [&](const GuardEntry& g) {
      return g.value == node.declared->value && g.direction == rule.direction;
    };
    if (std::ranges::any_of(plan_->guards, same)) return;
    plan_->guards.push_back({node.declared->value, static_cast<std::uint32_t>(node.slot), node.rule,
                             rule.direction, Happens([&](const Block& b, const Rule& r) {
                               return &b == &block && r.trigger == Trigger::Guard &&
                                      r.guard == rule.guard && r.direction == rule.direction;
                             })});
  }

  /// Places all values in one arena and turns slot numbers into offsets.
  void Layout() {
    std::size_t at = 0;
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    const auto mix = [&](std::string_view text) {
      for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    };
    for (Slot& slot : plan_->slots) {
      at = (at + slot.type->alignment - 1) / slot.type->alignment * slot.type->alignment;
      slot.offset = static_cast<std::uint32_t>(at);
      at += slot.type->size;
    }
    at = (at + 63) / 64 * 64;
    plan_->valid_offset = static_cast<std::uint32_t>(at);
    at += plan_->words * sizeof(std::uint64_t);
    at = (at + 63) / 64 * 64;
    plan_->state_offset = static_cast<std::uint32_t>(at);
    at += static_cast<std::size_t>(plan_->states) * sizeof(double);
    plan_->bytes = at;
    Require(at < std::size_t{1} << 32, "a context has at most 4 GiB", at);

    const auto offset = [&](std::uint32_t slot) { return plan_->slots[slot].offset; };
    for (std::size_t i = 0; i < plan_->places.size(); ++i)
      if (is_slot_[i]) plan_->places[i] = offset(plan_->places[i]);
    for (const auto& [place, type] : type_lists_) {
      const ValueType* const* types = plan_->types.data() + type;
      std::memcpy(&plan_->places[place], &types, sizeof(types));
    }
    for (std::size_t k = 0; k < plan_->steps.size(); ++k)
      plan_->steps[k].slots = plan_->places.data() + begins_[k];

    const auto settle = [&](Happening& h) {
      for (auto* actions : {&h.publishes, &h.updates})
        for (Action& a : *actions)
          a.step.slots = plan_->places.data() + reinterpret_cast<std::size_t>(a.step.slots);
      for (Commit& c : h.commits) c.from = offset(c.from), c.to = offset(c.to);
    };
    for (Rate& rate : plan_->rates) settle(rate.tick);
    for (GuardEntry& guard : plan_->guards) {
      settle(guard.event);
      guard.offset = offset(guard.offset);
    }
    settle(plan_->start);
    settle(plan_->step);

    for (const Node& node : nodes_) {
      Value& value = *node.declared->value;
      value.plan_ = plan_.get();
      if (node.slot < 0) continue;
      value.offset_ = offset(static_cast<std::uint32_t>(node.slot));
      value.rule_ = node.rule;
      value.source_ = node.source;
      if (node.declared->kind == Kind::Continuous) {
        ContinuousEntry& entry = *std::ranges::find(plan_->continuous, node.declared->value, &ContinuousEntry::value);
        entry.offset = value.offset_;
        entry.rate_offset = offset(static_cast<std::uint32_t>(node.rate_slot));
      }
    }
    for (const Slot& slot : plan_->slots) {
      if (!slot.value || slot.role == Role::Computed) continue;
      mix(slot.value->name());
      mix(slot.type->name);
    }
    for (const Block* block : plan_->blocks) mix(block->name());
    plan_->fingerprint = hash;
  }

  struct HappeningRule {
    const Block* block;
    const Rule* rule;
  };

  std::unique_ptr<Plan> plan_ = std::make_unique<Plan>();
  std::vector<int> base_;
  std::vector<Node> nodes_;
  std::vector<Numbered> rules_;
  std::vector<HappeningRule> happenings_;
  std::vector<int> order_;  // rules by number
  std::vector<std::size_t> begins_, happening_begins_;
  std::vector<bool> is_slot_;
  std::vector<std::pair<std::size_t, std::size_t>> type_lists_;  // place, index into plan_->types
  std::vector<Row> needs_, source_rows_;
  Row derivative_row_;
  int sources_ = 0;
};

std::unique_ptr<Plan> MakePlan(std::unique_ptr<Composite> root) {
  return PlanBuilder(std::move(root)).Build();
}

}  // namespace pliant::internal
