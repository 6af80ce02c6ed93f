#pragma once

// The only way to include Simbody 3.7. Its index types make == ambiguous in C++20, and Debian
// builds it without NDEBUG, on which the layout of its classes depends.

#ifdef NDEBUG
#error "compile sources that include Simbody with -UNDEBUG: the layout of its classes depends on it"
#endif

#include <concepts>

namespace SimTK {
template <class I>
concept UniqueIndexType = requires(const I& i) {
  { I::Invalid() } -> std::same_as<const I&>;
  i.isValidExtended();
  static_cast<int>(i);
};
template <UniqueIndexType I>
constexpr bool operator==(const I& a, const I& b) {
  return static_cast<int>(a) == static_cast<int>(b);
}
}  // namespace SimTK

// Left out: in C++20, Clang refuses its vectors of classes that are not there yet.
#define SimTK_SIMMATH_MULTIBODY_GRAPH_MAKER_H_
#include <Simbody.h>
