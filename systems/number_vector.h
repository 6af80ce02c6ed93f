#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/block.h"

namespace pliant {

/// Most numbers of a NumberVector: a position and a velocity of each joint.
inline constexpr int kMaxNumbers = 2 * kMaxJoints;

/// What the numbers of a vector are called, in order.
class Names : public Space {
 public:
  Names() = default;
  Names(std::initializer_list<std::string_view> names)
      : Names(std::vector<std::string>(names.begin(), names.end())) {}
  explicit Names(std::vector<std::string> names) : Space(std::move(names)) {
    Require(size() <= kMaxNumbers, "a vector has at most " + Text(kMaxNumbers) + " numbers",
            size());
  }

  /// n names: x1 … xn.
  static Names Numbered(Eigen::Index n, std::string_view letter = "x") {
    std::vector<std::string> names;
    for (Eigen::Index i = 1; i <= n; ++i) names.push_back(std::string(letter) + std::to_string(i));
    return Names(std::move(names));
  }
};

/// Numbers of different units in one column, such as the state of a linear model. Multiplexer makes
/// one of typed values, Demultiplexer takes typed values out of one.
struct NumberVector : Signal<NumberVector, Names, Eigen::Dynamic, kMaxNumbers> {
  using Signal::Signal;
  using Rate = NumberVector;
  static constexpr Quantity quantity{"vector of numbers", ""};
};

namespace internal {

/// How many numbers a signal of this space has.
template <class S>
Eigen::Index NumbersOf(const typename SpaceOf<S>::type& space) {
  return static_cast<Eigen::Index>(Count(ZeroOf<S>(space)));
}

/// A double as a column of one number, any other signal as it is.
template <Dense S>
const S& AsColumn(const S& x) {
  return x;
}
inline Eigen::Matrix<double, 1, 1> AsColumn(double x) { return Eigen::Matrix<double, 1, 1>(x); }

/// The way back.
template <class S, class E>
S FromColumn(const Eigen::MatrixBase<E>& column) {
  if constexpr (Dense<S>)
    return S(column);
  else
    return column.value();
}

/// K x, and not on the heap.
template <class To, class From>
To Times(const Eigen::MatrixXd& K, const From& x) {
  if constexpr (Dense<To>) {
    To y;
    y.noalias() = K * AsColumn(x);
    return y;
  } else if constexpr (Dense<From>) {
    return K.row(0).transpose().dot(x);
  } else {
    return K(0, 0) * x;
  }
}

/// Throws "<name> must be 2×3, <why>, got 3×2", or that it is not finite.
void RequireShape(std::string_view name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                  Eigen::Index cols, std::string_view why);

}  // namespace internal
}  // namespace pliant
