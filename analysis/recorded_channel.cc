#include "pliant/analysis/recorded_channel.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pliant/analysis/cdr.h"
#include "pliant/analysis/mcap_bytes.h"
#include "pliant/analysis/printable.h"
#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

std::vector<std::string> Words(const McapChannel& channel, const std::string& key) {
  const auto fail = [&](const std::string& found) {
    throw Error(Printable(channel.topic) + ": the channel's metadata " + key +
                " must be a list of words in JSON, got " + found);
  };
  const auto at = channel.metadata.find(key);
  if (at == channel.metadata.end()) fail("none");
  const auto list = nlohmann::json::parse(at->second, nullptr, /*allow_exceptions=*/false);
  const auto is_word = [](const nlohmann::json& word) { return word.is_string(); };
  if (!list.is_array() || !std::ranges::all_of(list, is_word)) fail(Printable(at->second));
  return list.get<std::vector<std::string>>();
}

}  // namespace

std::optional<RecordedValue> RecordedIn(const McapChannel& channel) {
  const auto path = channel.metadata.find("pliant.path");
  if (path == channel.metadata.end()) return std::nullopt;
  const auto type = channel.metadata.find("pliant.type");
  RecordedValue value{.path = path->second,
                      .type = type == channel.metadata.end() ? "" : type->second,
                      .elements = Words(channel, "pliant.elements"),
                      .units = Words(channel, "pliant.units")};
  if (value.elements.size() != value.units.size())
    throw Error(Printable(channel.topic) + ": there must be a unit for each element, got " +
                Text(value.units.size()) + " for " + Text(value.elements.size()));
  if (channel.message_encoding != "cdr")
    throw Error(Printable(channel.topic) + ": the messages must be cdr, got " +
                Printable(channel.message_encoding));
  return value;
}

void NumbersOf(const McapMessage& message, std::size_t count, double* to) {
  const bool is_cdr = TextOf(message.data).starts_with(Cdr::kHead);
  if (message.data.size() != Cdr::kHead.size() + count * sizeof(double) || !is_cdr)
    throw Error(Printable(message.channel.topic) + ": the message at " +
                Text(1e-9 * static_cast<double>(message.log_time)) + " s must be " + Text(count) +
                " numbers in little-endian CDR, got " + Text(message.data.size()) + " bytes");
  if (count > 0) std::memcpy(to, message.data.data() + Cdr::kHead.size(), count * sizeof(double));
}

std::string HoldsNoRecording(const std::filesystem::path& file, const McapReader& log) {
  constexpr std::size_t kShown = 20;
  std::string topics;
  for (std::size_t i = 0; i < log.channels().size() && i < kShown; ++i)
    topics += "\n  " + Printable(log.channels()[i].topic) + " : " +
              Printable(log.channels()[i].schema_name);
  if (log.channels().size() > kShown)
    topics += "\n  and " + Text(log.channels().size() - kShown) + " more";
  return file.string() + " is an MCAP file of " +
         (log.library().empty() ? "another program" : "'" + Printable(log.library()) + "'") +
         " and holds no recording of pliant\n" +
         (topics.empty() ? "it has no topics" : "its topics:" + topics);
}

}  // namespace pliant::internal
