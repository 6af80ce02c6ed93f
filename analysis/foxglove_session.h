#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

#include "pliant/analysis/live_channels.h"
#include "pliant/analysis/live_commands.h"

namespace pliant::internal {

/// A client of the Foxglove WebSocket protocol, without its socket: what it says, and what it is
/// told. Whatever it says, nothing is thrown; what cannot be done it is told by a status message.
///
/// Source: github.com/foxglove/ws-protocol, docs/spec.md, version 1.
class FoxgloveSession {
 public:
  using Json = nlohmann::json;

  struct Frame {
    bool text;
    std::string content;
    bool may_be_lost;  ///< where the client is too slow for it
  };
  struct Options {
    std::string name;     ///< of the server
    std::string session;  ///< tells one run from the next
    LiveChannels* channels;
    LiveCommands* commands;
    std::function<void(Frame)> send;
    std::function<bool()> has_room;  ///< for what may be lost; else nothing is made of it
    /// The client has set these parameters, or subscribes to the channel.
    std::function<void(const std::set<std::size_t>&)> parameters_changed;
    std::function<void(FoxgloveSession&, const LiveChannel&)> subscribed;
  };

  static constexpr std::string_view kProtocols[] = {"foxglove.websocket.v1", "foxglove.sdk.v1"};

  /// Sends what a client is told first.
  explicit FoxgloveSession(Options o);
  ~FoxgloveSession();
  FoxgloveSession(const FoxgloveSession&) = delete;
  FoxgloveSession& operator=(const FoxgloveSession&) = delete;

  void HearText(std::string_view text);
  void HearBinary(std::string_view bytes);

  void Advertise(const LiveChannel& channel);
  /// To a client that subscribes to the channel.
  void Deliver(const LiveChannel& channel, std::int64_t time_ns, std::string_view content);
  /// To a client that subscribes to them.
  void ParametersChanged(const std::set<std::size_t>& which);

 private:
  struct ClientChannel {
    std::string topic, encoding;
  };
  enum class Level { Info, Warning, Error };

  void Tell(const Json& message, bool may_be_lost = false);
  void Status(Level level, const std::string& text);
  template <class Act>
  void Try(const Act& act);

  void Obey(const Json& message);
  void Subscribe(const Json& message);
  void Unsubscribe(const Json& message);
  void AdvertiseByClient(const Json& message);
  void UnadvertiseByClient(const Json& message);
  void GetParameters(const Json& message);
  void SetParameters(const Json& message);
  void SubscribeParameters(const Json& message, bool subscribe);
  void TellParameters(const std::set<std::size_t>& which, const Json* id = nullptr);
  std::set<std::size_t> ParametersNamed(const Json& message) const;

  const Options options_;
  std::map<std::uint32_t, std::uint32_t> channel_of_;       // a subscription
  std::map<std::uint32_t, std::uint32_t> subscription_of_;  // a channel
  std::map<std::uint32_t, ClientChannel> client_channels_;
  std::set<std::size_t> watched_;  // parameters
};

}  // namespace pliant::internal
