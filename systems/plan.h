#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/systems/composite.h"

/// The flat form of a diagram: what DESIGN calls "flatten once, then run bitsets". Rules that give
/// a value (Compute, held Compute, Derivative) are numbered in topological order, one bit each.
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

/// A rule's function, if it is no larger than a pointer to a member function.
struct alignas(void*) SmallFunction {
  std::byte bytes[2 * sizeof(void*)];
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

/// Says, in a place of its own, whether a run ends.
struct StopRule {
  Step step;
  int number;  // into Plan::endings
};

/// What happens at one kind of instant: the ticks of a rate, the firing of a guard, the start.
struct Happening {
  Bits held;   ///< held outputs to compute, with all they need
  Bits stale;  ///< what that invalidates, themselves included
  Bits publish_needs, update_needs;
  std::vector<Action> publishes, updates;
  std::vector<StopRule> stops;
  std::vector<Commit> commits;
  bool stops_integration = false;  ///< changes states, or what derivatives or guards depend on
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

/// A rule that may end a run.
struct Ending {
  std::string block;  // its path
  std::string reason;
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
  std::vector<SmallFunction> functions;  // of the steps, close together
  std::vector<std::uint32_t> places;     // the slots of all steps
  std::vector<const ValueType*> types;
  std::vector<std::uint64_t> pool;
  std::vector<Bits> sources;  // what each source invalidates
  std::uint32_t words = 0;

  std::size_t bytes = 0;           // of the arena
  std::size_t alignment = 64;      // of the arena
  std::uint32_t valid_offset = 0;  // bitset of rules whose value holds
  std::uint32_t state_offset = 0;  // the state vector

  Bits moving_dependents;  // on time or state
  Bits derivatives;
  std::vector<ContinuousEntry> continuous;
  int states = 0;

  std::vector<Rate> rates;
  std::vector<GuardEntry> guards;
  Happening start, step;
  std::vector<Ending> endings;
  std::uint32_t stop_offset = 0;  // the answer of a rule that may end the run, if there is one
  Bits initially_valid;
  std::uint64_t fingerprint = 0;  // what a snapshot must match

  struct RuleName {
    const Block* block;
    const Rule* rule;
  };
  std::vector<RuleName> rule_names;  // of the steps
  std::vector<Bits> needs;           // of the steps

  std::string StateName(int element) const;
};

/// Throws Error unless the spaces at the two ends of a wire agree, or one says nothing.
void CheckSpaces(const Value& from, const Value& to);

/// A hash (FNV-1a), continued with more text.
inline constexpr std::uint64_t kFingerprintSeed = 14695981039346656037u;
inline std::uint64_t Mixed(std::uint64_t hash, std::string_view text) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

/// Flattens and checks; throws Error with every fault it finds of the first kind found.
std::unique_ptr<Plan> MakePlan(std::unique_ptr<Composite> root);

/// The way of the kernel's own parts to the private fields of blocks and values.
struct Access {
  static const std::vector<Block::Declared>& Values(const Block& b) { return b.values_; }
  static const std::vector<Rule>& Rules(const Block& b) { return b.rules_; }
  static std::vector<Block::Declared>& Values(Block& b) { return b.values_; }
  static const std::vector<std::unique_ptr<Block>>& Parts(const Composite& c) { return c.parts_; }
  static std::vector<std::unique_ptr<Block>>& Parts(Composite& c) { return c.parts_; }
  static void Keep(Composite& c, std::string name, std::unique_ptr<Block> part) {
    c.Keep(std::move(name), std::move(part));
  }
  static int Number(const Block& b) { return b.number_; }
  static const Composite* Parent(const Block& b) { return b.parent_; }
  static const Plan* PlanOf(const Value& v) { return v.plan_; }
  static std::uint32_t Offset(const Value& v) { return v.offset_; }
  static std::int32_t RuleOf(const Value& v) { return v.rule_; }
  static std::int32_t Source(const Value& v) { return v.source_; }
  static std::int32_t State(const Value& v) { return v.state_; }
  static const Block& BlockOf(const Value& v) { return *v.block_; }
  static const Block::Declared& Of(const Value& v) {
    return v.block_->values_[static_cast<std::size_t>(v.index_)];
  }
  static const ValueType& TypeOf(const Value& v) { return *Of(v).type; }
  /// Before the diagram is built.
  static void SetInitial(const Value& v, std::shared_ptr<const void> initial) {
    v.block_->values_[static_cast<std::size_t>(v.index_)].initial = std::move(initial);
  }
};

}  // namespace pliant::internal
