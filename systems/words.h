#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

namespace pliant {

/// An enumeration with a word for each value, 0, 1, 2, …: `Words(E)` names them.
template <class E>
concept HasWords = std::is_enum_v<E> && requires(E e) {
  { Words(e) } -> std::same_as<const std::vector<std::string>&>;
};

template <HasWords E>
const std::string& WordOf(E e) {
  return Words(e)[static_cast<std::size_t>(e)];
}

}  // namespace pliant
