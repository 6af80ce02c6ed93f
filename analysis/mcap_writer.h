#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/analysis/log_file.h"

namespace pliant::internal {

/// Writes an MCAP file: messages in chunks, compressed with zstd, and where to find them. Schemas
/// and channels stand before their first message, and again in each chunk.
///
/// Source: mcap.dev/spec, version 0.
class McapWriter {
 public:
  using Words = std::map<std::string, std::string>;

  /// Writes the file's first bytes. Throws Error, as all functions here do, if the file cannot be
  /// written.
  McapWriter(LogFile& file, std::string_view profile, std::string_view library);
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  void AddMetadata(std::string_view name, const Words& words);
  std::uint16_t AddSchema(std::string_view name, std::string_view encoding, std::string_view text);
  std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                           const Words& metadata);

  /// A message in the open chunk; returns where its `size` bytes go, until the next call.
  char* AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size);
  std::size_t chunk_bytes() const { return chunk_.size(); }  ///< before compression

  /// Closes the open chunk and hands it to the system. Without messages it does nothing.
  void WriteChunk();

  /// Writes the index and the statistics: the file is complete.
  void Finish();

 private:
  struct Span {
    std::int64_t first_ns, last_ns;
    void Add(std::int64_t ns);
  };
  static constexpr Span kNoTime{INT64_MAX, INT64_MIN};
  struct ChunkIndex {
    Span time;
    std::int64_t begin, bytes, index_bytes;
    std::map<std::uint16_t, std::int64_t> message_index;  // by channel: where in the file
    std::size_t compressed, uncompressed;
  };
  struct MetadataIndex {
    std::int64_t begin, bytes;
    std::string name;
  };
  struct Channel {
    std::vector<std::pair<std::int64_t, std::int64_t>> in_chunk;  // time, place in the chunk
    std::int64_t messages = 0;
  };
  struct Compressor;

  void Write(std::string_view bytes);
  void PutSummary();

  LogFile& file_;
  std::uint32_t data_crc_ = 0;
  std::unique_ptr<Compressor> compressor_;
  std::string chunk_, out_;
  Span chunk_time_ = kNoTime, time_ = kNoTime;
  std::string schemas_, channel_records_;  // once more for the summary
  int schema_count_ = 0;
  std::vector<Channel> channels_;  // channel i + 1 of the file
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
};

}  // namespace pliant::internal
