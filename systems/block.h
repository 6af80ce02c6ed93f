#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/systems/error.h"
#include "pliant/systems/time.h"
#include "pliant/systems/value.h"

namespace pliant {

/// Which way a guard must pass zero to fire. Reaching zero counts as passing; starting at zero does
/// not.
enum class Direction { Rising, Falling, Both };

namespace internal {

enum class RuleKind { Compute, Held, Derivative, Update, Publish, Stop };
enum class Trigger { None, Periodic, Guard, Start, Step };

using RunRule = void (*)(const void* function, const Block* self, std::byte* arena,
                         const std::uint32_t* slots);

inline constexpr int kClockIndex = -1;

struct Rule {
  RuleKind kind = RuleKind::Compute;
  Trigger trigger = Trigger::None;
  Duration period, offset;
  int guard = 0;
  Direction direction = Direction::Both;
  std::vector<int> targets;
  std::vector<int> arguments;  // indices of the block's values, or kClockIndex
  RunRule run = nullptr;
  std::shared_ptr<const void> function;
  std::size_t function_size = 0;  // if it may be copied byte by byte
  std::string reason;             // why it stops a run
};

template <class T>
T& At(std::byte* arena, std::uint32_t offset) {
  return *std::launder(reinterpret_cast<T*>(arena + offset));
}

/// How a rule receives a value of each kind; `Get` finds it in the arena.
template <class V>
struct Argument {
  using S = typename V::Signal;
  using type = const S&;
  static type Get(std::byte* arena, const std::uint32_t* slots, std::size_t i) {
    return At<S>(arena, slots[i]);
  }
};
template <class S>
struct Argument<Scratch<S>> {
  using type = S&;
  static type Get(std::byte* arena, const std::uint32_t* slots, std::size_t i) {
    return At<S>(arena, slots[i]);
  }
};
template <class S>
struct Argument<InputList<S>> {
  using type = Joined<S>;
  static type Get(std::byte* arena, const std::uint32_t* slots, std::size_t i) {
    const std::uint32_t* list = slots + slots[i];
    return {arena, list + 1, list[0]};
  }
};
template <>
struct Argument<AnyInputs> {
  using type = AnyValues;
  static type Get(std::byte* arena, const std::uint32_t* slots, std::size_t i) {
    const std::uint32_t* list = slots + slots[i];
    const ValueType* const* types;  // stored behind the offsets, where the plan put them
    std::memcpy(&types, list + 1 + list[0], sizeof(types));
    return {arena, list + 1, list[0], types};
  }
};
template <>
struct Argument<Clock> {
  using type = double;
  static type Get(std::byte* arena, const std::uint32_t*, std::size_t) {
    return At<double>(arena, 0);  // the clock is the first value of every arena
  }
};

template <class V>
constexpr bool IsState = false;
template <class S>
constexpr bool IsState<Discrete<S>> = true;
template <class S>
constexpr bool IsState<Continuous<S>> = true;

template <class R>
constexpr bool IsExpression = false;
template <class R>
requires requires { typename R::PlainObject; }
constexpr bool IsExpression<R> =
    !std::is_base_of_v<Eigen::PlainObjectBase<typename R::PlainObject>, R>;

template <class F>
struct MemberOf {
  using type = void;
};
template <class R, class C, class... A>
struct MemberOf<R (C::*)(A...) const> {
  using type = C;
};
template <class R, class C, class... A>
struct MemberOf<R (C::*)(A...) const noexcept> {
  using type = C;
};
template <class R, class C, class... A>
struct MemberOf<R (C::*)(A...)> {
  using type = C;
  static_assert(!std::is_same_v<C, C>, "a rule is a const function: values in, value out");
};

template <class F, class... X>
decltype(auto) Call(const void* function, const Block* self, X&&... x);
template <class F, class... X>
constexpr bool Callable();

template <class Targets, class Arguments>
class RuleAs;

/// `From` of a rule: the values it reads, in the order of the function's parameters.
template <class... T>
class [[nodiscard]] RuleFrom {
 public:
  RuleFrom(Block* block, Rule rule) : block_{block}, rule_{std::move(rule)} {}

  template <class... V>
  auto From(const V&... values) &&;

 private:
  Block* block_;
  Rule rule_;
};

template <class... T, class... V>
class [[nodiscard]] RuleAs<std::tuple<T...>, std::tuple<V...>> {
 public:
  RuleAs(Block* block, Rule rule) : block_{block}, rule_{std::move(rule)} {}

  /// The function: a const member function of the block, or a lambda that captures nothing. It
  /// takes the values named in From and returns what is ruled (a std::tuple if there are several),
  /// or takes references to what is ruled first and writes in place.
  template <class F>
  void As(F f) &&;

