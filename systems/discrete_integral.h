#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// The integral of samples, every h:
///
///   y_k = y_{k−1} + h u_k,   y_{−1} = initial
///
/// Exact for ẏ = u when u = u_k over the sample that ends at tick k.
template <class S>
class DiscreteIntegral final : public Block {
 public:
  using Rate = typename internal::RateOf<S>::type;
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S initial = internal::ZeroOf<S>(space);
    Duration period;
  };

  explicit DiscreteIntegral(const Options& o)
      : u{this, "u", o.space}, y{this, "y", o.space, o.initial}, h_{seconds(o.period)} {
    Every(o.period).Compute(y).From(y, u).As(&DiscreteIntegral::Next);
  }

  Input<Rate> u;
  Output<S> y;

 private:
  S Next(const S& last, const Rate& rate) const { return last + h_ * rate; }

  const double h_;
};

}  // namespace pliant
