#include "pliant/analysis/mcap_copy.h"

#include <algorithm>
#include <concepts>
#include <cstring>

namespace pliant::internal {

namespace {

constexpr std::size_t kBlock = 1 << 20;

template <std::integral T>
void Put(std::string& out, T number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void Put(std::string& out, Bytes bytes) {
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void PutText(std::string& out, std::string_view text) {
  Put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

void PutHead(std::string& out, Op op, std::uint64_t length) {
  Put(out, static_cast<std::uint8_t>(op));
  Put(out, length);
}

void PutRecord(std::string& out, Op op, std::string_view content) {
  PutHead(out, op, content.size());
  out += content;
}

Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

}  // namespace

McapCopy::McapCopy(PartFile& file, std::string_view profile, std::string_view library)
    : file_{file}, out_{kMcapMagic} {
  std::string header;
  PutText(header, profile);
  PutText(header, library);
  PutRecord(out_, Op::Header, header);
}

void McapCopy::Write() {
  file_.Write(out_);
  crc_ = Crc32(BytesOf(out_), crc_);
  written_ += out_.size();
  out_.clear();
}

void McapCopy::Count(const MessageRecord& message) {
  from_ = messages_ == 0 ? message.log_time : std::min(from_, message.log_time);
  to_ = std::max(to_, message.log_time);
  ++messages_;
  ++messages_of_[message.channel];
}

void McapCopy::Add(Op op, Bytes content) {
  const std::uint64_t at = written_ + out_.size();
  const ByteReader in(content, "", 0);
  const std::string text(reinterpret_cast<const char*>(content.data()), content.size());
  std::string index;
  Put(index, at);
  Put(index, kRecordHead + content.size());
  if (op == Op::Schema) schemas_.emplace(SchemaRecord(in).id, text);
  if (op == Op::Channel) channels_.emplace(ChannelRecord(in).id, text);
  if (op == Op::Message) Count(MessageRecord(in));
  if (op == Op::Metadata) {
    PutText(index, MetadataRecord(in).name);
    PutRecord(metadata_indexes_, Op::MetadataIndex, index);
    ++metadata_;
  }
  if (op == Op::Attachment) {
    const AttachmentRecord attachment(in);
    Put(index, attachment.log_time);
    Put(index, attachment.create_time);
    Put(index, attachment.data_size);
    PutText(index, attachment.name);
    PutText(index, attachment.media_type);
    PutRecord(attachment_indexes_, Op::AttachmentIndex, index);
    ++attachments_;
  }
  PutRecord(out_, op, text);
  if (out_.size() > kBlock) Write();
}

void McapCopy::AddChunk(std::string_view compression, std::uint32_t crc, Bytes packed,
                        Bytes records) {
  std::map<std::uint16_t, std::string> index_of;
  std::uint64_t from = UINT64_MAX, to = 0;
  ForEachRecord(ByteReader(records, "", 0), "", [&](Op op, ByteReader content) {
    if (op != Op::Message) return;
    const std::uint64_t at = content.at() - kRecordHead;
    const MessageRecord message(content);
    Count(message);
    Put(index_of[message.channel], message.log_time);
    Put(index_of[message.channel], at);
    from = std::min(from, message.log_time);
    to = std::max(to, message.log_time);
  });
  if (from > to) from = to = 0;

  const std::uint64_t at = written_ + out_.size();
  std::string front;
  Put(front, from);
  Put(front, to);
  Put(front, std::uint64_t{records.size()});
  Put(front, crc);
  PutText(front, compression);
  Put(front, std::uint64_t{packed.size()});
  PutHead(out_, Op::Chunk, front.size() + packed.size());
  out_ += front;
  Put(out_, packed);
  const std::uint64_t indexes_at = written_ + out_.size();

  std::string places;
  for (const auto& [channel, index] : index_of) {
    Put(places, channel);
    Put(places, written_ + out_.size());
    std::string content;
    Put(content, channel);
    PutText(content, index);
    PutRecord(out_, Op::MessageIndex, content);
  }

  std::string index;
  Put(index, from);
  Put(index, to);
  Put(index, at);
  Put(index, indexes_at - at);
  PutText(index, places);
  Put(index, written_ + out_.size() - indexes_at);
  PutText(index, compression);
  Put(index, std::uint64_t{packed.size()});
  Put(index, std::uint64_t{records.size()});
  PutRecord(chunk_indexes_, Op::ChunkIndex, index);
  ++chunk_count_;
  Write();
}

void McapCopy::Finish() {
  Write();
  const std::uint32_t data_crc = crc_;
  PutHead(out_, Op::DataEnd, sizeof data_crc);
  Put(out_, data_crc);
  Write();

  std::string statistics;
  Put(statistics, messages_);
  Put(statistics, static_cast<std::uint16_t>(schemas_.size()));
  Put(statistics, static_cast<std::uint32_t>(channels_.size()));
  Put(statistics, attachments_);
  Put(statistics, metadata_);
  Put(statistics, chunk_count_);
  Put(statistics, from_);
  Put(statistics, to_);
  std::string counts;
  for (const auto& [channel, count] : messages_of_) {
    Put(counts, channel);
    Put(counts, count);
  }
  PutText(statistics, counts);

  std::string schemas, channels, offsets;
  for (const auto& [id, content] : schemas_) PutRecord(schemas, Op::Schema, content);
  for (const auto& [id, content] : channels_) PutRecord(channels, Op::Channel, content);
  const std::uint64_t summary = written_;
  const auto add_group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    PutHead(offsets, Op::SummaryOffset, 1 + 8 + 8);
    Put(offsets, static_cast<std::uint8_t>(op));
    Put(offsets, written_ + out_.size());
    Put(offsets, std::uint64_t{records.size()});
    out_ += records;
  };
  add_group(Op::Schema, schemas);
  add_group(Op::Channel, channels);
  std::string statistics_record;
  PutRecord(statistics_record, Op::Statistics, statistics);
  add_group(Op::Statistics, statistics_record);
  add_group(Op::ChunkIndex, chunk_indexes_);
  add_group(Op::AttachmentIndex, attachment_indexes_);
  add_group(Op::MetadataIndex, metadata_indexes_);

  const std::uint64_t offsets_at = written_ + out_.size();
  out_ += offsets;
  PutHead(out_, Op::Footer, kFooterRecord - kRecordHead);
  Put(out_, summary);
  Put(out_, offsets_at);
  crc_ = 0;
  const std::uint32_t crc = Crc32(BytesOf(out_));
  Put(out_, crc);
  out_ += kMcapMagic;
  Write();
}

}  // namespace pliant::internal
