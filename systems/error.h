#pragma once

#include <concepts>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pliant {

/// What a user can mend: a wrong wire, parameter, file or input. The message says what is wrong,
/// where, what was found and, where there is one, the way out. Thrown while building, loading and
/// integrating; never by a rule.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Shortest text of a number or other streamable value, as it stands in messages.
template <class T>
std::string Text(const T& value) {
  std::ostringstream out;
  out.precision(10);
  out << std::boolalpha << value;
  return out.str();
}

/// Throws "<rule>, got <found>" unless `holds`. A block's path is put in front of it when the block
/// is added to a diagram.
template <class T>
constexpr void Require(bool holds, std::string_view rule, const T& found) {
  if (!holds) throw Error(std::string(rule) + ", got " + Text(found));
}
inline void Require(bool holds, std::string_view rule) {
  if (!holds) throw Error(std::string(rule));
}

}  // namespace pliant
