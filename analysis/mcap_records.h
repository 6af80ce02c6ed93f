#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "pliant/analysis/mcap_byte_reader.h"
#include "pliant/analysis/mcap_file.h"
#include "pliant/analysis/mcap_format.h"
#include "pliant/systems/error.h"

/// The records of an MCAP file as they are read. Every length is compared with what is there before
/// it is used: a file may be cut, damaged or made to do harm.
namespace pliant::internal {

/// Where a record lies in a file.
struct RecordHead {
  Op op;
  std::uint64_t at, length;  ///< of the opcode; without the head

  std::uint64_t content() const { return at + kRecordHead; }
  std::uint64_t end() const { return at + kRecordHead + length; }
};

/// The head of the record at `at`; throws Error if the record does not end before `end`.
RecordHead ReadHead(McapWindow& window, std::uint64_t at, std::uint64_t end);
/// The content of a record, checked against kLargestRecord.
ByteReader ReadContent(McapWindow& window, const RecordHead& head);
/// Throws Error if `what`, of the record at `at`, has more bytes than kLargestRecord.
void RequireNotTooLarge(const McapFile& file, std::uint64_t at, const std::string& what,
                        std::uint64_t bytes);

/// Calls f(Op, ByteReader content) for each of the records that follow one another in `records`.
template <class F>
void ForEachRecord(ByteReader records, std::string_view place, F&& f) {
  while (!records.empty()) {
    const auto op = records.Take<Op>("an opcode");
    const auto length = records.Take<std::uint64_t>("the length of a record");
    const std::uint64_t at = records.at();
    f(op, ByteReader(records.TakeBytes(length, "a record"), place, at));
  }
}

struct SchemaRecord {
  std::uint16_t id;
  std::string name, encoding, data;

  explicit SchemaRecord(ByteReader in);
  bool operator==(const SchemaRecord&) const = default;
};

struct ChannelRecord {
  std::uint16_t id, schema;
  std::string topic, encoding;
  std::map<std::string, std::string> metadata;

  explicit ChannelRecord(ByteReader in);
  bool operator==(const ChannelRecord&) const = default;
};

struct MessageRecord {
  std::uint16_t channel;
  std::uint32_t sequence;
  std::uint64_t log_time, publish_time;
  Bytes data;

  explicit MessageRecord(ByteReader in);
};

struct MetadataRecord {
  std::string name;
  std::map<std::string, std::string> words;

  explicit MetadataRecord(ByteReader in);
};

struct AttachmentRecord {
  std::uint64_t log_time, create_time;
  std::string name, media_type;
  std::uint64_t data_size;

  /// Throws Error if its CRC is wrong.
  explicit AttachmentRecord(ByteReader in);
};

struct StatisticsRecord {
  std::uint64_t messages;
  std::uint16_t schemas;
  std::uint32_t channels, attachments, metadata, chunks;
  std::uint64_t from, to;
  std::map<std::uint16_t, std::uint64_t> messages_of;  ///< by channel

  explicit StatisticsRecord(ByteReader in);
};

/// The front of a chunk record.
struct ChunkHead {
  std::uint64_t at;        ///< of the record
  std::uint64_t from, to;  ///< log times of its messages [ns]
  std::uint64_t size;      ///< of the records, unpacked
  std::uint32_t crc;       ///< of the records, unpacked; 0 if unknown
  std::string compression;
  std::uint64_t records, records_size;  ///< packed: where in the file, and how many bytes

  /// "FILE: in the chunk at byte N: "
  std::string Place(const McapFile& file) const;
};

ChunkHead ReadChunkHead(McapWindow& window, const RecordHead& head);

}  // namespace pliant::internal
