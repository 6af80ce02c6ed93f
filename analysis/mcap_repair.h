#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// A part of a damaged log that could not be read.
struct LostPart {
  std::uint64_t at = 0, bytes = 0;  ///< where in the file
  std::string fault;                ///< why
  /// Log times [ns] of the last message kept before it and of the first kept behind it; empty if
  /// there is none.
  std::optional<std::uint64_t> after, before;
};

/// What a repair has kept and what not.
struct LogRepair {
  std::uint64_t messages = 0, chunks = 0;  ///< kept
  std::uint64_t chunks_lost = 0;           ///< of which at least the front could be read
  std::uint64_t messages_lost = 0;         ///< in chunks kept: their channel is unknown
  std::uint64_t bytes_lost = 0;
  std::vector<LostPart> lost;

  bool whole() const { return lost.empty() && messages_lost == 0; }
  std::string text() const;  ///< a line for each loss
};

/// Makes a whole log `to` of what can be read of the MCAP file `from`, with an index, statistics
/// and a footer. Chunks are copied as they are, without those whose CRC is wrong or which cannot be
/// unpacked; behind damage the next chunk with a right CRC is looked for. What stands outside of
/// chunks has no CRC of its own and is copied if it can be read. The metadata "repair" of a log
/// with losses says what they were.
///
/// `from` stays as it is. Throws Error if it is no MCAP file, or if `to` is there and is not to be
/// written over or cannot be written; an older file then stays as it was.
LogRepair RepairLog(const std::filesystem::path& from, const std::filesystem::path& to,
                    bool force = false);

}  // namespace pliant
