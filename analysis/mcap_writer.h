#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "pliant/analysis/mcap_records.h"
#include "pliant/analysis/message_sink.h"

namespace pliant::internal {

/// Writes an MCAP file: new messages, in chunks compressed with zstd, or records of another file,
/// each as it is; and what a file has besides: indexes, statistics, CRCs.
///
/// Source: mcap.dev/spec, version 0.
class McapWriter final : public MessageSink {
 public:
  using Sink = std::function<void(std::string_view)>;  ///< takes the bytes of the file in order

  /// Begins the file. What `sink` throws goes through all functions here; the file then ends.
  McapWriter(Sink sink, std::string_view profile, std::string_view library);
  ~McapWriter() override;
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  void AddMetadata(std::string_view name, const Words& words);
  std::uint16_t AddSchema(std::string_view name, std::string_view encoding,
                          std::string_view text) override;
  std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                           const Words& metadata) override;

  /// A message in the open chunk; returns where its `size` bytes go, until the next call. The chunk
  /// names all schemas and channels before their messages, and so can be read when all before it is
  /// lost.
  char* AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) override;
  std::size_t chunk_bytes() const { return chunk_.size(); }  ///< before compression

  /// Closes the open chunk and hands it to the sink. Without messages it does nothing.
  void WriteChunk();

  /// A schema, channel, message, metadata or attachment, outside of chunks.
  void AddRecord(Op op, Bytes content);
  /// A chunk of such records, which it packs.
  void AddChunk(Bytes records);
  /// A chunk that is packed already: `packed` is what it holds, `records` the same unpacked.
  void AddPackedChunk(std::string_view compression, std::uint32_t crc, Bytes packed, Bytes records);

  /// Hands to the sink what has been added, but for the open chunk.
  void Flush();
  /// Writes the indexes and the statistics: the file is complete.
  void Finish();

  std::uint64_t messages() const { return messages_; }  ///< written, outside of the open chunk
  std::uint64_t chunks() const { return chunks_; }

 private:
  struct Compressor;

  std::uint64_t at() const { return written_ + out_.size(); }  // where the next record will be
  void Count(const MessageRecord& message);
  std::string Statistics() const;

  const Sink sink_;
  std::string out_;            // not yet written
  std::uint64_t written_ = 0;  // before `out_`
  std::uint32_t crc_ = 0;      // of it
  std::unique_ptr<Compressor> compressor_;
  std::string chunk_;                                        // the open one
  std::map<std::uint16_t, std::string> schemas_, channels_;  // their records
  std::string chunk_indexes_, attachment_indexes_, metadata_indexes_;
  std::uint32_t chunks_ = 0, attachments_ = 0, metadata_ = 0;
  std::map<std::uint16_t, std::uint64_t> messages_of_;
  std::uint64_t messages_ = 0, from_ = 0, to_ = 0;
};

}  // namespace pliant::internal
