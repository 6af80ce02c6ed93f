#pragma once

#include <algorithm>
#include <cmath>

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// The slow lag g/(θ s + 1), clamped, sampled every h:
///
///   y_k = clamp(a y_{k−1} + (1 − a) g u_k, ± limit),   a = exp(−h/θ)
///
/// The clamped value is fed back, so it does not wind up. Exact for θ ẏ = g u − y when u = u_k over
/// the sample that ends at tick k. `From` and `To` may be different quantities: g carries the unit.
template <class From, class To = From>
class LeakyIntegrator final : public Block {
 public:
  using Space = typename internal::SpaceOf<From>::type;
  struct Options {
    Space space = {};
    PerElement<From> gain;   ///< g
    double time_constant_s;  ///< θ > 0
    To limit;                ///< each ≥ 0
    Duration period;
  };

  explicit LeakyIntegrator(const Options& o)
      : u{this, "u", o.space},
        gain{this, "gain", ElementSpace<From>(o.space), o.gain},
        limit{this, "limit", o.space, o.limit},
        y{this, "y", o.space},
        a_{std::exp(-seconds(o.period) / o.time_constant_s)} {
    Require(o.time_constant_s > 0, "time_constant_s must be > 0", o.time_constant_s);
    Require(Smallest(o.limit) >= 0, "every limit must be >= 0", Smallest(o.limit));
    Every(o.period).Compute(y).From(y, u, gain, limit).As(&LeakyIntegrator::Next);
  }

  Input<From> u;
  Input<PerElement<From>> gain;
  Input<To> limit;
  Output<To> y;

 private:
  To Next(const To& last, const From& now, const PerElement<From>& g, const To& most) const {
    const auto leak = [this](double y_last, double u_k, double g_k, double bound) {
      return std::min(std::max(a_ * y_last + (1 - a_) * g_k * u_k, -bound), bound);
    };
    return EachElement<To>(leak, last, now, g, most);
  }

  const double a_;
};

}  // namespace pliant
