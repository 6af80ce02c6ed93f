#include "pliant/analysis/mcap_writer.h"

#include <zstd.h>

#include <algorithm>
#include <utility>

#include "pliant/analysis/mcap_put.h"
#include "pliant/systems/error.h"

namespace pliant::internal {
namespace {

constexpr std::string_view kCompression = "zstd";
constexpr int kLevel = 1;  // noise of sensors compresses hardly better at higher ones
constexpr std::size_t kMessageHead = 2 + 4 + 8 + 8;
constexpr std::size_t kBlock = 1 << 20;

using Records = std::map<std::uint16_t, std::string>;

std::uint16_t Next(const Records& records) {
  return static_cast<std::uint16_t>(records.empty() ? 1 : records.rbegin()->first + 1);
}

std::string Joined(const Records& records) {
  std::string all;
  for (const auto& [id, record] : records) all += record;
  return all;
}

}  // namespace

struct McapWriter::Compressor {
  ZSTD_CCtx* context = ZSTD_createCCtx();
  std::string out;

  ~Compressor() { ZSTD_freeCCtx(context); }

  Bytes operator()(Bytes bytes) {
    out.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compressCCtx(context, out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
    if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
    return BytesOf(out).first(size);
  }
};

McapWriter::McapWriter(Sink sink, std::string_view profile, std::string_view library)
    : sink_{std::move(sink)}, out_{kMcapMagic}, compressor_{std::make_unique<Compressor>()} {
  std::string header;
  Put(header, profile);
  Put(header, library);
  PutRecord(out_, Op::Header, header);
}

McapWriter::~McapWriter() = default;

void McapWriter::Flush() {
  sink_(out_);
  crc_ = Crc32(BytesOf(out_), crc_);
  written_ += out_.size();
  out_.clear();
}

void McapWriter::AddMetadata(std::string_view name, const Words& words) {
  std::string metadata;
  Put(metadata, name);
  Put(metadata, words);
  AddRecord(Op::Metadata, BytesOf(metadata));
}

std::uint16_t McapWriter::AddSchema(std::string_view name, std::string_view encoding,
                                    std::string_view text) {
  const std::uint16_t id = Next(schemas_);
  std::string schema;
  Put(schema, id);
  Put(schema, name);
  Put(schema, encoding);
  Put(schema, text);
  AddRecord(Op::Schema, BytesOf(schema));
  return id;
}

std::uint16_t McapWriter::AddChannel(std::uint16_t schema, std::string_view topic,
                                     std::string_view encoding, const Words& metadata) {
  const std::uint16_t id = Next(channels_);
  std::string channel;
  Put(channel, id);
  Put(channel, schema);
  Put(channel, topic);
  Put(channel, encoding);
  Put(channel, metadata);
  AddRecord(Op::Channel, BytesOf(channel));
  return id;
}

char* McapWriter::AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) {
  if (chunk_.empty()) chunk_ = Joined(schemas_) + Joined(channels_);
  PutHead(chunk_, Op::Message, kMessageHead + size);
  Put(chunk_, channel);
  Put(chunk_, std::uint32_t{0});  // messages are not counted
  Put(chunk_, time_ns);           // logged
  Put(chunk_, time_ns);           // published
  chunk_.resize(chunk_.size() + size);
  return chunk_.data() + chunk_.size() - size;
}

void McapWriter::WriteChunk() {
  if (chunk_.empty()) return;
  AddChunk(BytesOf(chunk_));
  chunk_.clear();
}

void McapWriter::AddChunk(Bytes records) {
  AddPackedChunk(kCompression, Crc32(records), (*compressor_)(records), records);
}

void McapWriter::Count(const MessageRecord& message) {
  from_ = messages_ == 0 ? message.log_time : std::min(from_, message.log_time);
  to_ = std::max(to_, message.log_time);
  ++messages_;
  ++messages_of_[message.channel];
}

void McapWriter::AddRecord(Op op, Bytes content) {
  const ByteReader in(content, "", 0);
  std::string record, index;
  PutRecord(record, op, TextOf(content));
  Put(index, at());
  Put(index, std::uint64_t{record.size()});
  if (op == Op::Schema) schemas_.emplace(SchemaRecord(in).id, record);
  if (op == Op::Channel) channels_.emplace(ChannelRecord(in).id, record);
  if (op == Op::Schema || op == Op::Channel)
    if (!chunk_.empty()) chunk_ += record;
  if (op == Op::Message) Count(MessageRecord(in));
  if (op == Op::Metadata) {
    Put(index, std::string_view(MetadataRecord(in).name));
    PutRecord(metadata_indexes_, Op::MetadataIndex, index);
    ++metadata_;
  }
  if (op == Op::Attachment) {
    const AttachmentRecord attachment(in);
    Put(index, attachment.log_time);
    Put(index, attachment.create_time);
    Put(index, attachment.data_size);
    Put(index, std::string_view(attachment.name));
    Put(index, std::string_view(attachment.media_type));
    PutRecord(attachment_indexes_, Op::AttachmentIndex, index);
    ++attachments_;
  }
  out_ += record;
  if (out_.size() > kBlock) Flush();
}

void McapWriter::AddPackedChunk(std::string_view compression, std::uint32_t crc, Bytes packed,
                                Bytes records) {
  std::map<std::uint16_t, std::string> index_of;  // by channel: time and place of its messages
  std::uint64_t from = UINT64_MAX, to = 0;
  ForEachRecord(ByteReader(records, "", 0), "", [&](Op op, ByteReader content) {
    if (op != Op::Message) return;
    const std::uint64_t place = content.at() - kRecordHead;
    const MessageRecord message(content);
    Count(message);
    std::string& index = index_of[message.channel];
    Put(index, message.log_time);
    Put(index, place);
    from = std::min(from, message.log_time);
    to = std::max(to, message.log_time);
  });
  if (from > to) from = to = 0;

  std::string front;
  Put(front, from);
  Put(front, to);
  Put(front, std::uint64_t{records.size()});
  Put(front, crc);
  Put(front, compression);
  Put(front, std::uint64_t{packed.size()});
  const std::uint64_t begin = at();
  PutHead(out_, Op::Chunk, front.size() + packed.size());
  out_ += front;
  out_ += TextOf(packed);

  const std::uint64_t indexes_begin = at();
  std::string places;
  for (const auto& [channel, index] : index_of) {
    Put(places, channel);
    Put(places, at());
    PutHead(out_, Op::MessageIndex, sizeof channel + sizeof(std::uint32_t) + index.size());
    Put(out_, channel);
    Put(out_, std::string_view(index));
  }

  std::string index;
  Put(index, from);
  Put(index, to);
  Put(index, begin);
  Put(index, indexes_begin - begin);
  Put(index, std::string_view(places));
  Put(index, at() - indexes_begin);
  Put(index, compression);
  Put(index, std::uint64_t{packed.size()});
  Put(index, std::uint64_t{records.size()});
  PutRecord(chunk_indexes_, Op::ChunkIndex, index);
  ++chunks_;
  Flush();
}

std::string McapWriter::Statistics() const {
  std::string statistics;
  Put(statistics, messages_);
  Put(statistics, static_cast<std::uint16_t>(schemas_.size()));
  Put(statistics, static_cast<std::uint32_t>(channels_.size()));
  Put(statistics, attachments_);
  Put(statistics, metadata_);
  Put(statistics, chunks_);
  Put(statistics, from_);
  Put(statistics, to_);
  PutSized<std::uint32_t>(statistics, [&] {
    for (const auto& [channel, count] : messages_of_) {
      Put(statistics, channel);
      Put(statistics, count);
    }
  });
  std::string record;
  PutRecord(record, Op::Statistics, statistics);
  return record;
}

void McapWriter::Finish() {
  WriteChunk();
  Flush();
  PutHead(out_, Op::DataEnd, sizeof crc_);
  Put(out_, crc_);
  Flush();

  const std::uint64_t summary = at();
  std::string offsets;
  const auto add_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    PutHead(offsets, Op::SummaryOffset, 1 + 8 + 8);
    Put(offsets, static_cast<std::uint8_t>(op));
    Put(offsets, at());
    Put(offsets, std::uint64_t{records.size()});
    out_ += records;
  };
  add_group(Op::Schema, Joined(schemas_));
  add_group(Op::Channel, Joined(channels_));
  add_group(Op::Statistics, Statistics());
  add_group(Op::ChunkIndex, chunk_indexes_);
  add_group(Op::AttachmentIndex, attachment_indexes_);
  add_group(Op::MetadataIndex, metadata_indexes_);

  const std::uint64_t offsets_begin = at();
  out_ += offsets;
  PutHead(out_, Op::Footer, kFooterRecord - kRecordHead);
  Put(out_, summary);
  Put(out_, offsets_begin);
  Put(out_, Crc32(BytesOf(out_)));
  out_ += kMcapMagic;
  Flush();
}

}  // namespace pliant::internal
