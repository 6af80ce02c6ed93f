#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace pliant::internal {

using Bytes = std::span<const std::byte>;

inline Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

inline std::string_view TextOf(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Of these bytes and those before them, whose sum is `before`.
std::uint32_t Crc32(Bytes bytes, std::uint32_t before = 0);

}  // namespace pliant::internal
