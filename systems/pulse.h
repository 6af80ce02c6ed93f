#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// Rectangular pulses: with p the period and k = 0, 1, …
///
///   y = high   for at + k p ≤ t < at + k p + width,
///   y = low    otherwise
///
/// The edges are ticks: what is sampled at that instant sees the new value, and integration stops
/// there.
template <class S>
class Pulse final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S low = internal::ZeroOf<S>(space);
    S high;
    Duration at = {};
    Duration width;
    Duration period = kOnce;  ///< > width
  };

  explicit Pulse(const Options& o)
      : low{this, "low", o.space, o.low},
        high{this, "high", o.space, o.high},
        y{this, "y", o.space},
        risen_{this, "risen"},
        fallen_{this, "fallen"} {
    Require(Duration{} < o.width, "width must be > 0", o.width.text());
    Require(o.width < o.period, "period must be > width", o.period.text());
    Every(o.period, o.at).Compute(risen_).From(risen_).As([](int k) { return k + 1; });
    Every(o.period, o.at + o.width).Compute(fallen_).From(fallen_).As([](int k) { return k + 1; });
    Compute(y).From(risen_, fallen_, low, high).As(&Pulse::Level);
  }

  Input<S> low, high;
  Output<S> y;

 private:
  S Level(int risen, int fallen, const S& low_now, const S& high_now) const {
    return risen > fallen ? high_now : low_now;
  }

  Output<int> risen_, fallen_;  // edges so far
};

}  // namespace pliant
