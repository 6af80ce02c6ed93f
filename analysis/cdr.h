#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace pliant::internal {

/// A message in the encoding of ROS 2: little-endian, each number at a multiple of its size.
///
/// Source: OMG DDS-XTypes 1.3, 7.4.1 and 10.2 (plain CDR).
class Cdr {
 public:
  static constexpr std::string_view kHead{"\0\1\0\0", 4};  ///< plain, little-endian

  Cdr() : bytes_{kHead} {}

  template <class T>
  requires std::is_arithmetic_v<T> Cdr& operator<<(T x) {
    const std::size_t past = (bytes_.size() - kHead.size()) % sizeof x;
    if (past > 0) bytes_.append(sizeof x - past, '\0');
    bytes_.append(reinterpret_cast<const char*>(&x), sizeof x);
    return *this;
  }
  Cdr& operator<<(std::string_view text) {
    *this << static_cast<std::uint32_t>(text.size() + 1);
    bytes_ += text;
    bytes_ += '\0';
    return *this;
  }
  /// A sequence: how many, and each.
  template <class T>
  Cdr& operator<<(std::span<const T> all) {
    *this << static_cast<std::uint32_t>(all.size());
    for (const T& x : all) *this << x;
    return *this;
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace pliant::internal
