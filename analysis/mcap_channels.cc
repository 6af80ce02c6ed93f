#include "pliant/analysis/mcap_channels.h"

namespace pliant::internal {

void McapChannels::AddSchema(const ByteReader& content) {
  const SchemaRecord schema(content);
  const auto [at, added] = schemas_.try_emplace(schema.id, schema);
  if (!added && at->second != schema)
    content.Fail("two schemas have the number " + Text(schema.id) + ": " +
                 Printable(at->second.name) + " and " + Printable(schema.name));
}

void McapChannels::AddChannel(const ByteReader& content) {
  const ChannelRecord channel(content);
  const auto [at, added] = channels_.try_emplace(channel.id, channel);
  if (!added && at->second != channel)
    content.Fail("two channels have the number " + Text(channel.id) + ": " +
                 Printable(at->second.topic) + " and " + Printable(channel.topic));
}

void McapChannels::RequireKnown(std::uint16_t channel, const ByteReader& message) const {
  if (!channels_.contains(channel))
    message.Fail("a message of channel " + Text(channel) + ", which has not been met before it");
}

std::vector<McapChannel> McapChannels::List() const {
  std::vector<McapChannel> list;
  for (const auto& [id, channel] : channels_) {
    McapChannel& out = list.emplace_back();
    out.id = id;
    out.topic = channel.topic;
    out.message_encoding = channel.encoding;
    out.metadata = channel.metadata;
    if (const auto schema = schemas_.find(channel.schema); schema != schemas_.end()) {
      out.schema_name = schema->second.name;
      out.schema_encoding = schema->second.encoding;
      out.schema = schema->second.data;
    }
  }
  return list;
}

}  // namespace pliant::internal
