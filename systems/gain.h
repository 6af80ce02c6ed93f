#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// y = k ∘ u, element by element. `From` and `To` may be different quantities: k carries the unit.
template <class From, class To = From>
class Gain final : public Block {
 public:
  using Space = typename internal::SpaceOf<From>::type;
  struct Options {
    Space space = {};
    double gain = 1;
  };

  explicit Gain(const Options& o) : u{this, "u", o.space}, y{this, "y", o.space}, k_{o.gain} {
    Compute(y).From(u).As(&Gain::Scale);
  }

  Input<From> u;
  Output<To> y;

 private:
  To Scale(const From& x) const { return k_ * x; }

  const double k_;
};

}  // namespace pliant