 private:
  template <class F, bool kReturns, bool kFresh>
  static void Run(const void* function, const Block* self, std::byte* arena,
                  const std::uint32_t* slots);

  Block* block_;
  Rule rule_;
};

}  // namespace internal

/// Named values and the rules between them. A block overrides nothing: its constructor declares
/// values, then rules, and a rule's arguments are its dependencies.
class Block {
 public:
  virtual ~Block() = default;
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  const std::string& name() const { return name_; }
  std::string path() const;  ///< "arm" or, nested, "station.arm"

 protected:
  Block() = default;

  /// y follows its arguments.
  template <class S>
  internal::RuleFrom<S> Compute(const Output<S>& y) {
    return {this, NewRule(internal::RuleKind::Compute, y)};
  }

  /// ẋ. The rate of a JointPosition is a JointVelocity, and so on.
  template <class S>
  internal::RuleFrom<typename Continuous<S>::Rate> Derivative(const Continuous<S>& x) {
    return {this, NewRule(internal::RuleKind::Derivative, x)};
  }

  /// What happens at an event: updates of state, read before any is written, and publishing.
  class [[nodiscard]] Event {
   public:
    template <class... V>
    internal::RuleFrom<typename V::Signal...> Update(const V&... x) const {
      static_assert((internal::IsState<V> && ...),
                    "an event updates Discrete and Continuous values");
      return {block_, Make(internal::RuleKind::Update, x...)};
    }
    /// The only rules with side effects. They run after held outputs and before updates.
    internal::RuleFrom<> Publish() const { return {block_, Make(internal::RuleKind::Publish)}; }

   protected:
    friend class Block;
    Event(Block* block, internal::Rule rule) : block_{block}, rule_{std::move(rule)} {}

    template <class... V>
    internal::Rule Make(internal::RuleKind kind, const V&... targets) const {
      internal::Rule rule = rule_;
      rule.kind = kind;
      rule.targets = {block_->IndexOf(targets)...};
      return rule;
    }

    Block* block_;
    internal::Rule rule_;
  };

  /// An event that may be the last of a run.
  class [[nodiscard]] TimedEvent : public Event {
   public:
    /// The run ends here, if the function says so. It is asked when rules publish; all that happens
    /// at this instant still happens. Simulator::ended() tells the reason, one sentence without a
    /// full stop.
    internal::RuleFrom<bool> StopIf(std::string reason) const {
      return {block_, MakeStop(std::move(reason))};
    }
    /// The run ends here.
    void Stop(std::string reason) const;

   protected:
    friend class Block;
    using Event::Event;

   private:
    internal::Rule MakeStop(std::string reason) const;
  };

  class [[nodiscard]] PeriodicEvent : public TimedEvent {
   public:
    /// y is held: computed at each tick in the order of the signals, and it may read its last
    /// value.
    template <class S>
    internal::RuleFrom<S> Compute(const Output<S>& y) const {
      return {block_, Make(internal::RuleKind::Held, y)};
    }

   private:
    friend class Block;
    using TimedEvent::TimedEvent;
  };

  class [[nodiscard]] Guard {
   public:
    TimedEvent Crosses(Direction direction) const {
      internal::Rule rule = rule_;
      rule.direction = direction;
      return {block_, std::move(rule)};
    }

   private:
    friend class Block;
    Guard(Block* block, internal::Rule rule) : block_{block}, rule_{std::move(rule)} {}
    Block* block_;
    internal::Rule rule_;
  };

  /// Ticks at offset + k·period, k = 0, 1, …
  PeriodicEvent Every(Duration period, Duration offset = {});

  /// The instant the output passes zero.
  Guard When(const Output<double>& guard);

  /// Once, before the first tick.
  Event AtStart();

  /// After every step of the integrator.
  Event AtEveryStep();

  /// Publishes every h: short for Every(period).Publish().
  internal::RuleFrom<> Publish(Duration period) { return Every(period).Publish(); }

  static constexpr Clock clock{};

 private:
  friend class internal::Value;
  friend class Composite;
  friend struct internal::Plan;
  friend class internal::PlanBuilder;
  friend struct internal::Access;
  template <class...>
  friend class internal::RuleFrom;
  template <class, class>
  friend class internal::RuleAs;

  struct Wire {
    const Block* block;
    int value;
  };
  struct Declared {
    internal::Kind kind;
    std::string name;
    const internal::ValueType* type;
    Space space;
    std::shared_ptr<const void> initial;
    internal::Value* value;
    const internal::ValueType* rate_type;
    std::shared_ptr<const void> rate;
    std::vector<Wire> from;
    std::shared_ptr<const void> stand_in = nullptr;
    internal::Value::Shape shape = nullptr;
    int shaped_by = -1;
  };

