#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/message_sink.h"

namespace pliant::internal {

/// A stream of messages that clients may subscribe to.
struct LiveChannel {
  std::uint32_t id;
  std::string topic, encoding;
  std::string schema_name, schema_encoding, schema;
  MessageSink::Words metadata = {};

  int subscribers = 0;
  std::int64_t time_ns = 0;  ///< of its only message
  std::string only = {};     ///< which those who come later are told too
  std::uint64_t messages = 0;
};

/// The channels of a run that goes on, and the way of their messages to who subscribes. A channel
/// that nobody subscribes to costs no message, but for its first.
class LiveChannels final : public MessageSink {
 public:
  using Begun = std::function<void(const LiveChannel&)>;
  using Deliver =
      std::function<void(const LiveChannel&, std::int64_t time_ns, std::string_view content)>;

  LiveChannels(Begun begun, Deliver deliver)
      : begun_{std::move(begun)}, deliver_{std::move(deliver)} {}

  std::uint16_t AddSchema(std::string_view name, std::string_view encoding,
                          std::string_view text) override;
  std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic, std::string_view encoding,
                           const Words& metadata) override;
  char* AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) override;
  /// Delivers the message that was added last.
  void Flush();
  /// Adds a message and delivers it.
  void Tell(std::uint16_t channel, std::int64_t time_ns, std::string_view content);

  const std::vector<LiveChannel>& all() const { return channels_; }
  /// Null if there is none.
  LiveChannel* Find(std::uint32_t id);

 private:
  struct Schema {
    std::string name, encoding, text;
  };

  const Begun begun_;
  const Deliver deliver_;
  std::vector<Schema> schemas_;
  std::vector<LiveChannel> channels_;  // numbered from 1
  std::string message_;
  std::uint16_t pending_ = 0;  // channel of `message_`; 0: none
  std::int64_t pending_ns_ = 0;
};

}  // namespace pliant::internal
