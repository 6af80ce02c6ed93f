#include "pliant/analysis/mcap_writer.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include "pliant/systems/error.h"

namespace pliant::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "MCAP and our CDR are little-endian");

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr std::string_view kCompression = "zstd";
constexpr int kLevel = 1;  // noise of sensors compresses hardly better at higher ones
constexpr std::size_t kMessageHead = 2 + 4 + 8 + 8;

enum class Op : std::uint8_t {
  Header = 1,
  Footer = 2,
  Schema = 3,
  Channel = 4,
  Message = 5,
  Chunk = 6,
  MessageIndex = 7,
  ChunkIndex = 8,
  Statistics = 11,
  Metadata = 12,
  MetadataIndex = 13,
  SummaryOffset = 14,
  DataEnd = 15,
};

template <std::integral T>
void Put(std::string& out, T x) {
  out.append(reinterpret_cast<const char*>(&x), sizeof x);
}

void Put(std::string& out, std::string_view text) {
  Put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

/// What `put` appends, with its length of type Length in front.
template <class Length, class Fill>
void PutSized(std::string& out, const Fill& put) {
  const std::size_t at = out.size();
  Put(out, Length{0});
  put();
  const Length length = static_cast<Length>(out.size() - at - sizeof(Length));
  std::memcpy(out.data() + at, &length, sizeof length);
}

/// A record with what `put` appends.
template <class Fill>
void PutRecord(std::string& out, Op op, const Fill& put) {
  Put(out, static_cast<std::uint8_t>(op));
  PutSized<std::uint64_t>(out, put);
}

void Put(std::string& out, const McapWriter::Words& words) {
  PutSized<std::uint32_t>(out, [&] {
    for (const auto& [key, value] : words) {
      Put(out, std::string_view(key));
      Put(out, std::string_view(value));
    }
  });
}

std::uint32_t Crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// A time that no message has is written as 0.
std::uint64_t Time(std::int64_t ns, bool any) { return any ? static_cast<std::uint64_t>(ns) : 0; }

}  // namespace

struct McapWriter::Compressor {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  std::string out;

  ~Compressor() { ZSTD_freeCCtx(context); }

  std::string_view operator()(std::string_view bytes) {
    out.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compressCCtx(context, out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
    if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
    return {out.data(), size};
  }
};

void McapWriter::Span::Add(std::int64_t ns) {
  first_ns = std::min(first_ns, ns);
  last_ns = std::max(last_ns, ns);
}

McapWriter::McapWriter(LogFile& file, std::string_view profile, std::string_view library)
    : file_{file}, compressor_{std::make_unique<Compressor>()} {
  out_ = kMagic;
  PutRecord(out_, Op::Header, [&] {
    Put(out_, profile);
    Put(out_, library);
  });
  Write(out_);
}

McapWriter::~McapWriter() = default;

void McapWriter::Write(std::string_view bytes) {
  file_.Write(bytes);
  data_crc_ = Crc(bytes, data_crc_);
}

void McapWriter::AddMetadata(std::string_view name, const Words& words) {
  out_.clear();
  PutRecord(out_, Op::Metadata, [&] {
    Put(out_, name);
    Put(out_, words);
  });
  metadata_.push_back({file_.size(), static_cast<std::int64_t>(out_.size()), std::string(name)});
  Write(out_);
}

std::uint16_t McapWriter::AddSchema(std::string_view name, std::string_view encoding,
                                    std::string_view text) {
  out_.clear();
  const auto id = static_cast<std::uint16_t>(++schema_count_);
  PutRecord(out_, Op::Schema, [&] {
    Put(out_, id);
    Put(out_, name);
    Put(out_, encoding);
    Put(out_, text);
  });
  schemas_ += out_;
  Write(out_);
  return id;
}

std::uint16_t McapWriter::AddChannel(std::uint16_t schema, std::string_view topic,
                                     std::string_view encoding, const Words& metadata) {
  out_.clear();
  channels_.emplace_back();
  const auto id = static_cast<std::uint16_t>(channels_.size());
  PutRecord(out_, Op::Channel, [&] {
    Put(out_, id);
    Put(out_, schema);
    Put(out_, topic);
    Put(out_, encoding);
    Put(out_, metadata);
  });
  channel_records_ += out_;
  Write(out_);
  return id;
}

char* McapWriter::AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) {
  // A chunk names its channels under its own CRC: it can be read when all before it is lost.
  if (chunk_.empty()) chunk_ = schemas_ + channel_records_;
  Channel& of = channels_[channel - 1u];
  of.in_chunk.emplace_back(time_ns, static_cast<std::int64_t>(chunk_.size()));
  ++of.messages;
  chunk_time_.Add(time_ns);
  Put(chunk_, static_cast<std::uint8_t>(Op::Message));
  Put(chunk_, static_cast<std::uint64_t>(kMessageHead + size));
  Put(chunk_, channel);
  Put(chunk_, std::uint32_t{0});  // messages are not counted
  Put(chunk_, time_ns);           // logged
  Put(chunk_, time_ns);           // published
  chunk_.resize(chunk_.size() + size);
  return chunk_.data() + chunk_.size() - size;
}

