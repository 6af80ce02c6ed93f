#pragma once

#include <cmath>
#include <numbers>

#include "pliant/systems/block.h"

namespace pliant {

/// y = offset + amplitude · sin(2π f t + φ)
template <class S>
class Sine final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S amplitude;
    S offset = internal::ZeroOf<S>(space);
    double frequency_hz;  ///< f > 0
    double phase = 0;     ///< φ [rad]
  };

  explicit Sine(const Options& o)
      : amplitude{this, "amplitude", o.space, o.amplitude},
        offset{this, "offset", o.space, o.offset},
        y{this, "y", o.space},
        omega_{2 * std::numbers::pi * o.frequency_hz},
        phase_{o.phase} {
    Require(o.frequency_hz > 0, "frequency_hz must be > 0", o.frequency_hz);
    Compute(y).From(clock, amplitude, offset).As(&Sine::At);
  }

  Input<S> amplitude, offset;
  Output<S> y;

 private:
  S At(double t, const S& a, const S& mean) const {
    return mean + a * std::sin(omega_ * t + phase_);
  }

  const double omega_, phase_;
};

}  // namespace pliant
