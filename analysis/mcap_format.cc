#include "pliant/analysis/mcap_format.h"

#include <array>

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

}  // namespace pliant::internal
