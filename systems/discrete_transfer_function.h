#pragma once

#include <algorithm>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// For each element, sampled every h:
///
///   a₀ y_k = b₀ u_k + b₁ u_{k−1} + … + b_n u_{k−n} − a₁ y_{k−1} − … − a_m y_{k−m}
///
/// Direct form II transposed, at rest at first. `From` and `To` may be different quantities: b
/// carries the unit.
/// Source: Oppenheim & Schafer, Discrete-Time Signal Processing, 3rd ed., sec. 6.3.
template <class From, class To = From>
class DiscreteTransferFunction final : public Block {
 public:
  using Space = typename internal::SpaceOf<From>::type;
  struct Options {
    Space space = {};
    std::vector<double> b;          ///< b₀ … b_n
    std::vector<double> a = {1.0};  ///< a₀ … a_m, a₀ ≠ 0
    Duration period;
  };

  explicit DiscreteTransferFunction(const Options& o)
      : u{this, "u", o.space},
        y{this, "y", o.space},
        s_{this, "s", {}, State::Zero(Elements(o.space), Order(o))},
        b_{Normal(o.b, o)},
        a_{Normal(o.a, o)} {
    Every(o.period).Compute(y).From(u, s_).As(&DiscreteTransferFunction::Filter);
    Every(o.period).Update(s_).From(s_, u, y).As(&DiscreteTransferFunction::Next);
  }

  Input<From> u;
  Output<To> y;

 private:
  using State = Eigen::MatrixXd;  // a row for each element

  static Eigen::Index Elements(const Space& space) {
    if constexpr (internal::Dense<From>)
      return internal::ZeroOf<From>(space).size();
    else
      return 1;
  }
  static Eigen::Index Order(const Options& o) {
    Require(!o.b.empty(), "b must have an element, b₀");
    Require(!o.a.empty(), "a must have an element, a₀");
    Require(o.a[0] != 0, "a₀ must not be 0", o.a[0]);
    return static_cast<Eigen::Index>(std::max(o.b.size(), o.a.size())) - 1;
  }
  /// Divided by a₀, and as long as the order asks for.
  static Eigen::VectorXd Normal(const std::vector<double>& coefficients, const Options& o) {
    Eigen::VectorXd c = Eigen::VectorXd::Zero(Order(o) + 1);
    for (std::size_t i = 0; i < coefficients.size(); ++i)
      c(static_cast<Eigen::Index>(i)) = coefficients[i] / o.a[0];
    return c;
  }

  To Filter(const From& now, const State& s) const {
    if (s.cols() == 0) return b_(0) * now;
    if constexpr (internal::Dense<To>)
      return b_(0) * now + s.col(0);
    else
      return b_(0) * now + s(0, 0);
  }
  void Next(State& next, const State& s, const From& now, const To& out) const {
    for (Eigen::Index i = 0; i < s.cols(); ++i)
      for (Eigen::Index row = 0; row < s.rows(); ++row)
        next(row, i) = (i + 1 < s.cols() ? s(row, i + 1) : 0) +
                       b_(i + 1) * internal::ElementAt(now, row) -
                       a_(i + 1) * internal::ElementAt(out, row);
  }

  Discrete<State> s_;
  const Eigen::VectorXd b_, a_;
};

}  // namespace pliant
