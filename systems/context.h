#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pliant/systems/plan.h"

namespace pliant {

/// Everything of a diagram that changes, in one arena: its values, which of them hold, the
/// continuous state as one vector, the time and the next ticks. A copy is a snapshot; equality is
/// bit for bit, of the state and not of what follows from it or of workspaces.
///
/// Reading evaluates what is needed and not valid. A context belongs to one thread; the diagram it
/// was made from must outlive it and may be shared.
class Context {
 public:
  explicit Context(const internal::Plan& plan);
  Context(const Context& other);
  Context& operator=(const Context& other);
  Context(Context&& other) noexcept;
  ~Context();

  bool operator==(const Context& other) const;

  /// [s]
  double time() const { return *reinterpret_cast<const double*>(arena_); }

  /// The value of a port or a state, evaluated if it does not hold.
  template <class V>
  const typename V::Signal& Get(const V& value) {
    Check(value);
    const std::int32_t rule = internal::Access::RuleOf(value);
    if (rule >= 0 && !IsValid(rule)) Evaluate(plan_->needs[static_cast<std::size_t>(rule)]);
    return internal::At<typename V::Signal>(arena_, internal::Access::Offset(value));
  }

  /// Gives an unconnected input, or a state, a value; what depends on it follows.
  template <class V>
  void Set(const V& value, const typename V::Signal& x) {
    CheckSettable(value);
    internal::At<typename V::Signal>(arena_, internal::Access::Offset(value)) = x;
    Changed(value);
  }

  /// Number of rules run since the context was made, for measuring what an evaluation costs.
  std::uint64_t rules_run() const { return rules_run_; }

  std::span<double> state() { return {StateData(), static_cast<std::size_t>(plan_->states)}; }

  /// Bytes of the arena and of the time line.
  std::size_t bytes() const;

  /// Writes everything that changes to a file that Load reads back bit for bit, on a machine of the
  /// same kind and with the same diagram. A failed Save leaves an older file as it was.
  void Save(const std::filesystem::path& file) const;
  void Load(const std::filesystem::path& file);

 private:
  friend class Simulator;
  friend class Diagram;

  struct TimeLine {
    std::vector<std::int64_t> next_tick;  ///< k of each rate
    std::vector<std::int64_t> due;        ///< and its time [ns]
    std::vector<double> side;             ///< of zero each guard was seen on last
    std::vector<double> fired;            ///< when each guard fired last [s]
    std::vector<int> quick;               ///< firings in quick succession
    double step = 0;                      ///< the integrator's next step size [s]
    bool started = false;
    bool operator==(const TimeLine&) const = default;
  };

  void Check(const internal::Value& value) const {
    if (internal::Access::PlanOf(value) != plan_) ThrowNotHere(value);
  }
  [[noreturn]] void ThrowNotHere(const internal::Value& value) const;
  void CheckSettable(const internal::Value& value) const;
  void Changed(const internal::Value& value);

  std::uint64_t* Valid() { return reinterpret_cast<std::uint64_t*>(arena_ + plan_->valid_offset); }
  double* StateData() { return reinterpret_cast<double*>(arena_ + plan_->state_offset); }
  bool IsValid(std::int32_t rule) { return Valid()[rule / 64] >> (rule % 64) & 1; }

  void Invalidate(const internal::Bits& bits) {
    const std::uint64_t* words = plan_->pool.data() + bits.pool;
    std::uint64_t* valid = Valid() + bits.first;
    for (std::uint32_t w = 0; w < bits.size; ++w) valid[w] &= ~words[w];
  }

  /// The word w of a set of rules.
  std::uint64_t Word(const internal::Bits& bits, std::uint32_t w) const {
    return w < bits.first || w >= bits.first + bits.size ? 0 : plan_->pool[bits.pool + w - bits.first];
  }

  /// Runs those of the 64 rules of word w that do not hold, in order.
  void RunWord(std::uint32_t w, std::uint64_t needed) {
    std::uint64_t& valid = Valid()[w];
    std::uint64_t run = needed & ~valid;
    if (!run) return;
    const internal::Step* steps = plan_->steps.data() + 64 * static_cast<std::size_t>(w);
    rules_run_ += static_cast<std::uint64_t>(std::popcount(run));
    for (; run; run &= run - 1) steps[std::countr_zero(run)](arena_);
    valid |= needed;
  }

  void Evaluate(const internal::Bits& needed) {
    const std::uint64_t* words = plan_->pool.data() + needed.pool;
    for (std::uint32_t w = 0; w < needed.size; ++w) RunWord(needed.first + w, words[w]);
  }

  void CommitUpdates(const internal::Happening& h);

  void SetTime(double t) { *reinterpret_cast<double*>(arena_) = t; }
  void LoadState(const double* x);   // from the state vector into the typed values
  void StoreState(int continuous);   // the other way
  bool Holds(double t, const double* x);

  void Allocate();
  void CopyValues(const Context& other);

  const internal::Plan* plan_;
  std::byte* arena_ = nullptr;
  TimeLine line_;
  std::uint64_t rules_run_ = 0;
};

}  // namespace pliant