  internal::Rule NewRule(internal::RuleKind kind, const internal::Value& target) const;
  int IndexOf(const internal::Value& value) const;
  int IndexOf(const Clock&) const { return internal::kClockIndex; }

  std::string name_;
  const Composite* parent_ = nullptr;
  int number_ = -1;  // in the plan
  std::vector<Declared> values_;
  std::vector<internal::Rule> rules_;
};

// ---------------------------------------------------------------------------------------------

namespace internal {

template <class F, class... X>
decltype(auto) Call(const void* function, const Block* self, X&&... x) {
  const F& f = *static_cast<const F*>(function);
  using C = typename MemberOf<F>::type;
  if constexpr (std::is_void_v<C>) {
    return f(std::forward<X>(x)...);
  } else {
    return (static_cast<const C*>(self)->*f)(std::forward<X>(x)...);
  }
}

template <class F, class... X>
constexpr bool Callable() {
  using C = typename MemberOf<F>::type;
  if constexpr (std::is_void_v<C>) {
    return std::is_invocable_v<const F&, X...>;
  } else {
    return std::is_invocable_v<const F&, const C&, X...>;
  }
}

template <class... T>
template <class... V>
auto RuleFrom<T...>::From(const V&... values) && {
  rule_.arguments = {block_->IndexOf(values)...};
  return RuleAs<std::tuple<T...>, std::tuple<V...>>(block_, std::move(rule_));
}

template <class... T, class... V>
template <class F, bool kReturns, bool kFresh>
void RuleAs<std::tuple<T...>, std::tuple<V...>>::Run(const void* function, const Block* self,
                                                     std::byte* arena, const std::uint32_t* slots) {
  [&]<std::size_t... t, std::size_t... v>(std::index_sequence<t...>, std::index_sequence<v...>) {
    constexpr std::size_t n = sizeof...(T);
    if constexpr (n == 0) {
      Call<F>(function, self, Argument<V>::Get(arena, slots, v)...);
    } else if constexpr (kReturns) {
      using R = std::remove_cvref_t<decltype(Call<F>(function, self,
                                                     Argument<V>::Get(arena, slots, v)...))>;
      if constexpr (n == 1) {
        using T0 = std::tuple_element_t<0, std::tuple<T...>>;
        static_assert(std::is_convertible_v<R, T0>, "a rule returns the quantity it rules");
        static_assert(!IsExpression<R>, "a rule returns a value: give the Eigen expression a type");
        if constexpr (kFresh && std::is_same_v<R, T0> && std::is_trivially_destructible_v<T0>) {
          new (arena + slots[0])
              T0(Call<F>(function, self, Argument<V>::Get(arena, slots + n, v)...));
        } else {
          At<T0>(arena, slots[0]) =
              Call<F>(function, self, Argument<V>::Get(arena, slots + n, v)...);
        }
      } else {
        static_assert(std::is_convertible_v<R, std::tuple<T...>>,
                      "a rule of several values returns a std::tuple of them");
        std::tie(At<T>(arena, slots[t])...) =
            Call<F>(function, self, Argument<V>::Get(arena, slots + n, v)...);
      }
    } else {
      Call<F>(function, self, At<T>(arena, slots[t])..., Argument<V>::Get(arena, slots + n, v)...);
    }
  }
  (std::index_sequence_for<T...>{}, std::index_sequence_for<V...>{});
}

template <class... T, class... V>
template <class F>
void RuleAs<std::tuple<T...>, std::tuple<V...>>::As(F f) && {
  constexpr bool kReturns = Callable<F, typename Argument<V>::type...>();
  constexpr bool kWrites = Callable<F, T&..., typename Argument<V>::type...>();
  static_assert(kReturns || kWrites,
                "a rule's parameters are the values named in From, in that order");
  static_assert(sizeof...(T) == 0 || std::is_member_function_pointer_v<F> || std::is_empty_v<F> ||
                    std::is_function_v<std::remove_pointer_t<F>>,
                "a rule reads its arguments and the block's constants: capture nothing");
  if constexpr (!std::is_void_v<typename MemberOf<F>::type>)
    Require(dynamic_cast<const typename MemberOf<F>::type*>(block_) != nullptr,
            "a rule is a member function of its own block, not of another");
  if constexpr (kReturns || kWrites) {
    rule_.function = std::make_shared<const F>(std::move(f));
    if (std::is_trivially_copyable_v<F>) rule_.function_size = sizeof(F);
    // A computed value does not read itself, so its rule may build the new value where the old one
    // is.
    const bool fresh = rule_.kind == RuleKind::Compute || rule_.kind == RuleKind::Derivative;
    rule_.run = fresh ? &Run<F, kReturns, true> : &Run<F, kReturns, false>;
    block_->rules_.push_back(std::move(rule_));
  }
}

}  // namespace internal
}  // namespace pliant
