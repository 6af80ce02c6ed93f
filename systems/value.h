#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pliant/systems/error.h"
#include "pliant/systems/value_type.h"

namespace pliant {

class Block;
class Composite;
class Context;

namespace internal {

struct Plan;
class PlanBuilder;
struct Access;

enum class Kind { Input, InputList, Output, Discrete, Continuous, Scratch };

/// Names make paths, columns of logs and pictures: letters, digits, '_' and '-'.
void CheckName(std::string_view whose, const std::string& name);

/// A value that is wired to AnyInputs, under the name it has there.
struct Source {
  std::string path;
  const ValueType* type;
  Space space;
  const void* initial;
};

/// What every value knows: its block, its place there and, once built, its place in a context.
class Value {
 public:
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;

  const std::string& name() const;
  std::string path() const;  ///< such as "arm.position"
  /// Such as "arm.position : joint position [rad] (shoulder, elbow)".
  std::string describe() const;

 protected:
  Value(Block* block, std::string_view name, Kind kind, const ValueType* type, const Space& space,
        std::shared_ptr<const void> initial, const ValueType* rate_type = nullptr,
        std::shared_ptr<const void> rate = nullptr);

  /// What a required input holds while its block is tested by itself.
  void StandIn(std::shared_ptr<const void> value);

  using Shape = std::function<std::shared_ptr<const void>(const std::vector<Source>&)>;
  /// The initial value is made when the diagram is built, from what is wired to `inputs`.
  void ShapedBy(const Value& inputs, Shape shape);

 private:
  friend class pliant::Block;
  friend class pliant::Composite;
  friend struct Plan;
  friend class PlanBuilder;
  friend struct Access;
  friend class pliant::Context;

  Block* block_;
  int index_;
  const Plan* plan_ = nullptr;
  std::uint32_t offset_ = 0;  // in the arena
  std::int32_t rule_ = -1;    // that computes it, in the plan's numbering
  std::int32_t source_ = -1;  // what it changes, if it can be set
  std::int32_t state_ = -1;   // its number among the continuous values
};

/// The rate of a signal: ẋ of x.
template <class S>
struct RateOf {
  static_assert(!std::is_same_v<S, S>,
                "a Continuous value needs a rate: give its signal a type Rate");
};
template <class S>
requires requires { typename S::Rate; }
struct RateOf<S> {
  using type = typename S::Rate;
};
template <>
struct RateOf<double> {
  using type = double;
};
template <>
struct RateOf<PerJoint> {
  using type = PerJoint;
};

template <class S>
std::shared_ptr<const void> Initial(std::string_view name, const Space& space, S value) {
  if constexpr (Dense<S> && std::is_same_v<typename SpaceOf<S>::type, Joints>)
    if (space.size() != 0 && value.rows() != space.size())
      throw Error("the value of '" + std::string(name) + "' has a number for each of " +
                  space.text() + ", got " + Text(value.rows()));
  return std::make_shared<const S>(std::move(value));
}

}  // namespace internal

/// A value a block reads and another block or the user provides. Without a default it must be
/// connected.
template <class S>
class Input : public internal::Value {
 public:
  using Signal = S;
  using SpaceType = typename internal::SpaceOf<S>::type;
  Input(Block* block, std::string_view name, const SpaceType& space = {})
      : Value(block, name, internal::Kind::Input, internal::TypeOf<S>(), space, nullptr) {
    if constexpr (std::is_default_constructible_v<S> || requires { S::Zero(space); })
      StandIn(std::make_shared<const S>(internal::ZeroOf<S>(space)));
  }
  Input(Block* block, std::string_view name, const SpaceType& space, S value_when_unconnected)
      : Value(block, name, internal::Kind::Input, internal::TypeOf<S>(), space,
              internal::Initial<S>(name, space, std::move(value_when_unconnected))) {}
};

/// What a rule sees of an InputList: the joined values in the order of their wires.
template <class S>
class Joined {
 public:
  Joined(const std::byte* arena, const std::uint32_t* offsets, std::uint32_t size)
      : arena_{arena}, offsets_{offsets}, size_{size} {}
  int size() const { return static_cast<int>(size_); }
  const S& operator[](int i) const {
    return *std::launder(reinterpret_cast<const S*>(arena_ + offsets_[i]));
  }

