#pragma once

#include <algorithm>

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// Follows u no faster than `rise` upwards and `fall` downwards, sampled every h:
///
///   y_k = y_{k−1} + min(max(u_k − y_{k−1}, −fall h), rise h)
///
/// y_k is the output over the sample that begins at tick k.
template <class S>
class RateLimiter final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    PerElement<S> rise;  ///< [unit of u per s], each ≥ 0
    PerElement<S> fall;  ///< [unit of u per s], each ≥ 0
    S initial = internal::ZeroOf<S>(space);
    Duration period;
  };

  explicit RateLimiter(const Options& o)
      : u{this, "u", o.space},
        rise{this, "rise", ElementSpace<S>(o.space), o.rise},
        fall{this, "fall", ElementSpace<S>(o.space), o.fall},
        y{this, "y", o.space, o.initial},
        h_{seconds(o.period)} {
    Require(Smallest(o.rise) >= 0, "every rise must be >= 0", Smallest(o.rise));
    Require(Smallest(o.fall) >= 0, "every fall must be >= 0", Smallest(o.fall));
    Every(o.period).Compute(y).From(y, u, rise, fall).As(&RateLimiter::Next);
  }

  Input<S> u;
  Input<PerElement<S>> rise, fall;
  Output<S> y;

 private:
  S Next(const S& last, const S& now, const PerElement<S>& up, const PerElement<S>& down) const {
    const auto move = [this](double from, double to, double most, double least) {
      return from + std::min(std::max(to - from, -least * h_), most * h_);
    };
    return EachElement<S>(move, last, now, up, down);
  }

  const double h_;
};

}  // namespace pliant
