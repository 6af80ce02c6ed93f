#pragma once

#include <cmath>
#include <numbers>

#include "pliant/systems/block.h"

namespace pliant {

/// Second-order low-pass filter with cutoff f and damping ζ, sampled every h:
///
///   H(s) = ω² / (s² + 2ζω s + ω²),   s = c (z − 1)/(z + 1),   ω = 2π f,   c = ω / tan(ω h/2)
///
/// The bilinear transform, prewarped so that the response at f is that of H: |H| = 1/(2ζ) at −90°.
/// Direct form II transposed. Starts at rest.
/// Source: Oppenheim & Schafer, Discrete-Time Signal Processing, 3rd ed., sec. 7.2.2.
template <class S>
class LowPass2 final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    double cutoff_hz;                          ///< f, 0 < f h < 1/2
    double damping = std::numbers::sqrt2 / 2;  ///< ζ > 0; √2/2 is Butterworth's
    Duration period;
  };

  explicit LowPass2(const Options& o)
      : u{this, "u", o.space},
        y{this, "y", o.space},
        s1_{this, "s1", o.space},
        s2_{this, "s2", o.space},
        b0_{Scale(o)},
        a1_{2 * b0_ * (1 - 1 / Square(Warp(o)))},
        a2_{b0_ * (1 - 2 * o.damping / Warp(o) + 1 / Square(Warp(o)))} {
    Require(o.cutoff_hz > 0, "cutoff_hz must be > 0", o.cutoff_hz);
    Require(o.cutoff_hz * seconds(o.period) < 0.5, "cutoff_hz · period must be < 1/2",
            o.cutoff_hz * seconds(o.period));
    Require(o.damping > 0, "damping must be > 0", o.damping);
    Every(o.period).Compute(y).From(u, s1_).As(&LowPass2::Filter);
    Every(o.period).Update(s1_).From(u, y, s2_).As(&LowPass2::Next1);
    Every(o.period).Update(s2_).From(u, y).As(&LowPass2::Next2);
  }

  Input<S> u;
  Output<S> y;

 private:
  static double Square(double x) { return x * x; }
  static double Warp(const Options& o) {  // ω/c
    return std::tan(std::numbers::pi * o.cutoff_hz * seconds(o.period));
  }
  static double Scale(const Options& o) {
    return 1 / (1 + 2 * o.damping / Warp(o) + 1 / Square(Warp(o)));
  }

  S Filter(const S& now, const S& s1) const { return b0_ * now + s1; }
  S Next1(const S& now, const S& out, const S& s2) const { return 2 * b0_ * now - a1_ * out + s2; }
  S Next2(const S& now, const S& out) const { return b0_ * now - a2_ * out; }

  Discrete<S> s1_, s2_;
  const double b0_, a1_, a2_;  // b1 = 2 b0, b2 = b0
};

}  // namespace pliant
