#pragma once

#include <cstdint>
#include <string_view>

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"
#include "pliant/systems/random.h"

namespace pliant {

/// White noise with a normal distribution, drawn every h and held:
///
///   y_k = σ ∘ ξ_k,   ξ_k ~ N(0, I),   E[ξ_k ξ_jᵀ] = 0 for k ≠ j
///
/// ξ_k is a function of the seed, the element and k, so a run that is resumed sees the same noise.
/// Up to 1/(2h) its one-sided power spectral density is 2 σ² h [unit²/Hz].
template <class S>
class WhiteNoise final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    PerElement<S> deviation;  ///< σ [unit of y], each ≥ 0
    Duration period;
    std::uint64_t seed;
  };

  explicit WhiteNoise(const Options& o)
      : deviation{this, "deviation", ElementSpace<S>(o.space), o.deviation},
        y{this, "y", o.space},
        random_{o.seed},
        h_{seconds(o.period)} {
    std::string_view unit;
    if constexpr (requires { S::quantity; }) unit = S::quantity.unit;
    RequireEachInRange("deviation", o.deviation, unit, kNotNegative, o.space);
    Every(o.period).Compute(y).From(clock, deviation).As(&WhiteNoise::Draw);
  }

  Input<PerElement<S>> deviation;
  Output<S> y;

 private:
  S Draw(double t, const PerElement<S>& sigma) const {
    const std::uint64_t k = TickAt(t, h_);
    std::uint64_t element = 0;
    return EachElement<S>([&](double s) { return s * random_.Part(element++).Normal(k); }, sigma);
  }

  const RandomStream random_;
  const double h_;
};

}  // namespace pliant
