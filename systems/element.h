#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

/// y = the element of u with this name: a joint, or for a spatial vector such as "fz".
template <class S>
class Element final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    std::string element;
  };

  explicit Element(const Options& o) : u{this, "u", o.space}, y{this, "y"}, i_{Find(o)} {
    Compute(y).From(u).As(&Element::Pick);
  }

  Input<S> u;
  Output<double> y;

 private:
  static Eigen::Index Find(const Options& o) {
    std::vector<std::string> names;
    if constexpr (requires { S::elements; })
      names.assign(S::elements.begin(), S::elements.end());
    else
      for (int i = 0; i < o.space.size(); ++i) names.push_back(o.space[i]);
    const auto at = std::ranges::find(names, o.element);
    if (at == names.end())
      throw Error("there is no element '" + o.element + "'" + DidYouMean(o.element, names));
    return at - names.begin();
  }
  double Pick(const S& x) const { return x(i_); }

  const Eigen::Index i_;
};

}  // namespace pliant
