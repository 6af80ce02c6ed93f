#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/error.h"

/// The records of an MCAP file, as https://mcap.dev/spec lays them out. Every length is compared
/// with what is there before it is used: a file may be cut, damaged or made to do harm.
namespace pliant::internal {

using Bytes = std::span<const std::byte>;

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

/// A word of a file for a message: what cannot be printed is written as \x00.
std::string Printable(std::string_view word);

std::uint32_t Crc32(Bytes bytes, std::uint32_t begun = 0);

/// A file that is open for reading.
class McapFile {
 public:
  /// Throws Error if it cannot be opened or is not an MCAP file.
  explicit McapFile(std::filesystem::path path);
  ~McapFile();
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;

  const std::string& name() const { return name_; }
  const std::string& place() const { return place_; }  ///< "FILE: "
  std::uint64_t size() const { return size_; }
  void Read(std::uint64_t at, std::span<std::byte> to) const;
  std::uint32_t Crc(std::uint64_t from, std::uint64_t to) const;
  /// "FILE: at byte N: "
  std::string At(std::uint64_t at) const;

 private:
  const std::string name_, place_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// A piece of a file in memory, which moves along with what is read.
class McapWindow {
 public:
  explicit McapWindow(const McapFile& file) : file_{file} {}
  const McapFile& file() const { return file_; }
  /// n bytes that the file has; valid until the next call.
  Bytes At(std::uint64_t at, std::uint64_t n);

 private:
  const McapFile& file_;
  std::vector<std::byte> bytes_;
  std::uint64_t begin_ = 0;
};

/// Takes numbers and words from bytes, one after the other. Throws Error with the place if they end
/// too early.
class ByteReader {
 public:
  /// `place` is put in front of messages and `at` is the first byte's number there.
  ByteReader(Bytes bytes, std::string_view place, std::uint64_t at)
      : bytes_{bytes}, place_{place}, at_{at} {}

  bool empty() const { return bytes_.empty(); }
  std::size_t left() const { return bytes_.size(); }
  std::uint64_t at() const { return at_; }

  template <class T>
  T Take(const char* what) {
    T number;
    std::memcpy(&number, TakeBytes(sizeof number, what).data(), sizeof number);
    return number;
  }
  Bytes TakeBytes(std::uint64_t n, const char* what) {
    if (n > bytes_.size()) Short(n, what);
    const Bytes taken = bytes_.first(n);
    bytes_ = bytes_.subspan(n);
    at_ += n;
    return taken;
  }
  std::string TakeText(const char* what);
  std::map<std::string, std::string> TakeMap(const char* what);
  /// The next bytes, as many as a number in front of them says.
  ByteReader TakeReader(const char* what);
  /// All that is left.
  Bytes Rest() { return TakeBytes(bytes_.size(), ""); }
  [[noreturn]] void Fail(const std::string& what) const;

 private:
  [[noreturn]] void Short(std::uint64_t n, const char* what) const;

  Bytes bytes_;
  std::string_view place_;
  std::uint64_t at_;
};

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
