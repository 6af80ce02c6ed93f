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

}  // namespace pliant
