#include "pliant/analysis/mcap_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "pliant/analysis/mcap_channels.h"
#include "pliant/analysis/mcap_records.h"
#include "pliant/analysis/mcap_unpacker.h"

namespace pliant {

using namespace internal;

namespace {

struct Footer {
  std::uint64_t at, summary;  ///< where it begins; 0 if there is none
  std::uint32_t crc;
};

/// Empty if the file does not end as it should.
std::optional<Footer> ReadFooter(McapWindow& window, std::uint64_t begin) {
  const std::uint64_t size = window.file().size();
  constexpr std::uint64_t kTail = kFooterRecord + kMcapMagic.size();
  if (size < begin || size - begin < kTail) return {};
  const std::uint64_t at = size - kTail;
  const Bytes tail = window.At(at, kTail);
  if (std::memcmp(tail.data() + kFooterRecord, kMcapMagic.data(), kMcapMagic.size()) != 0)
    return {};
  ByteReader in(tail.first(kFooterRecord), window.file().place(), at);
  if (in.Take<Op>("") != Op::Footer || in.Take<std::uint64_t>("") != kFooterRecord - kRecordHead)
    return {};
  Footer footer{at, in.Take<std::uint64_t>(""), 0};
  in.Take<std::uint64_t>("");
  footer.crc = in.Take<std::uint32_t>("");
  if (footer.summary != 0 && (footer.summary < begin || footer.summary > at))
    throw Error(window.file().At(at) + "the index must lie between byte " + Text(begin) +
                " and byte " + Text(at) + ", the file says byte " + Text(footer.summary));
  return footer;
}

/// Calls on_head(RecordHead) for each record up to the data end, and inside chunks and outside
/// on_record(Op, ByteReader) for each schema, channel, message and metadata.
class DataWalk {
 public:
  /// With `sum` it sums all bytes of the file that it walks over and those before them.
  explicit DataWalk(const McapFile& file, bool sum = false) : window_{file}, sum_{sum} {}

  template <class WantChunk, class OnRecord>
  void Run(std::uint64_t begin, std::uint64_t end, WantChunk&& want_chunk, OnRecord&& on_record) {
    if (sum_) crc_ = window_.file().Crc(0, begin);
    for (at_ = begin;;) {
      const RecordHead head = ReadHead(window_, at_, end);
      if (sum_ && head.op != Op::DataEnd) Sum(head);
      switch (head.op) {
        case Op::DataEnd:
          data_crc_ = ReadContent(window_, head).Take<std::uint32_t>("the CRC of the data");
          return;
        case Op::Chunk: {
          const ChunkHead chunk = ReadChunkHead(window_, head);
          if (want_chunk(chunk)) ReadChunk(chunk, on_record);
          break;
        }
        case Op::Schema:
        case Op::Channel:
        case Op::Message:
        case Op::Metadata:
          on_record(head.op, ReadContent(window_, head));
          break;
        case Op::Header:
        case Op::Footer:
          throw Error(window_.file().At(at_) + "a " + NameOf(head.op) +
                      " does not belong between the data");
        default:
          break;
      }
      at_ = head.end();
    }
  }

  /// Of the record that is being read, or was when something was wrong; in the end of the data end.
  std::uint64_t at() const { return at_; }
  std::uint32_t data_crc() const { return data_crc_; }  ///< as the data end says
  std::uint32_t crc() const { return crc_; }            ///< as it is
  McapWindow& window() { return window_; }

 private:
  /// Leaves the record in the window for those who read it.
  void Sum(const RecordHead& head) {
    crc_ = head.length > kLargestRecord ? window_.file().Crc(head.at, head.end(), crc_)
                                        : Crc32(window_.At(head.at, head.end() - head.at), crc_);
  }

