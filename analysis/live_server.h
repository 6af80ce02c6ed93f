#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/live_channels.h"
#include "pliant/analysis/live_commands.h"

namespace pliant::internal {

/// Serves a page over HTTP, and over WebSockets of the same port the Foxglove protocol, by a thread
/// of its own.
///
/// Who asks must name the host as the server's address or as the loopback, and a page that asks
/// must come from here or from an origin that is allowed: else other pages in a browser could
/// reach a run that is open to this machine alone. Connections are limited in number, requests in
/// size and time, and what waits for a slow client in bytes; beyond, messages are lost to it, and
/// at last the client.
class LiveServer {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    std::uint16_t port = 8765;  ///< 0: any that is free
    std::string name = {};      ///< that clients are told
    std::string session = {};   ///< likewise: another one for each run
    std::vector<std::string> origins = {"https://app.foxglove.dev"};
    std::chrono::milliseconds patience{10'000};  ///< with a client that takes nothing
  };
  /// What is served. All calls are made by the server's thread.
  struct Served {
    LiveChannels* channels = nullptr;
    LiveCommands* commands = nullptr;
    std::function<std::string()> page;
    std::function<void()> pump;  ///< some fifty times a second
    /// What a client that has subscribed to the channel is told at once: empty, or a message of it.
    std::function<std::string(const LiveChannel&)> first;
  };

  /// Listens. Throws Error if it cannot.
  explicit LiveServer(Options o);
  ~LiveServer();  ///< ends

  std::uint16_t port() const;
  std::string url() const;

  void Begin(Served served);
  /// Calls `act` by the server's thread and waits for it, then sends what is left to clients, for a
  /// second at most, and closes all.
  void End(const std::function<void()>& act = {});

  // What follows is for the server's thread.

  void Advertise(const LiveChannel& channel);
  void Deliver(const LiveChannel& channel, std::int64_t time_ns, std::string_view content);
  int clients() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pliant::internal
