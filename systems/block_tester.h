#pragma once

#include <concepts>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace internal {

/// Inputs of a block that nothing is wired to and that have no default.
std::vector<const Value*> RequiredInputs(const Block& block);

/// Throws Error if a value depends on one of `unset`, through any rules and states.
void RequireSet(const Value& value, const std::vector<const Value*>& unset);

}  // namespace internal

/// Runs one block by itself, its inputs set by hand:
///
///   BlockTester<LowPass<JointVelocity>> t({.space = joints, .cutoff_hz = 5, .period = 1ms});
///   t.Set(t->u, {1.0, -2.0});
///   t.Tick();
///   EXPECT_NEAR(t.Get(t->y)(0), 1 - std::exp(-2 * std::numbers::pi * 5 * 1e-3), 1e-15);
///
/// What is Set before the first run is there when the run starts. An output that depends on a
/// required input is read only after that was Set.
template <class T>
class BlockTester {
 public:
  template <class B = T>
  explicit BlockTester(const typename B::Options& options, const Simulator::Options& run = {})
      : block_{builder_.Add<T>("block", options)},
        run_{run},
        inputs_{internal::RequiredInputs(block_)},
        unset_{inputs_} {}
  template <class... A>
  requires std::constructible_from<T, A...>
  explicit BlockTester(A&&... arguments)
      : block_{builder_.Add<T>("block", std::forward<A>(arguments)...)},
        inputs_{internal::RequiredInputs(block_)},
        unset_{inputs_} {}

  T* operator->() { return &block_; }
  T& operator*() { return block_; }

  /// Sets an input, or a state.
  template <class V>
  void Set(const V& value, const typename V::Signal& x) {
    std::erase(unset_, &value);
    if (sim_)
      sim_->Set(value, x);
    else
      internal::Access::SetInitial(
          value, internal::Initial(value.name(), internal::Access::Of(value).space, x));
  }

  /// Joins x to a list, and returns the input to Set it by. Only before the first run.
  template <class S>
  const Input<S>& Join(InputList<S>& list, const std::type_identity_t<S>& x) {
    return Add<S>(list, {.value = x});
  }
  template <class S>
  const Input<S>& Join(AnyInputs& list, const S& x,
                       const typename Input<S>::SpaceType& space = {}) {
    return Add<S>(list, {.space = space, .value = x});
  }

  /// To time t [s], and not through the events at t.
  void AdvanceTo(double t) { simulator().AdvanceTo(t); }
  /// To the next tick, and through it.
  void Tick() { simulator().AdvanceThroughTick(); }

  template <class V>
  const typename V::Signal& Get(const V& value) {
    internal::RequireSet(value, unset_);
    return simulator().Get(value);
  }

  /// What a test gives values to: required inputs, and those that joined a list.
  const std::vector<const internal::Value*>& inputs() const { return inputs_; }

  double time() { return simulator().time(); }

  /// The first call builds the diagram and starts the run.
  Simulator& simulator() {
    if (!sim_) {
      for (const internal::Value* input : unset_)
        if (const auto& stand_in = internal::Access::Of(*input).stand_in)
          internal::Access::SetInitial(*input, stand_in);
      diagram_.emplace(builder_.Build());
      sim_.emplace(*diagram_, run_);
    }
    return *sim_;
  }

 private:
  template <class S, class List>
  const Input<S>& Add(List& list, const typename Constant<S>::Options& options) {
    auto& source = builder_.Add<Constant<S>>("joined_" + std::to_string(++joined_), options);
    builder_.Connect(source.y, list);
    inputs_.push_back(&source.value);
    return source.value;
  }

  DiagramBuilder builder_;
  T& block_;
  Simulator::Options run_ = {};
  std::vector<const internal::Value*> inputs_, unset_;
  int joined_ = 0;
  std::optional<Diagram> diagram_;
  std::optional<Simulator> sim_;
};

}  // namespace pliant
