#pragma once

#include <algorithm>

#include "pliant/systems/block.h"

namespace pliant {

/// y = u[select], counted from 0 in the order of the wires.
///
/// A number outside of the list selects the end that is nearer, and `in_range` is false. Without
/// wires y is zero.
template <class S>
class Selector final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
  };

  explicit Selector(const Options& o)
      : select{this, "select"},
        u{this, "u", o.space},
        y{this, "y", o.space},
        in_range{this, "in_range"},
        zero_{internal::ZeroOf<S>(o.space)} {
    Compute(y).From(select, u).As(&Selector::Pick);
    Compute(in_range).From(select, u).As(
        [](int i, const Joined<S>& all) { return i >= 0 && i < all.size(); });
  }

  Input<int> select;
  InputList<S> u;
  Output<S> y;
  Output<bool> in_range;

 private:
  S Pick(int i, const Joined<S>& all) const {
    return all.size() ? all[std::clamp(i, 0, all.size() - 1)] : zero_;
  }

  const S zero_;
};

}  // namespace pliant
