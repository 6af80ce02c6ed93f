#include "pliant/systems/part.h"

#include <algorithm>
#include <compare>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace internal {

namespace {

/// A value of a block, built or not.
struct End {
  const Block* block;
  int value;

  const auto& declared() const { return Access::Values(*block)[static_cast<std::size_t>(value)]; }
  auto operator<=>(const End&) const = default;
};

/// What a value stands for: itself, or what is wired to it. A circle of wires has no end; it is
/// refused when the part is built.
void Resolve(const End& at, std::vector<End>& way, std::vector<End>& out) {
  const auto& declared = at.declared();
  if (declared.from.empty() && declared.kind != Kind::InputList) out.push_back(at);
  if (std::ranges::find(way, at) != way.end()) return;
  way.push_back(at);
  for (const auto& wire : declared.from) Resolve({wire.block, wire.value}, way, out);
  way.pop_back();
}

std::vector<End> Ends(const End& at) {
  std::vector<End> way, ends;
  Resolve(at, way, ends);
  return ends;
}

void Flatten(const Composite& composite, std::vector<Block*>& blocks) {
  for (const auto& part : Access::Parts(composite)) {
    blocks.push_back(part.get());
    if (const auto* inner = dynamic_cast<const Composite*>(part.get())) Flatten(*inner, blocks);
  }
}

/// A value of the block that changes between ticks, or null.
const Value* Moving(const Block& block) {
  for (const Rule& rule : Access::Rules(block)) {
    const bool guarded = rule.trigger == Trigger::Guard;
    if (!guarded && rule.kind != RuleKind::Derivative) continue;
    const int index = guarded ? rule.guard : rule.targets[0];
    return Access::Values(block)[static_cast<std::size_t>(index)].value;
  }
  return nullptr;
}

/// Stands where a block was of which only values or parts are left.
class StandIn final : public Composite {
 public:
  StandIn() = default;

  /// A free value in the place of another.
  template <class Declared>
  const Value& Give(const Declared& other) {
    return given_.emplace_back(this, other);
  }

 private:
  struct Given final : Value {
    template <class Declared>
    Given(Block* block, const Declared& other)
        : Value(block, other.name, Kind::Input, other.type, other.space, other.initial) {}
  };
  std::deque<Given> given_;
};

class Watcher final : public Block {
 public:
  /// Of a tick: its period and offset.
  using Rate = std::pair<Duration, Duration>;

  Watcher(const std::vector<Rate>& rates, const DiagramBuilder::Watch& watch) : in{this, "in"} {
    for (const auto& [period, offset] : rates)
      Every(period, offset)
          .Publish()
          .From(clock, in)
          .As([watch](double t, const AnyValues& values) { watch(t, values); });
  }

  AnyInputs in;
};

/// Cuts a part out of a diagram that is not built yet.
class PartCutter {
 public:
  PartCutter(Composite& root, std::string_view path, const std::vector<std::string>& known)
      : root_{root}, top_{std::make_unique<StandIn>()} {
    Flatten(root, blocks_);
    FindPart(path);
    FindKnown(known);
    RunAlong();
    Cut();
    CheckStart();
  }

  std::unique_ptr<Composite> Take(const DiagramBuilder::Watch& watch) {
    MoveKept(root_);
    if (watch) AddWatcher(watch);
    return std::move(top_);
  }

  std::vector<NamedValue> given, computed, changed;
  std::vector<std::string> along, unknown;

 private:
  bool Keeps(const Block* block) const { return kept_.contains(block); }

  bool IsInside(const Block* block) const {
    while (block && block != part_) block = Access::Parent(*block);
    return block;
  }

  void FindPart(std::string_view path) {
    std::vector<std::string> paths;
    for (const Block* block : blocks_) paths.push_back(block->path());
    const auto at = std::ranges::find(paths, path);
    if (at == paths.end())
      throw Error("the diagram has no part '" + std::string(path) + "'" + DidYouMean(path, paths));
    part_ = blocks_[static_cast<std::size_t>(at - paths.begin())];
    for (const Block* block : blocks_)
      if (IsInside(block)) kept_.insert(block);
    for (const Block* block : blocks_)
      if (const Value* moving = IsInside(block) ? Moving(*block) : nullptr)
        throw Error("cannot run " + part_->path() + " by itself: " + moving->describe() +
                    " changes between ticks\nname a part that is sampled" + SampledParts());
  }

