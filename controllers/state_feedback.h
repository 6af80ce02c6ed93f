#pragma once

#include "pliant/systems/number_vector.h"

namespace pliant {

/// u = u₀ − K (x − x₀), at every instant: the feedback of an Lqr about an operating point.
///
/// x₀ and u₀ are inputs, which the options give values to where nothing is wired.
template <class U>
class StateFeedback final : public Block {
 public:
  using Space = typename internal::SpaceOf<U>::type;
  struct Options {
    Names states;
    Space space = {};           ///< of u
    Eigen::MatrixXd gain;       ///< K, a row for each number of u, a column for each state
    Eigen::VectorXd rest = {};  ///< x₀; none: zero
    U hold = internal::ZeroOf<U>(space);  ///< u₀
  };

  explicit StateFeedback(const Options& o)
      : x{this, "x", o.states},
        x0{this, "x0", o.states, RestOf(o)},
        u0{this, "u0", o.space, o.hold},
        u{this, "u", o.space},
        K_{o.gain} {
    internal::RequireShape("gain", K_, internal::NumbersOf<U>(o.space), o.states.size(),
                           "as u and the states are");
    Compute(u).From(x, x0, u0).As(&StateFeedback::Law);
  }

  Input<NumberVector> x, x0;
  Input<U> u0;
  Output<U> u;

 private:
  static NumberVector RestOf(const Options& o) {
    if (o.rest.size() == 0) return NumberVector::Zero(o.states);
    Require(o.rest.size() == o.states.size(),
            "rest must have a number for each state, " + Text(o.states.size()), o.rest.size());
    return NumberVector(o.rest);
  }

  U Law(const NumberVector& now, const NumberVector& rest, const U& hold) const {
    const NumberVector off = now - rest;
    return hold - internal::Times<U>(K_, off);
  }

  const Eigen::MatrixXd K_;
};

}  // namespace pliant
