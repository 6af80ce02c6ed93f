#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pliant/systems/parameter.h"
#include "pliant/systems/value_type.h"

/// Laws for one number, applied to each element of a signal; a double is its own only element.
namespace pliant {

namespace internal {

template <class S>
struct PerElementOf {
  using type = S;
};
template <Dense S>
struct PerElementOf<S> {
  using type = typename S::PlainObject;
};

template <class T>
double ElementAt(const T& x, Eigen::Index i) {
  if constexpr (Dense<T>) {
    eigen_assert(i < x.size());
    return x(i);
  } else {
    return x;
  }
}

}  // namespace internal

/// Numbers that go with a signal element by element and have units of their own, such as gains:
/// PerJoint with a vector of joints, double with a double.
template <class S>
using PerElement = typename internal::PerElementOf<S>::type;

/// The space of a `PerElement<S>`.
template <class S>
typename internal::SpaceOf<PerElement<S>>::type ElementSpace(
    const typename internal::SpaceOf<S>::type& space) {
  if constexpr (std::is_same_v<typename internal::SpaceOf<PerElement<S>>::type,
                               typename internal::SpaceOf<S>::type>) {
    return space;
  } else {
    return {};
  }
}

/// The signal whose element i is f of the elements i of x and more; a double is there for every i.
template <class S, class F, class X, class... More>
S EachElement(const F& f, const X& x, const More&... more) {
  if constexpr (internal::Dense<S>) {
    S y;
    y.resizeLike(x);
    for (Eigen::Index i = 0; i < y.size(); ++i) y(i) = f(x(i), internal::ElementAt(more, i)...);
    return y;
  } else {
    return f(x, more...);
  }
}

/// The smallest element, for bounds.
template <class X>
double Smallest(const X& x) {
  if constexpr (std::is_arithmetic_v<X>) {
    return x;
  } else {
    return x.size() ? x.minCoeff() : 0;
  }
}

/// Throws "<name>[elbow] must be >= 0 N·m, got -1" for the first element out of its range; the
/// elements have the names the space gives them. A vector must have one for each of the joints.
template <class X>
void RequireEachInRange(std::string_view name, const X& x, std::string_view unit,
                        const Range& range, const Space& space = {}) {
  if constexpr (internal::Dense<X>)
    if (space.size() > 0) RequireOneForEach(space, name, x.size());
  std::vector<internal::Column> columns;
  std::vector<double> numbers;
  internal::Columns(x, space, std::string(name), unit, columns);
  internal::Numbers(x, numbers);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    RequireInRange("", columns[i].name, numbers[i], columns[i].unit, range);
}

/// x, checked as above; zero for every joint where it was left out.
template <class X>
X EachInRangeOr0(std::string_view name, const X& x, std::string_view unit, const Range& range,
                 const Joints& joints) {
  if (x.size() == 0) return X(PerJoint::Zero(joints.size()));
  RequireEachInRange(name, x, unit, range, joints);
  return x;
}

}  // namespace pliant
