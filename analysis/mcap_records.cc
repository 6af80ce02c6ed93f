#include "pliant/analysis/mcap_records.h"

#include <fcntl.h>
#include <lz4frame.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <new>
#include <utility>

namespace pliant::internal {

namespace {

static_assert(std::endian::native == std::endian::little, "MCAP's numbers are read as they lie");

constexpr std::uint64_t kWindow = 16 << 10;
constexpr std::uint64_t kBlock = 1 << 20;

std::string Words(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string Hex(std::uint32_t number) {
  std::array<char, 11> text;
  std::snprintf(text.data(), text.size(), "0x%08x", number);
  return text.data();
}

struct Lz4Context {
  LZ4F_dctx* context = nullptr;

  Lz4Context() {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
      throw std::bad_alloc();
  }
  ~Lz4Context() { LZ4F_freeDecompressionContext(context); }
  Lz4Context(const Lz4Context&) = delete;
  Lz4Context& operator=(const Lz4Context&) = delete;
};

/// Both return what is wrong; empty if all of `to` has been filled from all of `from`.
std::string UnpackZstd(Bytes from, std::span<std::byte> to) {
  const std::size_t n = ZSTD_decompress(to.data(), to.size(), from.data(), from.size());
  if (ZSTD_isError(n)) return ZSTD_getErrorName(n);
  return n == to.size() ? "" : "it has " + Text(n) + " bytes, not " + Text(to.size());
}

std::string UnpackLz4(Bytes from, std::span<std::byte> to) {
  const Lz4Context lz4;
  while (!from.empty()) {
    std::size_t written = to.size(), read = from.size();
    const std::size_t hint =
        LZ4F_decompress(lz4.context, to.data(), &written, from.data(), &read, nullptr);
    if (LZ4F_isError(hint)) return LZ4F_getErrorName(hint);
    if (written == 0 && read == 0) return "it has more bytes than the chunk says";
    to = to.subspan(written);
    from = from.subspan(read);
    if (from.empty() && hint != 0) return "its end is missing";
  }
  return to.empty() ? "" : "it has " + Text(to.size()) + " bytes less than the chunk says";
}

}  // namespace

std::string NameOf(Op op) {
  constexpr std::array kNames{
      "header",     "footer",        "schema",         "channel",        "message",
      "chunk",      "message index", "chunk index",    "attachment",     "attachment index",
      "statistics", "metadata",      "metadata index", "summary offset", "data end"};
  const auto i = static_cast<std::size_t>(op);
  return i >= 1 && i <= kNames.size() ? kNames[i - 1] : "record of opcode " + Text(i);
}

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

std::uint32_t Crc32(Bytes bytes, std::uint32_t begun) {
  return static_cast<std::uint32_t>(
      crc32_z(begun, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

McapFile::McapFile(std::filesystem::path path) : name_{path.string()}, place_{name_ + ": "} {
  // A pipe without a writer must not make us wait.
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw Error("cannot read " + name_ + ": " + std::strerror(errno));
  try {
    struct stat status;
    if (fstat(descriptor_, &status) != 0)
      throw Error("cannot read " + name_ + ": " + std::strerror(errno));
    if (!S_ISREG(status.st_mode)) throw Error("cannot read " + name_ + ": it is not a file");
    size_ = static_cast<std::uint64_t>(status.st_size);
    std::array<std::byte, 8> begin{};
    Read(0, std::span(begin).first(std::min<std::uint64_t>(size_, begin.size())));
    if (std::memcmp(begin.data(), kMcapMagic.data(), begin.size()) != 0)
      throw Error(name_ + ": not an MCAP file: " +
                  (size_ == 0 ? "it is empty" : "it does not begin with \\x89MCAP0\\r\\n"));
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

McapFile::~McapFile() { close(descriptor_); }

void McapFile::Read(std::uint64_t at, std::span<std::byte> to) const {
  while (!to.empty()) {
    const ssize_t n = pread(descriptor_, to.data(), to.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(At(at) + "cannot read: " + std::strerror(errno));
    if (n == 0) throw Error(At(at) + "the file has become shorter while it was read");
    to = to.subspan(static_cast<std::size_t>(n));
    at += static_cast<std::uint64_t>(n);
  }
}

std::uint32_t McapFile::Crc(std::uint64_t from, std::uint64_t to) const {
  std::vector<std::byte> block(std::min(kBlock, to - from));
  std::uint32_t crc = 0;
  while (from < to) {
    const std::span piece = std::span(block).first(std::min(kBlock, to - from));
    Read(from, piece);
    crc = Crc32(piece, crc);
    from += piece.size();
  }
  return crc;
}

std::string McapFile::At(std::uint64_t at) const { return name_ + ": at byte " + Text(at) + ": "; }

Bytes McapWindow::At(std::uint64_t at, std::uint64_t n) {
  if (at > file_.size() || n > file_.size() - at)
    throw Error(file_.At(at) + Text(n) + " bytes wanted, the file ends at byte " +
                Text(file_.size()));
  if (at < begin_ || at + n > begin_ + bytes_.size()) {
    bytes_.resize(std::min(std::max(n, kWindow), file_.size() - at));
    begin_ = at;
    file_.Read(at, bytes_);
  }
  return Bytes(bytes_).subspan(at - begin_, n);
}

std::string ByteReader::TakeText(const char* what) {
  return Words(TakeBytes(Take<std::uint32_t>(what), what));
}

ByteReader ByteReader::TakeReader(const char* what) {
  const auto size = Take<std::uint32_t>(what);
  const std::uint64_t at = at_;
  return {TakeBytes(size, what), place_, at};
}

std::map<std::string, std::string> ByteReader::TakeMap(const char* what) {
  std::map<std::string, std::string> map;
  for (ByteReader in = TakeReader(what); !in.empty();) {
    std::string key = in.TakeText(what);
    map[std::move(key)] = in.TakeText(what);
  }
  return map;
}

void ByteReader::Fail(const std::string& what) const {
  throw Error(std::string(place_) + "at byte " + Text(at_) + ": " + what);
}

void ByteReader::Short(std::uint64_t n, const char* what) const {
  Fail(std::string(what) + " has " + Text(n) + " bytes, but its record ends after " +
       Text(bytes_.size()));
}

RecordHead ReadHead(McapWindow& window, std::uint64_t at, std::uint64_t end) {
  const McapFile& file = window.file();
  if (at > end || end - at < kRecordHead)
    throw Error(file.At(at) + (at < end ? "the file ends within a record"
                                        : "the records end without a data end"));
  ByteReader in(window.At(at, kRecordHead), file.place(), at);
  const RecordHead head{in.Take<Op>("an opcode"), at, in.Take<std::uint64_t>("a length")};
  if (head.op == Op{0}) throw Error(file.At(at) + "no record begins here: its opcode is 0");
  if (head.length > end - at - kRecordHead)
    throw Error(file.At(at) + "the " + NameOf(head.op) + " has " + Text(head.length) +
                " bytes, but the file ends after " + Text(end - at - kRecordHead));
  return head;
}

namespace {

void RequireNotTooLarge(const McapFile& file, std::uint64_t at, const std::string& what,
                        std::uint64_t bytes) {
  if (bytes > kLargestRecord)
    throw Error(file.At(at) + what + " must have at most " + Text(kLargestRecord) + " bytes, got " +
                Text(bytes));
}

}  // namespace

ByteReader ReadContent(McapWindow& window, const RecordHead& head) {
  RequireNotTooLarge(window.file(), head.at, "a " + NameOf(head.op), head.length);
  return {window.At(head.content(), head.length), window.file().place(), head.content()};
}

SchemaRecord::SchemaRecord(ByteReader in)
    : id{in.Take<std::uint16_t>("the number of a schema")},
      name{in.TakeText("the name of a schema")},
      encoding{in.TakeText("the encoding of a schema")},
      data{in.TakeText("the text of a schema")} {
  if (id == 0) in.Fail("the number of a schema must not be 0");
}

ChannelRecord::ChannelRecord(ByteReader in)
    : id{in.Take<std::uint16_t>("the number of a channel")},
      schema{in.Take<std::uint16_t>("the schema of a channel")},
      topic{in.TakeText("the topic of a channel")},
      encoding{in.TakeText("the encoding of a channel")},
      metadata{in.TakeMap("the metadata of a channel")} {}

MessageRecord::MessageRecord(ByteReader in)
    : channel{in.Take<std::uint16_t>("the channel of a message")},
      sequence{in.Take<std::uint32_t>("the number of a message")},
      log_time{in.Take<std::uint64_t>("the time of a message")},
      publish_time{in.Take<std::uint64_t>("the time of a message")},
      data{in.Rest()} {}

MetadataRecord::MetadataRecord(ByteReader in)
    : name{in.TakeText("the name of metadata")}, words{in.TakeMap("metadata")} {}

AttachmentRecord::AttachmentRecord(ByteReader in) {
  ByteReader all = in;
  log_time = in.Take<std::uint64_t>("the time of an attachment");
  create_time = in.Take<std::uint64_t>("the time of an attachment");
  name = in.TakeText("the name of an attachment");
  media_type = in.TakeText("the type of an attachment");
  data_size = in.Take<std::uint64_t>("an attachment");
  in.TakeBytes(data_size, "an attachment");
  const std::uint64_t checked = in.at() - all.at();
  const auto crc = in.Take<std::uint32_t>("the CRC of an attachment");
  if (crc != 0 && Crc32(all.TakeBytes(checked, "an attachment")) != crc)
    in.Fail("the attachment " + Printable(name) + " is damaged: wrong CRC");
}

StatisticsRecord::StatisticsRecord(ByteReader in)
    : messages{in.Take<std::uint64_t>("the statistics")},
      schemas{in.Take<std::uint16_t>("the statistics")},
      channels{in.Take<std::uint32_t>("the statistics")},
      attachments{in.Take<std::uint32_t>("the statistics")},
      metadata{in.Take<std::uint32_t>("the statistics")},
      chunks{in.Take<std::uint32_t>("the statistics")},
      from{in.Take<std::uint64_t>("the statistics")},
      to{in.Take<std::uint64_t>("the statistics")} {
  for (ByteReader map = in.TakeReader("the statistics"); !map.empty();) {
    const auto channel = map.Take<std::uint16_t>("the statistics");
    messages_of[channel] = map.Take<std::uint64_t>("the statistics");
  }
}

std::string ChunkHead::Place(const McapFile& file) const {
  return file.name() + ": in the chunk at byte " + Text(at) + ": ";
}

ChunkHead ReadChunkHead(McapWindow& window, const RecordHead& head) {
  // Its numbers and a short word.
  constexpr std::uint64_t kFront = 64;
  ByteReader in(window.At(head.content(), std::min(head.length, kFront)), window.file().place(),
                head.content());
  ChunkHead chunk{.at = head.at,
                  .from = in.Take<std::uint64_t>("a chunk"),
                  .to = in.Take<std::uint64_t>("a chunk"),
                  .size = in.Take<std::uint64_t>("a chunk"),
                  .crc = in.Take<std::uint32_t>("a chunk"),
                  .compression = in.TakeText("the compression of a chunk"),
                  .records = 0,
                  .records_size = in.Take<std::uint64_t>("a chunk")};
  chunk.records = in.at();
  if (chunk.records_size > head.end() - chunk.records)
    in.Fail("the records of the chunk have " + Text(chunk.records_size) +
            " bytes, but the chunk ends after " + Text(head.end() - chunk.records));
  return chunk;
}

Bytes Unpacker::Unpack(McapWindow& window, const ChunkHead& chunk) {
  const McapFile& file = window.file();
  RequireNotTooLarge(file, chunk.at, "the packed records of a chunk", chunk.records_size);
  RequireNotTooLarge(file, chunk.at, "the records of a chunk", chunk.size);
  const Bytes packed = window.At(chunk.records, chunk.records_size);
  Bytes records = packed;
  std::string fault;
  if (chunk.compression.empty()) {
    if (chunk.size != packed.size())
      fault = "it has " + Text(packed.size()) + " bytes, not " + Text(chunk.size);
  } else {
    if (chunk.size > capacity_) {
      buffer_.reset();
      capacity_ = 0;
      buffer_.reset(new (std::nothrow) std::byte[chunk.size]);
      if (!buffer_)
        throw Error(file.At(chunk.at) + "no memory for a chunk of " + Text(chunk.size) + " bytes");
      capacity_ = chunk.size;
    }
    const std::span<std::byte> to(buffer_.get(), chunk.size);
    if (chunk.compression == "zstd") {
      fault = UnpackZstd(packed, to);
    } else if (chunk.compression == "lz4") {
      fault = UnpackLz4(packed, to);
    } else {
      fault =
          "its compression must be zstd, lz4 or empty, got '" + Printable(chunk.compression) + "'";
    }
    records = to;
  }
  if (!fault.empty()) throw Error(file.At(chunk.at) + "the chunk cannot be unpacked: " + fault);
  if (chunk.crc != 0)
    if (const std::uint32_t crc = Crc32(records); crc != chunk.crc)
      throw Error(file.At(chunk.at) + "the chunk is damaged: its CRC is " + Hex(crc) + ", not " +
                  Hex(chunk.crc));
  return records;
}

}  // namespace pliant::internal
