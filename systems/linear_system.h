#pragma once

#include "pliant/systems/linear_model.h"

namespace pliant {

/// A linear model in continuous time:
///
///   ẋ = A x + B u,   y = C x + D u,   x(0) = initial
///
/// Without D nothing feeds through. `U` and `Y` are any signals of numbers; the matrices carry
/// their units.
template <class U = NumberVector, class Y = NumberVector>
class LinearSystem final : public Block {
 public:
  using SpaceU = typename internal::SpaceOf<U>::type;
  using SpaceY = typename internal::SpaceOf<Y>::type;
  struct Options {
    SpaceU input = {};
    SpaceY output = {};
    Names states = {};  ///< none: x1, x2, …
    LinearModel model;
    Eigen::VectorXd initial = {};  ///< none: zero
  };

  explicit LinearSystem(const Options& o)
      : u{this, "u", o.input},
        y{this, "y", o.output},
        x{this, "x", internal::NamesOf(o.states, o.model), internal::InitialOf(o.initial, o.model)},
        A_{o.model.A},
        B_{o.model.B},
        C_{o.model.C},
        D_{o.model.feedthrough()} {
    internal::RequireEnds<U, Y>(o.model, o.input, o.output);
    Derivative(x).From(x, u).As(&LinearSystem::Rate);
    if (D_.isZero(0))
      Compute(y).From(x).As(&LinearSystem::Show);
    else
      Compute(y).From(x, u).As(&LinearSystem::ShowBoth);
  }

  Input<U> u;
  Output<Y> y;
  Continuous<NumberVector> x;

 private:
  NumberVector Rate(const NumberVector& now, const U& in) const {
    NumberVector rate = internal::Times<NumberVector>(A_, now);
    rate += internal::Times<NumberVector>(B_, in);
    return rate;
  }
  Y Show(const NumberVector& now) const { return internal::Times<Y>(C_, now); }
  Y ShowBoth(const NumberVector& now, const U& in) const {
    return internal::Times<Y>(C_, now) + internal::Times<Y>(D_, in);
  }

  const Eigen::MatrixXd A_, B_, C_, D_;
};

}  // namespace pliant
