#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// y = before until t = at, then after.
///
/// The step is a tick: what is sampled at that instant sees the new value, and integration stops
/// there.
template <class S>
class Step final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S before = internal::ZeroOf<S>(space);
    S after;
    Duration at = {};
  };

  explicit Step(const Options& o)
      : before{this, "before", o.space, o.before},
        after{this, "after", o.space, o.after},
        y{this, "y", o.space},
        stepped_{this, "stepped"} {
    Every(kOnce, o.at).Compute(stepped_).From().As([] { return true; });
    Compute(y).From(stepped_, before, after).As([](bool stepped, const S& first, const S& then) {
      return stepped ? then : first;
    });
  }

  Input<S> before, after;
  Output<S> y;

 private:
  Output<bool> stepped_;
};

}  // namespace pliant
