#pragma once

#include "pliant/systems/number_vector.h"

namespace pliant {

/// y = K u. `From` and `To` may be different quantities: K carries the units.
template <class From, class To = From>
class MatrixGain final : public Block {
 public:
  using SpaceFrom = typename internal::SpaceOf<From>::type;
  using SpaceTo = typename internal::SpaceOf<To>::type;
  struct Options {
    SpaceFrom from = {};   ///< of u
    SpaceTo to = {};       ///< of y
    Eigen::MatrixXd gain;  ///< K, a row for each number of y, a column for each of u
  };

  explicit MatrixGain(const Options& o) : u{this, "u", o.from}, y{this, "y", o.to}, K_{o.gain} {
    internal::RequireShape("gain", K_, internal::NumbersOf<To>(o.to),
                           internal::NumbersOf<From>(o.from), "as y and u are");
    Compute(y).From(u).As(&MatrixGain::Multiply);
  }

  Input<From> u;
  Output<To> y;

 private:
  To Multiply(const From& x) const { return internal::Times<To>(K_, x); }

  const Eigen::MatrixXd K_;
};

}  // namespace pliant
