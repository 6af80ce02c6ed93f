#pragma once

#include "pliant/systems/linear_model.h"

namespace pliant {

/// An observer of the states of a sampled linear model:
///
///   x̂_k = x̂⁻_k + L (y_k − C x̂⁻_k),   x̂⁻_{k+1} = A x̂_k + B u_k,   x̂⁻_0 = initial
///
/// Its error dies out with the modes of A (I − L C), if the model is right. At tick k the estimate
/// knows y_k, and u up to k − 1: a controller may read it and make u_k of it in the same tick. With
/// the gain of SteadyKalmanOf it is the Kalman filter that has run for long.
/// Source: Luenberger, IEEE Trans. Automatic Control 16 (1971) 596; Franklin, Powell & Workman,
/// Digital Control of Dynamic Systems, 3rd ed., 8.2 (current estimator).
template <class U = NumberVector, class Y = NumberVector>
class LuenbergerObserver final : public Block {
 public:
  using SpaceU = typename internal::SpaceOf<U>::type;
  using SpaceY = typename internal::SpaceOf<Y>::type;
  struct Options {
    SpaceU input = {};
    SpaceY output = {};
    Names states = {};             ///< none: x1, x2, …
    LinearModel model;             ///< sampled every period, without D
    Eigen::MatrixXd gain;          ///< L, a row for each state, a column for each number of y
    Eigen::VectorXd initial = {};  ///< x̂⁻_0; none: zero
    Duration period;
  };

  explicit LuenbergerObserver(const Options& o)
      : u{this, "u", o.input},
        y{this, "y", o.output},
        x{this, "x", internal::NamesOf(o.states, o.model), internal::InitialOf(o.initial, o.model)},
        innovation{this, "innovation", Names::Numbered(o.model.C.rows(), "y")},
        predicted_{this, "predicted", internal::NamesOf(o.states, o.model),
                   internal::InitialOf(o.initial, o.model)},
        A_{o.model.A},
        B_{o.model.B},
        C_{o.model.C},
        L_{o.gain} {
    internal::RequireEnds<U, Y>(o.model, o.input, o.output);
    Require(o.model.feedthrough().isZero(0), "D must be zero: an observer measures the states");
    internal::RequireShape("gain", L_, A_.rows(), C_.rows(), "as the states and y are");
    const PeriodicEvent tick = Every(o.period);
    tick.Compute(innovation).From(y, predicted_).As(&LuenbergerObserver::Innovation);
    tick.Compute(x).From(predicted_, innovation).As(&LuenbergerObserver::Correct);
    tick.Update(predicted_).From(x, u).As(&LuenbergerObserver::Predict);
  }

  Input<U> u;  ///< what moves the plant from this tick on
  Input<Y> y;
  Output<NumberVector> x;           ///< x̂_k
  Output<NumberVector> innovation;  ///< y_k − C x̂⁻_k

 private:
  NumberVector Innovation(const Y& measured, const NumberVector& predicted) const {
    NumberVector nu = internal::Times<NumberVector>(C_, predicted);
    nu = internal::AsColumn(measured) - nu;
    return nu;
  }
  NumberVector Correct(const NumberVector& predicted, const NumberVector& nu) const {
    return predicted + internal::Times<NumberVector>(L_, nu);
  }
  NumberVector Predict(const NumberVector& now, const U& in) const {
    return internal::Times<NumberVector>(A_, now) + internal::Times<NumberVector>(B_, in);
  }

  Discrete<NumberVector> predicted_;
  const Eigen::MatrixXd A_, B_, C_, L_;
};

}  // namespace pliant