  /// Of the part, to choose from.
  std::string SampledParts() const {
    std::string text;
    for (const Block* candidate : blocks_) {
      const bool sampled = std::ranges::none_of(blocks_, [&](const Block* block) {
        for (const Block* b = block; b; b = Access::Parent(*b))
          if (b == candidate) return Moving(*block) != nullptr;
        return false;
      });
      if (sampled && Access::Parent(*candidate) == part_)
        text += (text.empty() ? ": " : ", ") + candidate->path();
    }
    return text;
  }

  void FindKnown(const std::vector<std::string>& known) {
    std::map<std::string, End, std::less<>> values;
    for (const Block* block : blocks_)
      for (int i = 0; i < static_cast<int>(Access::Values(*block).size()); ++i) {
        const End end{block, i};
        values.emplace(end.declared().value->path(), end);
      }
    const std::string inside = part_->path() + ".";
    for (const std::string& path : known) {
      const auto at = values.find(path);
      const std::vector<End> ends = at == values.end() ? std::vector<End>{} : Ends(at->second);
      if (ends.size() != 1) {
        if (path.starts_with(inside)) unknown.push_back(path);
        continue;
      }
      const End& end = ends.front();
      known_.emplace(end, path);
      if (!IsInside(end.block)) continue;
      if (end.declared().kind == Kind::Input) {  // a default: it follows from nothing
        changed.push_back({path, end.declared().value});
        continue;
      }
      computed.push_back({path, end.declared().value});
      computed_.push_back(end);
    }
  }

  /// Adds the blocks that compute what is not known.
  void RunAlong() {
    std::vector<const Block*> reading;
    for (const Block* block : blocks_)
      if (Keeps(block)) reading.push_back(block);
    for (std::size_t i = 0; i < reading.size(); ++i) {
      const Block& reader = *reading[i];
      for (int v = 0; v < static_cast<int>(Access::Values(reader).size()); ++v)
        for (const End& end : Ends({&reader, v})) {
          if (Keeps(end.block) || known_.contains(end) || end.declared().kind == Kind::Input)
            continue;
          CheckComputable(end, {&reader, v});
          kept_.insert(end.block);
          reading.push_back(end.block);
          along.push_back(end.block->path());
        }
    }
  }

  void CheckComputable(const End& from, const End& to) const {
    const Value* moving = Moving(*from.block);
    const bool composite = dynamic_cast<const Composite*>(from.block);
    if (!moving && !composite) return;
    const Value& source = *from.declared().value;
    throw Error("cannot run " + part_->path() + " by itself: what feeds it is not known\n  from  " +
                source.describe() + "\n  to    " + to.declared().value->describe() + "\n" +
                (moving ? moving->path() + " changes between ticks"
                        : from.block->path() + " is a composite with rules of its own") +
                ", so it is not computed again; record " + source.path());
  }

  /// In the place of `block` in the diagram of the part.
  StandIn& StandInOf(const Block& block) {
    if (&block == &root_) return *top_;
    StandIn*& stand_in = stand_ins_[&block];
    if (!stand_in) {
      auto made = std::make_unique<StandIn>();
      stand_in = made.get();
      Access::Keep(StandInOf(*Access::Parent(block)), block.name(), std::move(made));
    }
    return *stand_in;
  }

  End Give(const End& end) {
    const auto [at, is_new] = given_.emplace(end, End{});
    if (is_new) {
      StandIn& stand_in = StandInOf(*end.block);
      at->second = {&stand_in, static_cast<int>(Access::Values(stand_in).size())};
      const Value& value = stand_in.Give(end.declared());
      if (const auto known = known_.find(end); known != known_.end())
        given.push_back({known->second, &value});
    }
    return at->second;
  }

