#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// y = Σ plus − Σ minus, in the order of the wires.
template <class S>
class Sum final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
  };

  explicit Sum(const Options& o)
      : plus{this, "plus", o.space},
        minus{this, "minus", o.space},
        y{this, "y", o.space},
        zero_{internal::ZeroOf<S>(o.space)} {
    Compute(y).From(plus, minus).As(&Sum::Add);
  }

  InputList<S> plus, minus;
  Output<S> y;

 private:
  S Add(const Joined<S>& terms, const Joined<S>& negative) const {
    S sum = zero_;
    for (int i = 0; i < terms.size(); ++i) sum += terms[i];
    for (int i = 0; i < negative.size(); ++i) sum -= negative[i];
    return sum;
  }

  const S zero_;
};

}  // namespace pliant