 private:
  const std::byte* arena_;
  const std::uint32_t* offsets_;
  std::uint32_t size_;
};

/// An input that any number of outputs may join, none included.
template <class S>
class InputList : public internal::Value {
 public:
  using Signal = S;
  using SpaceType = typename internal::SpaceOf<S>::type;
  InputList(Block* block, std::string_view name, const SpaceType& space = {})
      : Value(block, name, internal::Kind::InputList, internal::TypeOf<S>(), space, nullptr) {}
};

/// What a rule sees of AnyInputs: values of any types.
class AnyValues {
 public:
  AnyValues(const std::byte* arena, const std::uint32_t* offsets, std::uint32_t size,
            const internal::ValueType* const* types)
      : arena_{arena}, offsets_{offsets}, size_{size}, types_{types} {}
  int size() const { return static_cast<int>(size_); }
  const internal::ValueType& type(int i) const { return *types_[i]; }
  const void* operator[](int i) const { return arena_ + offsets_[i]; }

 private:
  const std::byte* arena_;
  const std::uint32_t* offsets_;
  std::uint32_t size_;
  const internal::ValueType* const* types_;
};

/// An input that any values of any types may join, as a logger has it.
class AnyInputs : public internal::Value {
 public:
  AnyInputs(Block* block, std::string_view name)
      : Value(block, name, internal::Kind::InputList, nullptr, {}, nullptr) {}
};

/// A value a block shows. Ruled by `Compute` it follows its arguments at every instant; ruled by
/// `Every(h).Compute` it is held between its ticks, and `before` is its value until the first.
template <class S>
class Output : public internal::Value {
 public:
  using Signal = S;
  using SpaceType = typename internal::SpaceOf<S>::type;
  Output(Block* block, std::string_view name, const SpaceType& space = {})
      : Output(block, name, space, internal::ZeroOf<S>(space)) {}
  Output(Block* block, std::string_view name, const SpaceType& space, S before)
      : Value(block, name, internal::Kind::Output, internal::TypeOf<S>(), space,
              internal::Initial<S>(name, space, std::move(before))) {}
};

/// State that events change: the memory of a true delay, a mode, a warm start.
template <class S>
class Discrete : public internal::Value {
 public:
  using Signal = S;
  using SpaceType = typename internal::SpaceOf<S>::type;
  Discrete(Block* block, std::string_view name, const SpaceType& space = {})
      : Discrete(block, name, space, internal::ZeroOf<S>(space)) {}
  Discrete(Block* block, std::string_view name, const SpaceType& space, S initial)
      : Value(block, name, internal::Kind::Discrete, internal::TypeOf<S>(), space,
              internal::Initial<S>(name, space, std::move(initial))) {}
};

/// State that is integrated; ruled by `Derivative`, and events may reset it.
template <class S>
class Continuous : public internal::Value {
 public:
  using Signal = S;
  using Rate = typename internal::RateOf<S>::type;
  using SpaceType = typename internal::SpaceOf<S>::type;
  Continuous(Block* block, std::string_view name, const SpaceType& space = {})
      : Continuous(block, name, space, internal::ZeroOf<S>(space)) {}
  Continuous(Block* block, std::string_view name, const SpaceType& space, S initial)
      : Value(block, name, internal::Kind::Continuous, internal::TypeOf<S>(), space,
              internal::Initial<S>(name, space, std::move(initial)), internal::TypeOf<Rate>(),
              internal::Initial<Rate>(name, space, internal::ZeroOf<Rate>(space))) {}
};

/// A workspace of a rule, one per context: never part of the state, never copied with it. A rule
/// gets it to write to, and no result may depend on what it held before.
template <class S>
class Scratch : public internal::Value {
 public:
  using Signal = S;
  Scratch(Block* block, std::string_view name, S fresh = {})
      : Value(block, name, internal::Kind::Scratch, internal::TypeOf<S>(), {},
              internal::Initial<S>(name, {}, std::move(fresh))) {}

  /// Made when the diagram is built, for what is wired to `inputs`.
  template <class Make>
  Scratch(Block* block, std::string_view name, const AnyInputs& inputs, Make make)
      : Value(block, name, internal::Kind::Scratch, internal::TypeOf<S>(), {}, nullptr) {
    ShapedBy(inputs, [make = std::move(make)](const std::vector<internal::Source>& sources) {
      return std::make_shared<const S>(make(sources));
    });
  }
};

/// The time [s], for rules to read as a double.
struct Clock {};

}  // namespace pliant