  /// Wires from outside come from where they begin, or from what is given in its place.
  void Cut() {
    for (Block* block : blocks_) {
      if (!Keeps(block)) continue;
      for (auto& declared : Access::Values(*block)) {
        auto wires = std::exchange(declared.from, {});
        for (const auto& wire : wires) {
          if (Keeps(wire.block)) {
            declared.from.push_back(wire);
            continue;
          }
          for (const End& end : Ends({wire.block, wire.value})) {
            const End from = Keeps(end.block) ? end : Give(end);
            declared.from.push_back({from.block, from.value});
          }
        }
      }
    }
  }

  /// What is given is known at ticks, and the start comes before the first.
  void CheckStart() const {
    for (const Block* block : blocks_)
      for (const Rule& rule : Access::Rules(*block)) {
        if (!Keeps(block) || rule.trigger != Trigger::Start || rule.kind != RuleKind::Update)
          continue;
        std::set<End> seen;
        for (const int argument : rule.arguments) FollowBeforeTicks({block, argument}, seen);
        for (const NamedValue& g : given)
          if (std::ranges::any_of(seen, [&](End e) { return e.declared().value == g.value; }))
            throw Error("cannot run " + part_->path() + " by itself: the start of " +
                        block->path() + " follows from " + g.value->path() +
                        ", which is known from the first tick on\nname a part without " +
                        block->path());
      }
  }

  /// Collects what a value follows from before the first tick.
  void FollowBeforeTicks(const End& at, std::set<End>& seen) const {
    if (at.value == kClockIndex) return;
    for (const End& end : Ends(at)) {
      if (!seen.insert(end).second) continue;
      for (const Rule& rule : Access::Rules(*end.block))
        if (rule.kind == RuleKind::Compute && rule.targets[0] == end.value)
          for (const int argument : rule.arguments) FollowBeforeTicks({end.block, argument}, seen);
    }
  }

  void MoveKept(Composite& from) {
    for (std::unique_ptr<Block>& part : Access::Parts(from)) {
      if (Keeps(part.get())) {
        std::string name = part->name();
        Access::Keep(StandInOf(from), std::move(name), std::move(part));
      } else if (auto* inner = dynamic_cast<Composite*>(part.get())) {
        MoveKept(*inner);
      }
    }
  }

  void AddWatcher(const DiagramBuilder::Watch& watch) {
    std::vector<Watcher::Rate> rates;
    for (const Block* block : blocks_) {
      if (!Keeps(block)) continue;
      for (const Rule& rule : Access::Rules(*block)) {
        const Watcher::Rate rate{rule.period, rule.offset};
        if (rule.trigger == Trigger::Periodic && std::ranges::find(rates, rate) == rates.end())
          rates.push_back(rate);
      }
    }
    auto watcher = std::make_unique<Watcher>(rates, watch);
    for (const End& end : computed_)
      Access::Values(*watcher).front().from.push_back({end.block, end.value});
    Access::Keep(*top_, "(watch)", std::move(watcher));  // no name that a block of a user may have
  }

  Composite& root_;
  std::unique_ptr<StandIn> top_;
  std::vector<Block*> blocks_;
  const Block* part_ = nullptr;
  std::set<const Block*> kept_;
  std::map<End, std::string> known_;
  std::vector<End> computed_;
  std::map<End, End> given_;  // and what stands in its place
  std::map<const Block*, StandIn*> stand_ins_;
};

}  // namespace

}  // namespace internal

Part DiagramBuilder::BuildPart(std::string_view path, const std::vector<std::string>& known,
                               Watch watch) {
  root();
  const std::unique_ptr<Root> whole = std::move(root_);
  internal::PartCutter cut(*whole, path, known);
  Diagram diagram(internal::MakePlan(cut.Take(watch)));
  return {std::move(diagram),     std::move(cut.given), std::move(cut.computed),
          std::move(cut.changed), std::move(cut.along), std::move(cut.unknown)};
}

}  // namespace pliant
