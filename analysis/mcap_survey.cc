#include "pliant/analysis/mcap_survey.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "pliant/analysis/mcap_unpacker.h"

namespace pliant::internal {

namespace {

using Records = std::map<std::uint16_t, std::string>;

/// The first of the records of a number counts.
void Keep(Records& records, std::uint16_t id, Bytes content) {
  records.try_emplace(id, TextOf(content));
}

class Surveyor {
 public:
  Surveyor(const McapFile& file, McapSurvey& survey)
      : file_{file},
        survey_{survey},
        window_{file},
        work_left_{kWorkPerByte * file.size() + kLargestRecord} {}

  void Run() {
    ReadSummary(0);
    for (std::uint64_t at = kMcapMagic.size(); !ended_ && at < file_.size();) at = Step(at);
    if (!ended_)
      Lose(file_.size(), 0, file_.At(file_.size()) + "the file ends without a footer" + DataEnd());
    if (!survey_.losses.lost.empty() && any_checked_) LoseUnchecked();
    survey_.schemas.merge(unchecked_schemas_);
    survey_.channels.merge(unchecked_channels_);
  }

 private:
  // What looks like a chunk among damaged bytes may be none. So much of it is unpacked, for each
  // byte of the file, until the search is given up.
  static constexpr std::uint64_t kWorkPerByte = 16;
  static constexpr std::uint64_t kEmptyChunk = 40;  // without compression and records
  static constexpr std::uint64_t kPage = 4 << 10;   // what a bad sector takes along

  /// Reads the record at `at`; returns where the next one begins.
  std::uint64_t Step(std::uint64_t at) {
    std::optional<RecordHead> head;
    try {
      head = ReadHead(window_, at, file_.size());
      // A right CRC vouches for a record's length too.
      search_from_ = Take(*head) ? head->end() : at + 1;
      return head->end();
    } catch (const Error& error) {
      if (head && head->op == Op::Chunk) ++survey_.losses.chunks_lost;
      const std::uint64_t next =
          head && IsRecord(head->end()) ? head->end() : FindChunk(search_from_);
      Lose(at, next > at ? next - at : 0, error.what() + DataEnd());
      // The record before was said to be so long that it hid a chunk.
      if (next < at && !survey_.kept.empty() && survey_.kept.back().end() > next)
        survey_.kept.pop_back();
      search_from_ = std::max(search_from_, at + 1);
      return next;
    }
  }

  /// True if a CRC says that the record is right.
  bool Take(const RecordHead& head) {
    switch (head.op) {
      case Op::Header:
        TakeHeader(head);
        return false;
      case Op::Schema: {
        const ByteReader content = ReadContent(window_, head);
        if (!IsInDamagedSummary())
          Keep(unchecked_schemas_, SchemaRecord(content).id, ByteReader(content).Rest());
        return false;
      }
      case Op::Channel: {
        const ByteReader content = ReadContent(window_, head);
        if (!IsInDamagedSummary())
          Keep(unchecked_channels_, ChannelRecord(content).id, ByteReader(content).Rest());
        return false;
      }
      case Op::Message: {
        const MessageRecord message(ReadContent(window_, head));
        KeepRecord({head, false}, message.log_time, message.log_time);
        return false;
      }
      case Op::Metadata:
        static_cast<void>(MetadataRecord(ReadContent(window_, head)));
        survey_.kept.push_back({head, false});
        return false;
      case Op::Attachment:
        static_cast<void>(AttachmentRecord(ReadContent(window_, head)));
        survey_.kept.push_back({head, false});
        return false;
      case Op::Chunk:
        return TakeChunk(head);
      case Op::DataEnd:
        data_end_ = head.at;
        data_crc_ = ReadContent(window_, head).Take<std::uint32_t>("the CRC of the data");
        if (summary_damaged_) ReadSummary(head.end());
        return false;
      case Op::Footer:
        TakeFooter(head);
        return false;
      case Op::MessageIndex:
      case Op::ChunkIndex:
      case Op::AttachmentIndex:
      case Op::Statistics:
      case Op::MetadataIndex:
      case Op::SummaryOffset:
        return false;  // made anew
    }
    throw Error(file_.At(head.at) + "no record begins here: its opcode is " +
                Text(static_cast<int>(head.op)));
  }

  void TakeHeader(const RecordHead& head) {
    if (head.at != kMcapMagic.size())
      throw Error(file_.At(head.at) + "a header does not belong here");
    ByteReader in = ReadContent(window_, head);
    survey_.profile = in.TakeText("the profile");
    survey_.library = in.TakeText("the library");
  }