  template <class OnRecord>
  void ReadChunk(const ChunkHead& chunk, OnRecord&& on_record) {
    const std::string place = chunk.Place(window_.file());
    const Bytes records = unpacker_.Unpack(window_, chunk);
    ForEachRecord(ByteReader(records, place, 0), place, [&](Op op, ByteReader content) {
      if (op == Op::Schema || op == Op::Channel || op == Op::Message) {
        on_record(op, content);
      } else if (op <= Op::DataEnd) {
        content.Fail("a record of opcode " + Text(static_cast<int>(op)) +
                     " does not belong in a chunk");
      }
    });
  }

  McapWindow window_;
  Unpacker unpacker_;
  const bool sum_;
  std::uint64_t at_ = 0;
  std::uint32_t data_crc_ = 0, crc_ = 0;
};

}  // namespace

McapReader::McapReader(const std::filesystem::path& file)
    : file_{std::make_unique<McapFile>(file)}, begin_{kMcapMagic.size()}, end_{file_->size()} {
  McapWindow window(*file_);
  std::optional<Footer> footer;
  std::string fault;
  try {
    const RecordHead head = ReadHead(window, begin_, end_);
    if (head.op != Op::Header)
      throw Error(file_->At(begin_) + "a header must be here, found a " + NameOf(head.op));
    ByteReader header = ReadContent(window, head);
    profile_ = header.TakeText("the profile");
    library_ = header.TakeText("the library");
    begin_ = head.end();
    footer = ReadFooter(window, begin_);
    if (footer) {
      end_ = footer->summary != 0 ? footer->summary : footer->at;
      if (footer->crc != 0) {
        const std::uint32_t crc = file_->Crc(end_, file_->size() - kMcapMagic.size() - 4);
        if (crc != footer->crc) throw Error(file_->At(end_) + "the index is damaged: wrong CRC");
      }
      indexed_ = ReadIndex(end_, footer->at);
    }
  } catch (const Error& error) {
    fault = error.what();
    if (!footer) end_ = file_->size();
  }
  if (indexed_) return;
  try {
    ReadAll();
    if (fault.empty() && !footer)
      fault = file_->At(file_->size()) + "the file ends without an index and a footer";
  } catch (const Error& error) {
    if (fault.empty()) fault = error.what();
  }
  if (!fault.empty()) fault_ = Broken(fault);
}

McapReader::~McapReader() = default;
McapReader::McapReader(McapReader&&) noexcept = default;
McapReader& McapReader::operator=(McapReader&&) noexcept = default;

std::uint64_t McapReader::bytes() const { return file_->size(); }

std::string McapReader::WayOut() const {
  return "`pliant log repair " + file_->name() + "` makes a whole log of what is readable";
}

std::string McapReader::Broken(const std::string& fault) const {
  std::string text = fault + "\n" + Text(messages_) + " messages";
  if (messages_ > 0)
    text += ", from " + Text(1e-9 * static_cast<double>(from_)) + " s to " +
            Text(1e-9 * static_cast<double>(to_)) + " s,";
  return text + " can be read before it; " + WayOut();
}

/// False if the index does not tell all that is to be known.
bool McapReader::ReadIndex(std::uint64_t from, std::uint64_t to) {
  McapWindow window(*file_);
  McapChannels channels;
  std::optional<StatisticsRecord> statistics;
  std::vector<std::uint64_t> metadata;
  for (std::uint64_t at = from; at < to;) {
    const RecordHead head = ReadHead(window, at, to);
    at = head.end();
    if (head.op == Op::Schema) channels.AddSchema(ReadContent(window, head));
    if (head.op == Op::Channel) channels.AddChannel(ReadContent(window, head));
    if (head.op == Op::Statistics) statistics.emplace(ReadContent(window, head));
    if (head.op == Op::MetadataIndex)
      metadata.push_back(ReadContent(window, head).Take<std::uint64_t>("the place of metadata"));
  }
  if (!statistics || statistics->metadata != metadata.size()) return false;
  std::vector<McapChannel> found = channels.List();
  if (statistics->channels != found.size()) return false;

  Metadata words;
  for (const std::uint64_t at : metadata) {
    if (at < begin_ || at > end_)
      throw Error(file_->At(from) + "metadata must lie between byte " + Text(begin_) +
                  " and byte " + Text(end_) + ", the index says byte " + Text(at));
    const RecordHead head = ReadHead(window, at, end_);
    if (head.op != Op::Metadata)
      throw Error(file_->At(at) + "metadata must be here, found a " + NameOf(head.op));
    MetadataRecord record(ReadContent(window, head));
    for (auto& [key, word] : record.words) words[record.name][key] = std::move(word);
  }
  for (McapChannel& channel : found)
    if (const auto count = statistics->messages_of.find(channel.id);
        count != statistics->messages_of.end())
      channel.messages = count->second;
  channels_ = std::move(found);
  metadata_ = std::move(words);
  messages_ = statistics->messages;
  from_ = statistics->from;
  to_ = statistics->to;
  return true;
}

/// What the index would have told, as far as the file can be read.
void McapReader::ReadAll() {
  McapChannels channels;
  std::map<std::uint16_t, std::uint64_t> counts;
  DataWalk walk(*file_);
  const auto keep = [&] {
    channels_ = channels.List();
    for (McapChannel& channel : channels_) channel.messages = counts[channel.id];
  };
  const auto on_record = [&](Op op, ByteReader content) {
    if (op == Op::Schema) channels.AddSchema(content);
    if (op == Op::Channel) channels.AddChannel(content);
    if (op == Op::Metadata) {
      MetadataRecord record(content);
      for (auto& [key, word] : record.words) metadata_[record.name][key] = std::move(word);
    }
    if (op == Op::Message) {
      const MessageRecord message(content);
      channels.RequireKnown(message.channel, content);
      from_ = messages_ == 0 ? message.log_time : std::min(from_, message.log_time);
      to_ = std::max(to_, message.log_time);
      ++counts[message.channel];
      ++messages_;
    }
  };
  try {
    walk.Run(
        begin_, end_, [](const ChunkHead&) { return true; }, on_record);
  } catch (const Error&) {
    keep();
    throw;
  }
  keep();
}

void McapReader::ForEach(const Filter& filter,
                         const std::function<void(const McapMessage&)>& act) const {
  if (!fault_.empty()) throw Error(fault_);
  std::map<std::uint16_t, const McapChannel*> wanted;
  for (const McapChannel& channel : channels_)
    if (filter.topics.empty() || std::ranges::count(filter.topics, channel.topic) > 0)
      wanted[channel.id] = &channel;
  const bool all = filter.topics.empty() && filter.from == 0 &&
                   filter.to == std::numeric_limits<std::uint64_t>::max();

  std::uint64_t messages = 0;
  bool acting = false;
  DataWalk walk(*file_, all);
  const auto want_chunk = [&](const ChunkHead& chunk) {
    return all || (chunk.from <= filter.to && chunk.to >= filter.from);
  };
  const auto on_record = [&](Op op, ByteReader content) {
    if (op != Op::Message) return;
    const MessageRecord message(content);
    ++messages;
    if (message.log_time < filter.from || message.log_time > filter.to) return;
    const auto channel = wanted.find(message.channel);
    if (channel == wanted.end()) {
      if (filter.topics.empty())
        content.Fail("a message of channel " + Text(message.channel) +
                     ", which is not in the file");
      return;
    }
    acting = true;
    act({*channel->second, message.sequence, message.log_time, message.publish_time, message.data});
    acting = false;
  };
  try {
    walk.Run(begin_, end_, want_chunk, on_record);
    if (!all) return;
    if (messages != messages_)
      throw Error(file_->At(walk.at()) + "there are " + Text(messages) +
                  " messages before it, but the index says " + Text(messages_));
    if (walk.data_crc() != 0 && walk.crc() != walk.data_crc())
      throw Error(file_->At(walk.at()) + "the data before it are damaged: wrong CRC");
  } catch (const Error& error) {
    if (acting) throw;
    throw Error(error.what() + ("\n" + WayOut()));
  }
}

}  // namespace pliant
