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
  Context& operator=(Context&& other) noexcept;
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

  template <class S>
  void Get(const InputList<S>&) = delete;  // it is many values

  /// Gives an unconnected input, a state or a held output a value; what depends on it follows. NaN
  /// is a value like any other.
  template <class V>
  void Set(const V& value, const typename V::Signal& x) {
    CheckSettable(value);
    auto& held = internal::At<typename V::Signal>(arena_, internal::Access::Offset(value));
    if constexpr (internal::Dense<typename V::Signal>)
      if (x.rows() != held.rows() || x.cols() != held.cols())
        ThrowShape(value, held.size(), x.size());
    held = x;
    Changed(value);
  }

  /// The numbers of a value of any type made of numbers, in the order of a log's columns.
  void GetNumbers(const internal::Value& value, std::span<double> numbers);
  /// Sets them, of an unconnected input or a state.
  void SetNumbers(const internal::Value& value, std::span<const double> numbers);

  /// Number of rules run since the context was made, for measuring what an evaluation costs.
  std::uint64_t rules_run() const { return rules_run_; }

  std::span<double> state() { return {StateData(), static_cast<std::size_t>(plan_->states)}; }
  /// ẋ, in the order of the state.
  void Derivatives(std::span<double> rates);

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
    /// The step to try after an event [s]: what the integrator proposed after the first step behind
    /// the last one, where the transients of a sampled input are.
    double step = 0;
    bool started = false;
    int ended_by = -1;  ///< into the endings of the plan; −1: the run goes on
    bool operator==(const TimeLine&) const = default;
  };

  void Check(const internal::Value& value) const {
    if (internal::Access::PlanOf(value) != plan_) ThrowNotHere(value);
  }
  [[noreturn]] void ThrowNotHere(const internal::Value& value) const;
  [[noreturn]] static void ThrowShape(const internal::Value& value, Eigen::Index expected,
                                      Eigen::Index found);
  void CheckSettable(const internal::Value& value) const {
    Check(value);
    if (internal::Access::Source(value) < 0) ThrowNotSettable(value);
  }
  [[noreturn]] static void ThrowNotSettable(const internal::Value& value);
  void CheckNumbers(const internal::Value& value, std::size_t count) const;
  void Changed(const internal::Value& value) {
    Invalidate(plan_->sources[static_cast<std::size_t>(internal::Access::Source(value))]);
    if (internal::Access::State(value) >= 0) StoreState(internal::Access::State(value));
  }

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
    return w < bits.first || w >= bits.first + bits.size ? 0
                                                         : plan_->pool[bits.pool + w - bits.first];
  }

  /// Runs those of the 64 rules of word w that do not hold, in order.
  void RunWord(std::uint32_t w, std::uint64_t needed) {
    std::uint64_t& valid = Valid()[w];
    std::uint64_t run = needed & ~valid;
    if (!run) return;
    const internal::Step* steps = plan_->steps.data() + 64 * static_cast<std::size_t>(w);
    for (; run; run &= run - 1, ++rules_run_) steps[std::countr_zero(run)](arena_);
    valid |= needed;
  }

  void Evaluate(const internal::Bits& needed) {
    const std::uint64_t* words = plan_->pool.data() + needed.pool;
    for (std::uint32_t w = 0; w < needed.size; ++w) RunWord(needed.first + w, words[w]);
  }

  void CommitUpdates(const internal::Happening& h);
  void StoreState(int continuous);  // from the typed value into the state vector
  void StoreRates(std::span<double> rate) const;

  void SetTime(double t) { *reinterpret_cast<double*>(arena_) = t; }
  void MoveTo(double t, std::span<const double> state);
  void ResetValid();
  void CopyBehindValues(const Context& other);

  /// With an arena of nothing yet: a constructor that goes on to fill it may throw.
  explicit Context(const internal::Plan* plan);
  void Construct(const void* from);

  const internal::Plan* plan_;
  std::byte* arena_ = nullptr;
  std::size_t constructed_ = 0;  // slots
  TimeLine line_;
  std::uint64_t rules_run_ = 0;
};

}  // namespace pliant
