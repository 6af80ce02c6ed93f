#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/block.h"

namespace pliant {

/// How the frequency of a chirp goes from f₀ to f₁.
enum class Sweep { kLinear, kExponential };

/// A sine whose frequency f goes from f₀ at t = 0 to f₁ at t = T, and stays there:
///
///   y = offset + amplitude · sin 2π∫f dt
///   linear:       f = f₀ + (f₁ − f₀) t/T,    ∫f dt = f₀ t + (f₁ − f₀) t²/(2T)
///   exponential:  f = f₀ (f₁/f₀)^(t/T),      ∫f dt = f₀ T ((f₁/f₀)^(t/T) − 1) / ln(f₁/f₀)
template <class S>
class Chirp final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    S amplitude;
    S offset = internal::ZeroOf<S>(space);
    double start_hz;    ///< f₀ > 0
    double end_hz;      ///< f₁ > 0
    Duration duration;  ///< T
    Sweep sweep = Sweep::kLinear;
  };

  explicit Chirp(const Options& o)
      : amplitude{this, "amplitude", o.space, o.amplitude},
        offset{this, "offset", o.space, o.offset},
        y{this, "y", o.space},
        f0_{o.start_hz},
        f1_{o.end_hz},
        T_{seconds(o.duration)},
        is_linear_{o.sweep == Sweep::kLinear || o.start_hz == o.end_hz} {
    Require(o.start_hz > 0, "start_hz must be > 0", o.start_hz);
    Require(o.end_hz > 0, "end_hz must be > 0", o.end_hz);
    Require(T_ > 0, "duration must be > 0", o.duration.text());
    Compute(y).From(clock, amplitude, offset).As(&Chirp::At);
  }

  Input<S> amplitude, offset;
  Output<S> y;

 private:
  S At(double t, const S& a, const S& mean) const {
    const double cycles = Cycles(std::min(t, T_)) + f1_ * std::max(t - T_, 0.0);
    return mean + a * std::sin(2 * std::numbers::pi * cycles);
  }
  double Cycles(double t) const {
    if (is_linear_) return f0_ * t + (f1_ - f0_) * t * t / (2 * T_);
    const double ln = std::log(f1_ / f0_);
    return f0_ * T_ * std::expm1(ln * t / T_) / ln;
  }

  const double f0_, f1_, T_;
  const bool is_linear_;
};

}  // namespace pliant
