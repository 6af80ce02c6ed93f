#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// y = on if `select` is true, else off.
template <class S>
class Switch final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
  };

  explicit Switch(const Options& o)
      : select{this, "select"},
        on{this, "on", o.space},
        off{this, "off", o.space},
        y{this, "y", o.space} {
    Compute(y).From(select, on, off).As([](bool is_on, const S& if_on, const S& if_off) {
      return is_on ? if_on : if_off;
    });
  }

  Input<bool> select;
  Input<S> on, off;
  Output<S> y;
};

}  // namespace pliant
