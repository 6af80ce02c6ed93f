#pragma once

#include <cmath>
#include <numbers>

#include "pliant/systems/block.h"

namespace pliant {

/// First-order low-pass filter with cutoff f, sampled every h:
///
///   y_k = y_{k−1} + α (u_k − y_{k−1}),   α = 1 − exp(−2π f h)
///
/// Exact for τ ẏ = u − y, τ = 1/(2π f), when u = u_k over the sample that ends at tick k.
/// Source: Franklin, Powell & Workman, Digital Control of Dynamic Systems, 3rd ed., ch. 6.
template <class S>
class LowPass final : public Block {
 public:
  struct Options {
    typename internal::SpaceOf<S>::type space = {};
    double cutoff_hz;
    Duration period;
  };

  explicit LowPass(const Options& o)
      : u{this, "u", o.space},
        y{this, "y", o.space},
        alpha_{1 - std::exp(-2 * std::numbers::pi * o.cutoff_hz * seconds(o.period))} {
    Require(o.cutoff_hz > 0, "cutoff_hz must be > 0", o.cutoff_hz);
    Every(o.period).Compute(y).From(y, u).As(&LowPass::Next);
  }

  Input<S> u;
  Output<S> y;

 private:
  S Next(const S& y, const S& u) const { return y + alpha_ * (u - y); }

  const double alpha_;
};

}  // namespace pliant
