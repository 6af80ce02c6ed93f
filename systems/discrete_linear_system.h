#pragma once

#include "pliant/systems/linear_model.h"

namespace pliant {

/// A linear model sampled every h:
///
///   x_{k+1} = A x_k + B u_k,   y_k = C x_k + D u_k,   x_0 = initial
///
/// y is held from tick to tick. Without D nothing feeds through.
template <class U = NumberVector, class Y = NumberVector>
class DiscreteLinearSystem final : public Block {
 public:
  using SpaceU = typename internal::SpaceOf<U>::type;
  using SpaceY = typename internal::SpaceOf<Y>::type;
  struct Options {
    SpaceU input = {};
    SpaceY output = {};
    Names states = {};  ///< none: x1, x2, …
    LinearModel model;
    Eigen::VectorXd initial = {};  ///< none: zero
    Duration period;
  };

  explicit DiscreteLinearSystem(const Options& o)
      : u{this, "u", o.input},
        y{this, "y", o.output},
        x{this, "x", internal::NamesOf(o.states, o.model), internal::InitialOf(o.initial, o.model)},
        A_{o.model.A},
        B_{o.model.B},
        C_{o.model.C},
        D_{o.model.feedthrough()} {
    internal::RequireEnds<U, Y>(o.model, o.input, o.output);
    const PeriodicEvent tick = Every(o.period);
    if (D_.isZero(0))
      tick.Compute(y).From(x).As(&DiscreteLinearSystem::Show);
    else
      tick.Compute(y).From(x, u).As(&DiscreteLinearSystem::ShowBoth);
    tick.Update(x).From(x, u).As(&DiscreteLinearSystem::Next);
  }

  Input<U> u;
  Output<Y> y;
  Discrete<NumberVector> x;

 private:
  NumberVector Next(const NumberVector& now, const U& in) const {
    NumberVector next = internal::Times<NumberVector>(A_, now);
    next += internal::Times<NumberVector>(B_, in);
    return next;
  }
  Y Show(const NumberVector& now) const { return internal::Times<Y>(C_, now); }
  Y ShowBoth(const NumberVector& now, const U& in) const {
    return internal::Times<Y>(C_, now) + internal::Times<Y>(D_, in);
  }

  const Eigen::MatrixXd A_, B_, C_, D_;
};

}  // namespace pliant
