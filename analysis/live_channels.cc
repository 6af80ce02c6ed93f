#include "pliant/analysis/live_channels.h"

#include <algorithm>
#include <utility>

namespace pliant::internal {

std::uint16_t LiveChannels::AddSchema(std::string_view name, std::string_view encoding,
                                      std::string_view text) {
  schemas_.push_back({std::string(name), std::string(encoding), std::string(text)});
  return static_cast<std::uint16_t>(schemas_.size());
}

std::uint16_t LiveChannels::AddChannel(std::uint16_t schema, std::string_view topic,
                                       std::string_view encoding, const Words& metadata) {
  const Schema& of = schemas_.at(schema - 1u);
  channels_.push_back({.id = static_cast<std::uint32_t>(channels_.size() + 1),
                       .topic = std::string(topic),
                       .encoding = std::string(encoding),
                       .schema_name = of.name,
                       .schema_encoding = of.encoding,
                       .schema = of.text,
                       .metadata = metadata});
  begun_(channels_.back());
  return static_cast<std::uint16_t>(channels_.size());
}

LiveChannel* LiveChannels::Find(std::uint32_t id) {
  return id >= 1 && id <= channels_.size() ? &channels_[id - 1] : nullptr;
}

char* LiveChannels::AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) {
  Flush();
  LiveChannel& to = channels_.at(channel - 1u);
  if (to.messages++ == 1) std::exchange(to.only, {});
  if (to.subscribers == 0 && to.messages > 1) return nullptr;
  pending_ = channel;
  pending_ns_ = time_ns;
  message_.resize(size);
  return message_.data();
}

void LiveChannels::Flush() {
  if (pending_ == 0) return;
  LiveChannel& to = channels_[std::exchange(pending_, std::uint16_t{0}) - 1u];
  if (to.messages == 1) {
    to.only = message_;
    to.time_ns = pending_ns_;
  }
  deliver_(to, pending_ns_, message_);
}

void LiveChannels::Tell(std::uint16_t channel, std::int64_t time_ns, std::string_view content) {
  if (char* at = AddMessage(channel, time_ns, content.size())) std::ranges::copy(content, at);
  Flush();
}

}  // namespace pliant::internal
