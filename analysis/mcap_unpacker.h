#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "pliant/analysis/mcap_records.h"

namespace pliant::internal {

/// Unpacks chunks, one after the other.
class Unpacker {
 public:
  /// The records of a chunk; valid until the next call. Throws Error if they cannot be unpacked or
  /// are not what their CRC says.
  Bytes Unpack(McapWindow& window, const ChunkHead& chunk);

 private:
  std::unique_ptr<std::byte[]> buffer_;
  std::uint64_t capacity_ = 0;
};

}  // namespace pliant::internal
