#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// Each element of u within its bounds:
///
///   y = min(max(u, lower), upper)
///   saturated = −1 where u < lower, 1 where u > upper, 0 elsewhere
///
/// Where the bounds are set to cross while running, upper holds. NaN stays NaN.
template <class S>
class Saturation final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S lower;
    S upper;
  };

  explicit Saturation(const Options& o)
      : u{this, "u", o.space},
        lower{this, "lower", o.space, o.lower},
        upper{this, "upper", o.space, o.upper},
        y{this, "y", o.space},
        saturated{this, "saturated", ElementSpace<S>(o.space)} {
    Require(Smallest(o.upper - o.lower) >= 0, "upper − lower must be >= 0",
            Smallest(o.upper - o.lower));
    Compute(y).From(u, lower, upper).As([](const S& x, const S& lo, const S& hi) {
      return EachElement<S>(&Saturation::Clamp, x, lo, hi);
    });
    Compute(saturated).From(u, lower, upper).As([](const S& x, const S& lo, const S& hi) {
      return EachElement<PerElement<S>>(&Saturation::Side, x, lo, hi);
    });
  }

  Input<S> u, lower, upper;
  Output<S> y;
  Output<PerElement<S>> saturated;

 private:
  static double Clamp(double u, double lower, double upper) {
    const double risen = u < lower ? lower : u;
    return risen > upper ? upper : risen;
  }
  static double Side(double u, double lower, double upper) {
    return u > upper ? 1 : u < lower ? -1 : 0;
  }
};

}  // namespace pliant
