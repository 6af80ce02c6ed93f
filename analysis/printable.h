#pragma once

#include <string>
#include <string_view>

namespace pliant {

/// A word of a file for a message or a terminal: what cannot be printed is written as `\x00`.
std::string Printable(std::string_view word);

}  // namespace pliant
