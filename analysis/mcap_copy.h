#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/mcap_records.h"
#include "pliant/analysis/write_file.h"

namespace pliant::internal {

/// Writes an MCAP file of records that are there already, each as it is, and makes what a file has
/// besides: indexes, statistics, CRCs.
class McapCopy {
 public:
  McapCopy(PartFile& file, std::string_view profile, std::string_view library);

  /// A schema, channel, message, metadata or attachment.
  void Add(Op op, Bytes content);
  /// `records` are those of the chunk, unpacked; `packed` is what it holds.
  void AddChunk(std::string_view compression, std::uint32_t crc, Bytes packed, Bytes records);
  /// Writes the rest; the file is complete.
  void Finish();

  std::uint64_t messages() const { return messages_; }
  std::uint64_t chunks() const { return chunk_count_; }

 private:
  void Count(const MessageRecord& message);
  void Write();

  PartFile& file_;
  std::string out_;                                          // not yet written
  std::uint64_t written_ = 0;                                // before `out_`
  std::uint32_t crc_ = 0;                                    // of it
  std::map<std::uint16_t, std::string> schemas_, channels_;  // once more for the summary
  std::string chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::uint32_t chunk_count_ = 0, attachments_ = 0, metadata_ = 0;
  std::map<std::uint16_t, std::uint64_t> messages_of_;
  std::uint64_t messages_ = 0, from_ = 0, to_ = 0;
};

}  // namespace pliant::internal
