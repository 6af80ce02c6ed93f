#include "pliant/analysis/printable.h"

#include <array>
#include <cstdio>

namespace pliant {

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

std::string FirstBytes(std::string_view text, std::size_t bytes) {
  if (bytes >= text.size()) return std::string(text);
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0) == 0x80) --bytes;
  return std::string(text.substr(0, bytes));
}

}  // namespace pliant
