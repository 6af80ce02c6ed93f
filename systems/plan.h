#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/systems/composite.h"

/// The flat form of a diagram: what DESIGN calls "flatten once, then run bitsets". Rules that give a
/// value (Compute, held Compute, Derivative) are numbered in topological order, one bit each.
namespace pliant::internal {

/// A set of numbered rules: words [first, first + size) of a bitset.
struct Bits {
  std::uint32_t first = 0;
  std::uint32_t size = 0;
  std::uint32_t pool = 0;  // where its words stand
};

/// A rule bound to its block and its places in the arena.
struct Step {
  RunRule run;
  const void* function;
  const Block* self;
  const std::uint32_t* slots;

  void operator()(std::byte* arena) const { run(function, self, arena, slots); }
};

enum class Role { Computed, Held, Free, Discrete, Continuous, Rate, Next, Scratch };

struct Slot {
  const ValueType* type;
  const void* initial;
  std::uint32_t offset;
  Role role;
  const Value* value;
};

/// Brings what an update wrote to where it is read.
struct Commit {
  const ValueType* type;
  std::uint32_t from, to;
  int source;
  int continuous;  // its number among the continuous values, or −1
};

struct Action {
  Step step;
  const Block* block;
};

/// What happens at one kind of instant: the ticks of a rate, the firing of a guard, the start.
struct Happening {
  Bits held;     ///< held outputs to compute, with all they need
  Bits stale;    ///< what that invalidates, themselves included
  Bits publish_needs, update_needs;
  std::vector<Action> publishes, updates;
  std::vector<Commit> commits;
  bool stops_integration = false;  ///< changes what the derivatives depend on
  bool resets_states = false;      ///< writes Continuous values
};

struct Rate {
  Duration period, offset;
  Happening tick;
};

struct GuardEntry {
  const Value* value;
  std::uint32_t offset;
  int rule;
  Direction direction;
  Happening event;
};

struct ContinuousEntry {
  const ValueType* type;
  const ValueType* rate_type;
  std::uint32_t offset, rate_offset;
  int first, size;  // in the state vector
  const Value* value;
};

struct Plan {
  std::unique_ptr<Composite> root;
  std::vector<const Block*> blocks;

  std::vector<Slot> slots;
  std::vector<Step> steps;
  std::vector<std::uint32_t> places;  // the slots of all steps
  std::vector<const ValueType*> types;
  std::vector<std::uint64_t> pool;
  std::vector<Bits> sources;  // what each source invalidates
  std::uint32_t words = 0;

  std::size_t bytes = 0;          // of the values
  std::uint32_t valid_offset = 0;  // bitset of rules whose value holds
  std::uint32_t state_offset = 0;  // the state vector

  Bits time_dependents, state_dependents, moving_dependents;  // moving: time or state
  Bits derivatives;
  std::vector<ContinuousEntry> continuous;
  int states = 0;

  std::vector<Rate> rates;
  std::vector<GuardEntry> guards;
  Happening start, step;
  Bits initially_valid;
  std::uint64_t fingerprint = 0;  // of all paths and types: what a snapshot must match

  struct RuleName {
    const Block* block;
    const Rule* rule;
  };
  std::vector<RuleName> rule_names;  // of the steps
  std::vector<Bits> needs;           // of the steps

  std::string StateName(int element) const;
};

/// Flattens and checks; throws Error with every fault it finds of the first kind found.
std::unique_ptr<Plan> MakePlan(std::unique_ptr<Composite> root);

/// The way of the kernel's own parts to the private fields of blocks and values.
struct Access {
  static const std::vector<Block::Declared>& Values(const Block& b) { return b.values_; }
  static const std::vector<Rule>& Rules(const Block& b) { return b.rules_; }
  static const std::vector<std::unique_ptr<Block>>& Parts(const Composite& c) { return c.parts_; }
  static const Composite* Parent(const Block& b) { return b.parent_; }
  static const Plan* PlanOf(const Value& v) { return v.plan_; }
  static std::uint32_t Offset(const Value& v) { return v.offset_; }
  static std::int32_t RuleOf(const Value& v) { return v.rule_; }
  static std::int32_t Source(const Value& v) { return v.source_; }
  static const Block& BlockOf(const Value& v) { return *v.block_; }
  static const Block::Declared& Of(const Value& v) {
    return v.block_->values_[static_cast<std::size_t>(v.index_)];
  }
  static const ValueType& TypeOf(const Value& v) { return *Of(v).type; }
};

}  // namespace pliant::internal