  void TakeFooter(const RecordHead& head) {
    const std::uint64_t left = file_.size() - head.end();
    if (left != kMcapMagic.size() ||
        std::memcmp(window_.At(head.end(), left).data(), kMcapMagic.data(), left) != 0)
      throw Error(file_.At(head.end()) + "the end of the file must be \\x89MCAP0\\r\\n");
    ended_ = true;
    if (data_crc_ != 0 && survey_.losses.lost.empty() && file_.Crc(0, data_end_) != data_crc_)
      Lose(data_end_, 0,
           file_.At(data_end_) + "the data before it are damaged: wrong CRC; all chunks are right");
  }

  bool TakeChunk(const RecordHead& head) {
    const ChunkHead chunk = ReadChunkHead(window_, head);
    const std::string place = chunk.Place(file_);
    const Bytes records = unpacker_.Unpack(window_, chunk);
    const bool checked = chunk.crc != 0;
    std::uint64_t from = UINT64_MAX, to = 0;
    Records schemas, channels;
    ForEachRecord(ByteReader(records, place, 0), place, [&](Op op, ByteReader content) {
      if (op == Op::Schema) {
        Keep(schemas, SchemaRecord(content).id, ByteReader(content).Rest());
      } else if (op == Op::Channel) {
        Keep(channels, ChannelRecord(content).id, ByteReader(content).Rest());
      } else if (op == Op::Message) {
        const MessageRecord message(content);
        from = std::min(from, message.log_time);
        to = std::max(to, message.log_time);
      } else if (op <= Op::DataEnd) {
        content.Fail("a " + NameOf(op) + " does not belong in a chunk");
      }
    });
    (checked ? survey_.schemas : unchecked_schemas_).merge(schemas);
    (checked ? survey_.channels : unchecked_channels_).merge(channels);
    any_checked_ = any_checked_ || checked;
    KeepRecord({head, checked}, from, to);
    return checked;
  }

  /// With messages between these times, if from ≤ to.
  void KeepRecord(const McapSurvey::Kept& record, std::uint64_t from, std::uint64_t to) {
    survey_.kept.push_back(record);
    kept_since_loss_ = true;
    data_end_ = 0;  // it was none
    if (from > to) return;
    std::vector<LostPart>& lost = survey_.losses.lost;
    if (!lost.empty() && !lost.back().before) lost.back().before = from;
    last_time_ = std::max(last_time_.value_or(0), to);
  }

  void Lose(std::uint64_t at, std::uint64_t bytes, const std::string& fault) {
    LogRepair& losses = survey_.losses;
    losses.bytes_lost += bytes;
    if (kept_since_loss_ || losses.lost.empty())
      losses.lost.push_back({at, bytes, fault, last_time_, {}});
    else
      losses.lost.back().bytes += bytes;
    kept_since_loss_ = false;
  }

  std::string DataEnd() const {
    return data_end_ == 0 ? "" : "; all data come before it, only the index is lost";
  }

  void LoseUnchecked() {
    std::uint64_t bytes = 0;
    std::erase_if(survey_.kept, [&](const McapSurvey::Kept& kept) {
      if (kept.checked || (kept.op != Op::Chunk && kept.op != Op::Message)) return false;
      if (kept.op == Op::Chunk) ++survey_.losses.chunks_lost;
      bytes += kRecordHead + kept.length;
      return true;
    });
    if (bytes == 0) return;
    survey_.losses.bytes_lost += bytes;
    survey_.losses.lost.push_back(
        {0, bytes, file_.name() + ": messages without a CRC in a damaged log", {}, {}});
  }

  bool IsRecord(std::uint64_t at) {
    if (at == file_.size()) return true;
    try {
      return ReadHead(window_, at, file_.size()).op <= Op::DataEnd;
    } catch (const Error&) {
      return false;
    }
  }

  /// Throws only if it cannot be read: there may be a gigabyte of what looks like nothing.
  bool MayBeChunk(std::uint64_t at) {
    const std::uint64_t left = file_.size() - at - kRecordHead;
    ByteReader in(window_.At(at, kRecordHead + kEmptyChunk), file_.place(), at);
    in.Take<Op>("");
    const auto length = in.Take<std::uint64_t>("");
    const auto from = in.Take<std::uint64_t>(""), to = in.Take<std::uint64_t>("");
    const auto size = in.Take<std::uint64_t>("");
    const auto crc = in.Take<std::uint32_t>("");
    const auto compression = in.Take<std::uint32_t>("");
    return length >= kEmptyChunk && length <= left && from <= to && size <= kLargestRecord &&
           crc != 0 && compression <= std::string_view("zstd").size();
  }

