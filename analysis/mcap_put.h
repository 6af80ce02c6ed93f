#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "pliant/analysis/mcap_format.h"

/// Appends to a string what the records of an MCAP file are made of.
namespace pliant::internal {

static_assert(std::endian::native == std::endian::little, "MCAP's numbers are written as they lie");

template <std::integral T>
void Put(std::string& out, T number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

inline void Put(std::string& out, std::string_view text) {
  Put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

/// What `put` appends, with its length of type Length in front.
template <class Length, class Fill>
void PutSized(std::string& out, const Fill& put) {
  const std::size_t at = out.size();
  Put(out, Length{0});
  put();
  const Length length = static_cast<Length>(out.size() - at - sizeof(Length));
  std::memcpy(out.data() + at, &length, sizeof length);
}

inline void Put(std::string& out, const std::map<std::string, std::string>& words) {
  PutSized<std::uint32_t>(out, [&] {
    for (const auto& [key, word] : words) {
      Put(out, std::string_view(key));
      Put(out, std::string_view(word));
    }
  });
}

inline void PutHead(std::string& out, Op op, std::uint64_t length) {
  Put(out, static_cast<std::uint8_t>(op));
  Put(out, length);
}

inline void PutRecord(std::string& out, Op op, std::string_view content) {
  PutHead(out, op, content.size());
  out += content;
}

}  // namespace pliant::internal
