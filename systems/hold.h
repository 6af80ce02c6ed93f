#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// Zero-order hold: y_k = u_k, until the next tick.
template <class S>
class Hold final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S before = internal::ZeroOf<S>(space);  ///< until the first tick
    Duration period;
    Duration offset = {};  ///< of the first tick
  };

  explicit Hold(const Options& o) : u{this, "u", o.space}, y{this, "y", o.space, o.before} {
    Every(o.period, o.offset).Compute(y).From(u).As([](const S& now) { return now; });
  }

  Input<S> u;
  Output<S> y;
};

}  // namespace pliant
