#pragma once

#include "pliant/systems/number_vector.h"

namespace pliant {

/// A typed value out of a vector of numbers:
///
///   y = (u_f, u_{f+1}, …),   f = first, from 0, as many as y has
///
/// It is where numbers get their meaning back: nothing can check that they have it.
template <class S>
class Demultiplexer final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Names names;       ///< of all numbers of u
    Space space = {};  ///< of y
    int first = 0;
  };

  explicit Demultiplexer(const Options& o)
      : u{this, "u", o.names},
        y{this, "y", o.space},
        first_{o.first},
        count_{internal::NumbersOf<S>(o.space)} {
    Require(count_ <= o.names.size(),
            "names must be those of all numbers of u, of which y takes " + Text(count_),
            o.names.size());
    Require(o.first >= 0 && o.first + count_ <= o.names.size(),
            "first must be from 0 to " + Text(o.names.size() - count_) + ", since y takes " +
                Text(count_) + " of " + Text(o.names.size()) + " numbers",
            o.first);
    Compute(y).From(u).As(&Demultiplexer::Take);
  }

  Input<NumberVector> u;
  Output<S> y;

 private:
  S Take(const NumberVector& all) const {
    return internal::FromColumn<S>(all.segment(first_, count_));
  }

  const int first_;
  const Eigen::Index count_;
};

}  // namespace pliant
