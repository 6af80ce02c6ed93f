#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// A straight way from `start` to `goal`:
///
///   y = start + (goal − start) (t − at) / duration   for at ≤ t ≤ at + duration,
///
/// and constant before and after. Its ends are ticks, where integration stops.
template <class S>
class Ramp final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S start = internal::ZeroOf<S>(space);
    S goal;
    Duration at = {};
    Duration duration;
  };

  explicit Ramp(const Options& o)
      : start{this, "start", o.space, o.start},
        goal{this, "goal", o.space, o.goal},
        y{this, "y", o.space},
        begun_{this, "begun"},
        ended_{this, "ended"},
        at_s_{seconds(o.at)},
        duration_s_{seconds(o.duration)} {
    Require(Duration{} < o.duration, "duration must be > 0", o.duration.text());
    Every(kOnce, o.at).Compute(begun_).From().As([] { return true; });
    Every(kOnce, o.at + o.duration).Compute(ended_).From().As([] { return true; });
    Compute(y).From(clock, begun_, ended_, start, goal).As(&Ramp::Way);
  }

  Input<S> start, goal;
  Output<S> y;

 private:
  S Way(double t, bool begun, bool ended, const S& from, const S& to) const {
    if (!begun) return from;
    if (ended) return to;
    return from + (to - from) * ((t - at_s_) / duration_s_);
  }

  Output<bool> begun_, ended_;
  const double at_s_, duration_s_;
};

}  // namespace pliant