  bool IsChunk(std::uint64_t at) {
    try {
      if (!MayBeChunk(at)) return false;
      const RecordHead head = ReadHead(window_, at, file_.size());
      const ChunkHead chunk = ReadChunkHead(window_, head);
      const std::uint64_t work = chunk.records_size + chunk.size;
      if (chunk.records + chunk.records_size != head.end() || work > work_left_) return false;
      work_left_ -= work;
      unpacker_.Unpack(window_, chunk);
      return true;
    } catch (const Error&) {
      return false;
    }
  }

  static std::uint64_t ToNextPage(std::uint64_t at) { return kPage - at % kPage; }

  /// The bytes from `begin` to the end of its page; empty if they cannot be read.
  Bytes PageAt(McapWindow& pages, std::uint64_t begin) const {
    try {
      return pages.At(begin, std::min(ToNextPage(begin), file_.size() - begin));
    } catch (const Error&) {
      return {};
    }
  }

  /// Where the next chunk with a right CRC begins; the end of the file if there is none.
  std::uint64_t FindChunk(std::uint64_t from) {
    constexpr std::byte kChunk{static_cast<std::uint8_t>(Op::Chunk)};
    constexpr std::uint64_t kLeast = kRecordHead + kEmptyChunk;
    McapWindow pages(file_);
    for (std::uint64_t begin = from; begin + kLeast <= file_.size(); begin += ToNextPage(begin)) {
      const Bytes page = PageAt(pages, begin);
      for (auto i = std::ranges::find(page, kChunk); i != page.end();
           i = std::find(i + 1, page.end(), kChunk)) {
        const std::uint64_t at = begin + static_cast<std::uint64_t>(i - page.begin());
        if (at + kLeast <= file_.size() && IsChunk(at)) return at;
      }
    }
    return file_.size();
  }

  /// Believes the channels and schemas of the index if its CRC is right. It begins where the footer
  /// says or, if bytes have been lost or added, at `begin`.
  void ReadSummary(std::uint64_t begin) {
    const std::uint64_t tail = kFooterRecord + kMcapMagic.size();
    if (file_.size() < kMcapMagic.size() + tail) return;
    try {
      const std::uint64_t at = file_.size() - tail;
      const RecordHead footer = ReadHead(window_, at, file_.size());
      if (footer.op != Op::Footer || footer.end() + kMcapMagic.size() != file_.size()) return;
      ByteReader in = ReadContent(window_, footer);
      const auto said = in.Take<std::uint64_t>("");
      in.Take<std::uint64_t>("");
      const auto crc = in.Take<std::uint32_t>("");
      if (begin == 0) begin = said;
      if (crc == 0 || begin == 0) return;
      summary_damaged_ = begin > at || file_.Crc(begin, footer.end() - sizeof crc) != crc;
      if (summary_damaged_) return;
      for (std::uint64_t next = begin; next < at;) {
        const RecordHead head = ReadHead(window_, next, at);
        next = head.end();
        const ByteReader content = ReadContent(window_, head);
        if (head.op == Op::Schema)
          Keep(survey_.schemas, SchemaRecord(content).id, ByteReader(content).Rest());
        if (head.op == Op::Channel)
          Keep(survey_.channels, ChannelRecord(content).id, ByteReader(content).Rest());
      }
    } catch (const Error&) {
      return;  // then what the data say has to do
    }
  }

  bool IsInDamagedSummary() const { return summary_damaged_ && data_end_ != 0; }

  const McapFile& file_;
  McapSurvey& survey_;
  McapWindow window_;
  Unpacker unpacker_;
  std::uint64_t work_left_;
  std::uint64_t search_from_ = kMcapMagic.size();
  std::uint64_t data_end_ = 0;
  std::uint32_t data_crc_ = 0;
  bool summary_damaged_ = false, ended_ = false, kept_since_loss_ = false, any_checked_ = false;
  std::optional<std::uint64_t> last_time_;
  Records unchecked_schemas_, unchecked_channels_;
};

}  // namespace

McapSurvey::McapSurvey(const McapFile& file) { Surveyor(file, *this).Run(); }

}  // namespace pliant::internal
