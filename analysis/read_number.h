#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace pliant::internal {

/// A text that is a number and nothing else, as std::from_chars reads it: no sign +, but inf and
/// nan.
template <class Number = double>
std::optional<Number> ReadNumber(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || at != end) return std::nullopt;
  return number;
}

}  // namespace pliant::internal
