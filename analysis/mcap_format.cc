#include "pliant/analysis/mcap_format.h"

#include <array>
#include <cstdio>

#include "pliant/systems/error.h"

namespace pliant::internal {

std::string NameOf(Op op) {
  constexpr std::array kNames{
      "header",     "footer",        "schema",         "channel",        "message",
      "chunk",      "message index", "chunk index",    "attachment",     "attachment index",
      "statistics", "metadata",      "metadata index", "summary offset", "data end"};
  const auto i = static_cast<std::size_t>(op);
  return i >= 1 && i <= kNames.size() ? kNames[i - 1] : "record of opcode " + Text(i);
}

std::string Printable(std::string_view word) {
  std::string text;
  for (const char c : word) {
    if (c >= 0 && (c < ' ' || c == '\x7f')) {
      std::array<char, 5> code;
      std::snprintf(code.data(), code.size(), "\\x%02x", static_cast<unsigned>(c));
      text += code.data();
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace pliant::internal
