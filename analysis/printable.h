#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pliant {

/// A word of a file for a message or a terminal: what cannot be printed is written as `\x00`.
std::string Printable(std::string_view word);

/// The beginning of UTF-8: as many whole characters as `bytes` bytes have room for.
std::string FirstBytes(std::string_view text, std::size_t bytes);

}  // namespace pliant
