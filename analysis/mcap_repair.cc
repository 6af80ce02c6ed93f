#include "pliant/analysis/mcap_repair.h"

#include <zstd.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "pliant/analysis/mcap_copy.h"
#include "pliant/analysis/mcap_survey.h"

namespace pliant {

using namespace internal;

namespace {

Bytes BytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

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

  void AddTo(McapCopy& copy) const {
    for (const auto& [id, content] : schemas_) copy.Add(Op::Schema, BytesOf(content));
    for (const auto& [id, content] : written_) copy.Add(Op::Channel, BytesOf(content));
  }

  bool Have(std::uint16_t id) const { return written_.contains(id); }

  /// The records of a chunk that agree with it; empty if all do.
  std::optional<std::string> Agreeing(Bytes records, std::uint64_t* messages_lost) const {
    std::string kept;
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
        if (!keep) ++*messages_lost;
      }
      all = all && keep;
      if (!keep) return;
      const std::uint64_t length = content.left();
      kept += static_cast<char>(op);
      kept.append(reinterpret_cast<const char*>(&length), sizeof length);
      kept.append(reinterpret_cast<const char*>(content.Rest().data()), length);
    });
    return all ? std::nullopt : std::optional(kept);
  }

 private:
  const Records& schemas_;
  const Records& found_;
  Records written_;
};

std::string Packed(std::string_view records) {
  std::string packed(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 1);
  if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

void AddMetadata(McapCopy& copy, std::string_view name,
                 const std::map<std::string, std::string>& words) {
  const auto text = [](std::string_view word) {
    const auto size = static_cast<std::uint32_t>(word.size());
    return std::string(reinterpret_cast<const char*>(&size), sizeof size) + std::string(word);
  };
  std::string map;
  for (const auto& [key, word] : words) map += text(key) + text(word);
  copy.Add(Op::Metadata, BytesOf(text(name) + text(map)));
}

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
  McapCopy copy(part, survey.profile, survey.library);
  channels.AddTo(copy);
  LogRepair& repair = survey.losses;
  McapWindow window(file);
  Unpacker unpacker;
  for (const RecordHead& head : survey.kept) {
    if (head.op == Op::Chunk) {
      const ChunkHead chunk = ReadChunkHead(window, head);
      const Bytes records = unpacker.Unpack(window, chunk);
      if (const auto some = channels.Agreeing(records, &repair.messages_lost)) {
        copy.AddChunk("zstd", Crc32(BytesOf(*some)), BytesOf(Packed(*some)), BytesOf(*some));
      } else {
        const Bytes packed = window.At(chunk.records, chunk.records_size);
        copy.AddChunk(chunk.compression, chunk.crc, packed,
                      chunk.compression.empty() ? packed : records);
      }
    } else {
      ByteReader content = ReadContent(window, head);
      if (head.op == Op::Message && !channels.Have(MessageRecord(content).channel)) {
        ++repair.messages_lost;
        continue;
      }
      copy.Add(head.op, content.Rest());
    }
  }
  repair.messages = copy.messages();
  repair.chunks = copy.chunks();
  if (!repair.whole())
    AddMetadata(copy, "repair",
                {{"messages kept", Text(repair.messages)},
                 {"messages lost in chunks kept", Text(repair.messages_lost)},
                 {"chunks kept", Text(repair.chunks)},
                 {"chunks lost", Text(repair.chunks_lost)},
                 {"bytes lost", Text(repair.bytes_lost)}});
  copy.Finish();
  part.MoveIntoPlace();
  return std::move(repair);
}

}  // namespace pliant
