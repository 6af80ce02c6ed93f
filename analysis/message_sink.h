#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace pliant::internal {

/// Where messages go: a file, or those who look on while a run goes on.
class MessageSink {
 public:
  using Words = std::map<std::string, std::string>;

  virtual ~MessageSink() = default;

  /// Both return the number of what they add.
  virtual std::uint16_t AddSchema(std::string_view name, std::string_view encoding,
                                  std::string_view text) = 0;
  virtual std::uint16_t AddChannel(std::uint16_t schema, std::string_view topic,
                                   std::string_view encoding, const Words& metadata) = 0;
  /// Where the `size` bytes of a message go, until the next call; null if nobody wants it.
  virtual char* AddMessage(std::uint16_t channel, std::int64_t time_ns, std::size_t size) = 0;

 protected:
  MessageSink() = default;
  MessageSink(const MessageSink&) = default;
  MessageSink& operator=(const MessageSink&) = default;
};

}  // namespace pliant::internal
