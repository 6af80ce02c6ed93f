#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// y = value, for all time.
template <class S>
class Constant final : public Block {
 public:
  struct Options {
    typename internal::SpaceOf<S>::type space = {};
    S value;
  };

  explicit Constant(const Options& o)
      : value{this, "value", o.space, o.value}, y{this, "y", o.space} {
    Compute(y).From(value).As([](const S& x) { return x; });
  }

  Input<S> value;  ///< may be set while running
  Output<S> y;
};

}  // namespace pliant
