#include "pliant/analysis/mcap_records.h"

#include <algorithm>

namespace pliant::internal {

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

void RequireNotTooLarge(const McapFile& file, std::uint64_t at, const std::string& what,
                        std::uint64_t bytes) {
  if (bytes > kLargestRecord)
    throw Error(file.At(at) + what + " must have at most " + Text(kLargestRecord) + " bytes, got " +
                Text(bytes));
}

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

}  // namespace pliant::internal
