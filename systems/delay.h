#pragma once

#include <deque>
#include <string>

#include "pliant/systems/block.h"

namespace pliant {

/// y_k = u_{k−n}: z⁻ⁿ, and `initial` before there was an input. It has no feedthrough, so it breaks
/// algebraic loops. At tick k it still shows u_{k−n}; u_{k−n+1} follows at the end of the tick.
template <class S>
class Delay final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    int steps = 1;  ///< n ≥ 1
    S initial = internal::ZeroOf<S>(space);
    Duration period;
  };

  explicit Delay(const Options& o) : u{this, "u", o.space}, y{this, "y", o.space, o.initial} {
    Require(o.steps >= 1, "steps must be >= 1", o.steps);
    constexpr auto same = [](const S& x) { return x; };
    for (int i = 1; i <= o.steps; ++i) {
      x_.emplace_back(this, "x_" + std::to_string(i), o.space, o.initial);
      if (i == 1)
        Every(o.period).Update(x_.back()).From(u).As(same);
      else
        Every(o.period).Update(x_.back()).From(x_[x_.size() - 2]).As(same);
    }
    Compute(y).From(x_.back()).As(same);
  }

  Input<S> u;
  Output<S> y;

 private:
  std::deque<Discrete<S>> x_;  // u of 1, 2, …, n ticks ago
};

}  // namespace pliant
