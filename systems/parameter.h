#pragma once

#include <concepts>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pliant/systems/error.h"
#include "pliant/systems/space.h"
#include "pliant/systems/words.h"

namespace pliant {

/// The numbers a parameter may have; never NaN.
struct Range {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  bool without_least = false, without_most = false;  ///< the ends themselves are none of them

  bool Contains(double x) const {
    return (without_least ? x > least : x >= least) && (without_most ? x < most : x <= most);
  }
  std::string text() const;  ///< such as "> 0" or "from 0 to 1"
};

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{.least = 0, .without_least = true};
inline constexpr Range kNotNegative{.least = 0};
/// A limit that may be left out as kUnbounded.
inline constexpr Range kLimit{.least = 0, .most = kUnbounded, .without_least = true};
constexpr Range Between(double least, double most) { return {.least = least, .most = most}; }

/// The value of a parameter that must be given: it has no default.
inline constexpr double kToBeGiven = std::numeric_limits<double>::quiet_NaN();

/// A struct that names its parameters once, for checks, files, schemas and tables:
///
///   struct Gear {
///     double ratio = kToBeGiven;
///     Transmission transmission = Transmission::Rigid;
///
///     template <class F>
///     void Parameters(F&& f) {
///       f("ratio", ratio, "", kPositive);
///       f("transmission", transmission);
///     }
///   };
///
/// A parameter is a number, a flag, a word, a Duration, an enumerator that HasWords, a vector or
/// matrix of numbers, a struct that HasParameters, or a std::optional, std::vector or std::variant
/// of such; the alternatives of a variant have a `kTag`. What is NaN, an empty word, or a vector of
/// NaN, is to be given.
template <class T>
concept HasParameters = requires(T& t) {
  t.Parameters([](std::string_view, auto&, std::string_view = {}, const Range& = kAnyNumber) {});
};

/// Throws "<where>: gear_ratio must be > 0, got 0" for the first parameter out of its range, also
/// inside structs and what a std::optional holds: "<where>: pose.stiffness must be …". What blocks
/// check themselves, such as vectors, is left to them.
void RequireInRange(std::string_view where, std::string_view name, double value,
                    std::string_view unit, const Range& range);

namespace internal {

template <HasParameters T>
void RequireInRange(std::string_view where, const std::string& path, const T& parameters);

template <class T>
void RequireInRange(std::string_view where, const std::string& name, const T& value,
                    std::string_view unit, const Range& range) {
  if constexpr (std::is_arithmetic_v<T> && !std::same_as<T, bool>) {
    pliant::RequireInRange(where, name, static_cast<double>(value), unit, range);
  } else if constexpr (HasParameters<T>) {
    RequireInRange(where, name + ".", value);
  } else if constexpr (requires { value.has_value(); }) {
    if (value) RequireInRange(where, name, *value, unit, range);
  }
}

template <HasParameters T>
void RequireInRange(std::string_view where, const std::string& path, const T& parameters) {
  const_cast<T&>(parameters)
      .Parameters([&](std::string_view name, const auto& value, std::string_view unit = {},
                      const Range& range = kAnyNumber) {
        RequireInRange(where, path + std::string(name), value, unit, range);
      });
}

}  // namespace internal

template <HasParameters T>
void RequireInRange(std::string_view where, const T& parameters) {
  internal::RequireInRange(where, std::string(), parameters);
}

/// Throws "<name> has an element for each of the 7 joints, got 3".
void RequireOneForEach(const Space& joints, std::string_view name, std::ptrdiff_t found);

}  // namespace pliant
