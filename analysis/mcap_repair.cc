#include "pliant/analysis/mcap_repair.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "pliant/analysis/mcap_put.h"
#include "pliant/analysis/mcap_survey.h"
#include "pliant/analysis/mcap_unpacker.h"
#include "pliant/analysis/mcap_writer.h"
#include "pliant/analysis/write_file.h"

namespace pliant {

using namespace internal;

namespace {

std::string Seconds(std::uint64_t ns) { return Text(1e-9 * static_cast<double>(ns)) + " s"; }

std::string Count(std::uint64_t number, const std::string& what) {
  return Text(number) + ' ' + what + (number == 1 ? "" : "s");
}

using Records = std::map<std::uint16_t, std::string>;

bool IsIn(const Records& records, std::uint16_t id, ByteReader content) {
  const auto at = records.find(id);
  return at != records.end() && std::ranges::equal(BytesOf(at->second), content.Rest());
}

/// What a whole log says of its channels. A channel whose schema is lost has none there.
class Channels {
 public:
  explicit Channels(const McapSurvey& survey)
      : schemas_{survey.schemas}, found_{survey.channels}, written_{survey.channels} {
    for (auto& [id, content] : written_)
      if (!schemas_.contains(ChannelRecord(ByteReader(BytesOf(content), "", 0)).schema))
        content[2] = content[3] = '\0';
  }

  void AddTo(McapWriter& whole) const {
    for (const auto& [id, content] : schemas_) whole.AddRecord(Op::Schema, BytesOf(content));
    for (const auto& [id, content] : written_) whole.AddRecord(Op::Channel, BytesOf(content));
  }

  bool Have(std::uint16_t id) const { return written_.contains(id); }

  /// Some of the records of a chunk.
  struct Part {
    std::string records;
    std::uint64_t messages_lost = 0;
  };

  /// Those that agree with it; empty if all do.
  std::optional<Part> Agreeing(Bytes records) const {
    Part part;
    std::set<std::uint16_t> strange;  // channels that are something else elsewhere
    bool all = true;
    ForEachRecord(ByteReader(records, "", 0), "", [&](Op op, ByteReader content) {
      bool keep = true;
      if (op == Op::Schema) keep = IsIn(schemas_, SchemaRecord(content).id, content);
      if (op == Op::Channel) {
        const std::uint16_t id = ChannelRecord(content).id;
        keep = IsIn(written_, id, content);
        if (!IsIn(found_, id, content)) strange.insert(id);
      }
      if (op == Op::Message) {
        const std::uint16_t id = MessageRecord(content).channel;
        keep = Have(id) && !strange.contains(id);
        if (!keep) ++part.messages_lost;
      }
      all = all && keep;
      if (keep) PutRecord(part.records, op, TextOf(content.Rest()));
    });
    return all ? std::nullopt : std::optional(std::move(part));
  }

 private:
  const Records& schemas_;
  const Records& found_;
  Records written_;
};

}  // namespace

std::string LogRepair::text() const {
  std::string text = "kept " + Count(messages, "message") + " in " + Count(chunks, "chunk");
  if (messages_lost > 0)
    text += "\nlost " + Count(messages_lost, "message") + " of unknown channels";
  for (const LostPart& part : lost) {
    text += "\nlost " + Count(part.bytes, "byte");
    if (part.after) text += " after " + Seconds(*part.after);
    if (part.before) text += (part.after ? " and before " : " before ") + Seconds(*part.before);
    text += ": " + part.fault;
  }
  return text;
}

LogRepair RepairLog(const std::filesystem::path& from, const std::filesystem::path& to,
                    bool force) {
  const McapFile file(from);
  std::error_code no_such_file;
  if (std::filesystem::equivalent(from, to, no_such_file))
    throw Error("cannot repair " + from.string() + " in its place; name another file to write");
  RequireNewFile(to, force);

  McapSurvey survey(file);
  const Channels channels(survey);
  PartFile part(to);
  const auto sink = [&](std::string_view bytes) { part.Write(bytes); };
  McapWriter whole(sink, survey.profile, survey.library);
  channels.AddTo(whole);
  LogRepair& repair = survey.losses;
  McapWindow window(file);
  Unpacker unpacker;
  for (const RecordHead& head : survey.kept) {
    if (head.op == Op::Chunk) {
      const ChunkHead chunk = ReadChunkHead(window, head);
      const Bytes records = unpacker.Unpack(window, chunk);
      if (const auto some = channels.Agreeing(records)) {
        repair.messages_lost += some->messages_lost;
        whole.AddChunk(BytesOf(some->records));
      } else {
        const Bytes packed = window.At(chunk.records, chunk.records_size);
        whole.AddPackedChunk(chunk.compression, chunk.crc, packed,
                             chunk.compression.empty() ? packed : records);
      }
    } else {
      ByteReader content = ReadContent(window, head);
      if (head.op == Op::Message && !channels.Have(MessageRecord(content).channel)) {
        ++repair.messages_lost;
        continue;
      }
      whole.AddRecord(head.op, content.Rest());
    }
  }
  repair.messages = whole.messages();
  repair.chunks = whole.chunks();
  if (!repair.whole())
    whole.AddMetadata("repair", {{"messages kept", Text(repair.messages)},
                                 {"messages lost in chunks kept", Text(repair.messages_lost)},
                                 {"chunks kept", Text(repair.chunks)},
                                 {"chunks lost", Text(repair.chunks_lost)},
                                 {"bytes lost", Text(repair.bytes_lost)}});
  whole.Finish();
  part.MoveIntoPlace();
  return std::move(repair);
}

}  // namespace pliant
