#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// ẏ = u, y(0) = initial; by the integrator of the simulator.
template <class S>
class Integral final : public Block {
 public:
  using Rate = typename internal::RateOf<S>::type;
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S initial = internal::ZeroOf<S>(space);
  };

  explicit Integral(const Options& o)
      : u{this, "u", o.space}, y{this, "y", o.space}, x_{this, "x", o.space, o.initial} {
    Derivative(x_).From(u).As([](const Rate& rate) { return rate; });
    Compute(y).From(x_).As([](const S& x) { return x; });
  }

  Input<Rate> u;
  Output<S> y;

 private:
  Continuous<S> x_;
};

}  // namespace pliant
