#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/systems/plan.h"

namespace pliant::internal {

/// Makes a Plan, once: finds blocks, values and rules, puts the rules in order, binds them to their
/// places, finds what each needs and what each source makes stale, and lays out the arena.
class PlanBuilder {
 public:
  explicit PlanBuilder(std::unique_ptr<Composite> root) { plan_->root = std::move(root); }
  std::unique_ptr<Plan> Build();

 private:
  using Row = std::vector<std::uint64_t>;  // a bit for each numbered rule

  /// A value during the build; indices run over all values of all blocks.
  struct Node {
    const Block* block;
    const Block::Declared* declared;
    std::vector<int> rules = {};    // Compute, Held and Derivative rules that give it
    std::vector<int> updates = {};  // into happenings_
    int slot = -1, rate_slot = -1, next_slot = -1;
    int source = -1;
    int rule = -1;
    int continuous = -1;  // into plan_->continuous
  };
  struct Numbered {
    const Block* block;
    const Rule* rule;
    std::vector<int> reads = {};  // numbered rules whose values it reads
    int number = -1;
  };
  struct HappeningRule {
    const Block* block;
    const Rule* rule;
  };

  // What there is: plan.cc
  void Flatten(Composite* composite);
  void AddBlock(Block* block);
  void CheckWires();
  void ShapeValues();
  void CollectRules();
  void CheckUpdate(Node& node, const Rule& rule);
  void CheckRuled();
  void Sort();
  [[noreturn]] void ThrowLoop();

  // Where it stands: layout.cc
  void Place();
  void PlaceContinuous(Node& node);
  void Bind();
  std::size_t BindPlaces(const Block& block, const Rule& rule);
  void BindList(const Node& list);
  void Layout();
  void LayOutHappening(Happening& h);
  void Publish(const Node& node);
  std::uint64_t Fingerprint() const;

  // What needs what, and when it happens: schedule.cc
  void Needs();
  void Stale();
  void Summarize();
  void Schedule();
  void AddGuard(const Block& block, const Rule& rule);
  template <class Belongs>
  Happening Happens(const Belongs& belongs);
  void AddAction(std::size_t happening, Happening& h);
  void AddNeeds(const Block& block, const Rule& rule, Row& row);
  bool IsWatched(const Bits& stale) const;

  int Index(const Block& block, int value) const {
    return base_[static_cast<std::size_t>(block.number_)] + value;
  }
  Node& At(int i) { return nodes_[static_cast<std::size_t>(i)]; }
  Numbered& RuleOf(int i) { return rules_[static_cast<std::size_t>(i)]; }
  const Numbered& Ordered(int number) const {
    return rules_[static_cast<std::size_t>(order_[static_cast<std::size_t>(number)])];
  }
  bool IsHeld(int number) const { return Ordered(number).rule->kind == RuleKind::Held; }

  /// The values a value stands for: itself, or what is wired to it.
  void Resolve(int i, std::vector<int>& out);
  int ResolveOne(int i);
  int NewSlot(const ValueType* type, const void* initial, Role role, const Value* value);

  Row Empty() const { return Row(plan_->words, 0); }
  Bits Keep(const Row& row) { return Keep(row, plan_->pool); }
  static Bits Keep(const Row& row, std::vector<std::uint64_t>& pool);
  void Or(Row& to, const Bits& from) const;

  std::unique_ptr<Plan> plan_ = std::make_unique<Plan>();
  std::vector<Block*> blocks_;
  std::vector<int> base_;  // of each block's values in nodes_
  std::vector<Node> nodes_;
  std::vector<Numbered> rules_;
  std::vector<HappeningRule> happenings_;
  std::vector<int> order_;  // rules by number
  std::vector<std::size_t> begins_, happening_begins_;
  std::vector<bool> is_slot_;                                    // of each place
  std::vector<std::pair<std::size_t, std::size_t>> type_lists_;  // place, index into plan_->types
  Row watched_;                                                  // what derivatives and guards need
  int sources_ = 0;
  int stop_slot_ = -1;
};

}  // namespace pliant::internal