void McapWriter::WriteChunk() {
  if (chunk_.empty()) return;
  const std::string_view compressed = (*compressor_)(chunk_);
  ChunkIndex index{.time = chunk_time_,
                   .begin = file_.size(),
                   .bytes = 0,
                   .index_bytes = 0,
                   .message_index = {},
                   .compressed = compressed.size(),
                   .uncompressed = chunk_.size()};
  out_.clear();
  PutRecord(out_, Op::Chunk, [&] {
    Put(out_, chunk_time_.first_ns);
    Put(out_, chunk_time_.last_ns);
    Put(out_, static_cast<std::uint64_t>(chunk_.size()));
    Put(out_, Crc(chunk_));
    Put(out_, kCompression);
    Put(out_, static_cast<std::uint64_t>(compressed.size()));
    out_ += compressed;
  });
  index.bytes = static_cast<std::int64_t>(out_.size());
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& messages = channels_[i].in_chunk;
    if (messages.empty()) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    index.message_index.emplace(id, index.begin + static_cast<std::int64_t>(out_.size()));
    PutRecord(out_, Op::MessageIndex, [&] {
      Put(out_, id);
      PutSized<std::uint32_t>(out_, [&] {
        for (const auto& [time, at] : messages) {
          Put(out_, time);
          Put(out_, at);
        }
      });
    });
    messages.clear();
  }
  index.index_bytes = static_cast<std::int64_t>(out_.size()) - index.bytes;
  time_.Add(chunk_time_.first_ns);
  time_.Add(chunk_time_.last_ns);
  chunk_time_ = kNoTime;
  chunk_.clear();
  Write(out_);
  chunks_.push_back(std::move(index));
}

void McapWriter::Finish() {
  WriteChunk();
  out_.clear();
  const std::uint32_t crc = data_crc_;
  PutRecord(out_, Op::DataEnd, [&] { Put(out_, crc); });
  Write(out_);
  out_.clear();
  PutSummary();
  Write(out_);
}

void McapWriter::PutSummary() {
  const std::int64_t begin = file_.size();
  std::string offsets;
  const auto group = [&](Op op, const auto& put) {
    const std::size_t at = out_.size();
    put();
    if (out_.size() == at) return;
    PutRecord(offsets, Op::SummaryOffset, [&] {
      Put(offsets, static_cast<std::uint8_t>(op));
      Put(offsets, begin + static_cast<std::int64_t>(at));
      Put(offsets, static_cast<std::uint64_t>(out_.size() - at));
    });
  };
  const bool any = !chunks_.empty();

  group(Op::Schema, [&] { out_ += schemas_; });
  group(Op::Channel, [&] { out_ += channel_records_; });
  group(Op::Statistics, [&] {
    PutRecord(out_, Op::Statistics, [&] {
      Put(out_, std::accumulate(channels_.begin(), channels_.end(), std::int64_t{0},
                                [](std::int64_t n, const Channel& c) { return n + c.messages; }));
      Put(out_, static_cast<std::uint16_t>(schema_count_));
      Put(out_, static_cast<std::uint32_t>(channels_.size()));
      Put(out_, std::uint32_t{0});  // attachments
      Put(out_, static_cast<std::uint32_t>(metadata_.size()));
      Put(out_, static_cast<std::uint32_t>(chunks_.size()));
      Put(out_, Time(time_.first_ns, any));
      Put(out_, Time(time_.last_ns, any));
      PutSized<std::uint32_t>(out_, [&] {
        for (std::size_t i = 0; i < channels_.size(); ++i) {
          Put(out_, static_cast<std::uint16_t>(i + 1));
          Put(out_, channels_[i].messages);
        }
      });
    });
  });
  group(Op::ChunkIndex, [&] {
    for (const ChunkIndex& chunk : chunks_)
      PutRecord(out_, Op::ChunkIndex, [&] {
        Put(out_, chunk.time.first_ns);
        Put(out_, chunk.time.last_ns);
        Put(out_, chunk.begin);
        Put(out_, chunk.bytes);
        PutSized<std::uint32_t>(out_, [&] {
          for (const auto& [channel, at] : chunk.message_index) {
            Put(out_, channel);
            Put(out_, at);
          }
        });
        Put(out_, chunk.index_bytes);
        Put(out_, kCompression);
        Put(out_, static_cast<std::uint64_t>(chunk.compressed));
        Put(out_, static_cast<std::uint64_t>(chunk.uncompressed));
      });
  });
  group(Op::MetadataIndex, [&] {
    for (const MetadataIndex& metadata : metadata_)
      PutRecord(out_, Op::MetadataIndex, [&] {
        Put(out_, metadata.begin);
        Put(out_, metadata.bytes);
        Put(out_, std::string_view(metadata.name));
      });
  });

  const std::int64_t offsets_begin = begin + static_cast<std::int64_t>(out_.size());
  out_ += offsets;
  PutRecord(out_, Op::Footer, [&] {
    Put(out_, begin);
    Put(out_, offsets_begin);
    // The footer's length comes before what its sum covers: it is written ahead of its time.
    std::string covered = out_;
    const std::uint64_t length = 2 * sizeof(std::int64_t) + sizeof(std::uint32_t);
    std::memcpy(covered.data() + covered.size() - 2 * sizeof(std::int64_t) - sizeof length, &length,
                sizeof length);
    Put(out_, Crc(covered));
  });
  out_ += kMagic;
}

}  // namespace pliant::internal
