#pragma once

#include <cmath>
#include <numbers>

#include "pliant/systems/block.h"

namespace pliant {

/// The rate of u behind a first-order low-pass filter with cutoff f, sampled every h:
///
///   y_k = y_{k−1} + α ((u_k − u_{k−1})/h − y_{k−1}),   α = 1 − exp(−2π f h),   y_0 = 0
///
/// Exact for τ ẏ = u̇ − y, τ = 1/(2π f), when u is linear between ticks; y_k belongs to tick k.
template <class S>
class FilteredDerivative final : public Block {
 public:
  using Rate = typename internal::RateOf<S>::type;
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    double cutoff_hz;  ///< f > 0
    Duration period;
  };

  explicit FilteredDerivative(const Options& o)
      : u{this, "u", o.space},
        y{this, "y", o.space},
        last_{this, "last", o.space},
        has_last_{this, "has_last"},
        alpha_{1 - std::exp(-2 * std::numbers::pi * o.cutoff_hz * seconds(o.period))},
        h_{seconds(o.period)} {
    Require(o.cutoff_hz > 0, "cutoff_hz must be > 0", o.cutoff_hz);
    Every(o.period).Compute(y).From(y, u, last_, has_last_).As(&FilteredDerivative::Next);
    Every(o.period).Update(last_).From(u).As([](const S& now) { return now; });
    Every(o.period).Update(has_last_).From().As([] { return true; });
  }

  Input<S> u;
  Output<Rate> y;

 private:
  Rate Next(const Rate& rate, const S& now, const S& last, bool has_last) const {
    return has_last ? Rate(rate + alpha_ * ((now - last) / h_ - rate)) : rate;
  }

  Discrete<S> last_;
  Discrete<bool> has_last_;
  const double alpha_, h_;
};

}  // namespace pliant
