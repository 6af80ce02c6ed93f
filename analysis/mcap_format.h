#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "pliant/analysis/printable.h"

/// What every MCAP file is made of, as https://mcap.dev/spec, version 0, says.
namespace pliant::internal {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
inline constexpr std::uint64_t kRecordHead = 9;     ///< an opcode and a length
inline constexpr std::uint64_t kFooterRecord = 29;  ///< with its head
/// The most bytes that a chunk, packed or not, or another record that is read, may have.
inline constexpr std::uint64_t kLargestRecord = std::uint64_t{1} << 30;

enum class Op : std::uint8_t {
  Header = 0x01,
  Footer,
  Schema,
  Channel,
  Message,
  Chunk,
  MessageIndex,
  ChunkIndex,
  Attachment,
  AttachmentIndex,
  Statistics,
  Metadata,
  MetadataIndex,
  SummaryOffset,
  DataEnd,
};

/// "chunk", "message index", …
std::string NameOf(Op op);

}  // namespace pliant::internal
