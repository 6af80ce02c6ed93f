#include "pliant/analysis/live_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/web_client.h"

namespace pliant::internal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A server of one channel, to which a message is told with every pump.
struct Served {
  Served() {
    channel = channels.AddChannel(channels.AddSchema("text", "none", ""), "/text", "text", {});
    server.Begin({.channels = &channels,
                  .commands = &commands,
                  .page = [] { return "<!DOCTYPE html>the page"; },
                  .pump =
                      [this] {
                        channels.Tell(channel, 1, std::string(message_bytes, 'm'));
                        ++pumps;
                        connected = server.clients();
                      },
                  .first = [](const LiveChannel&) { return std::string(); }});
  }
  ~Served() { server.End(); }

  std::uint16_t port() const { return server.port(); }
  /// Waits for a condition, 10 s at most.
  template <class Condition>
  static bool Comes(const Condition& condition) {
    for (int k = 0; k < 10'000; ++k) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  std::atomic<std::size_t> message_bytes = 10;
  std::atomic<long> pumps{0};
  std::atomic<int> connected{0};
  LiveChannels channels{[](const LiveChannel&) {},
                        [this](const LiveChannel& to, std::int64_t t, std::string_view content) {
                          server.Deliver(to, t, content);
                        }};
  std::uint16_t channel = 0;
  LiveCommands commands{{.tunables = {}, .stop = [] {}}};
  LiveServer server{{.port = 0, .name = "test", .patience = std::chrono::milliseconds(500)}};
};

TEST(LiveServer, ServesItsPage) {
  const Served served;
  WebClient client(served.port());
  client.Send("GET / HTTP/1.1\r\nConnection: close\r\n" + client.Host() + "\r\n");
  const std::string answer = client.ReadAll();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("\r\n\r\n<!DOCTYPE html>the page"));
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_EQ(served.server.url(), "http://127.0.0.1:" + std::to_string(served.port()) + "/");
}

TEST(LiveServer, RefusesWhatItDoesNotServe) {
  const Served served;
  const auto status = [&](const std::string& path, const std::string& headers) {
    WebClient client(served.port());
    return client.Get(path, headers);
  };
  const std::string host = "Host: localhost:" + std::to_string(served.port()) + "\r\n";
  EXPECT_EQ(status("/", host), "HTTP/1.1 200 OK");
  EXPECT_EQ(status("/", "Host: [::1]:80\r\n"), "HTTP/1.1 200 OK");
  EXPECT_EQ(status("/etc/passwd", host), "HTTP/1.1 404 Not Found");
  EXPECT_EQ(status("/../../etc/passwd", host), "HTTP/1.1 404 Not Found");
  // A name of somebody else's that leads here, as by rebinding.
  EXPECT_EQ(status("/", "Host: example.org\r\n"), "HTTP/1.1 403 Forbidden");
  EXPECT_EQ(status("/", ""), "HTTP/1.1 403 Forbidden");
  EXPECT_EQ(status("/", host + "Origin: http://example.org\r\n"), "HTTP/1.1 403 Forbidden");
  WebClient poster(served.port());
  poster.Send("POST / HTTP/1.1\r\nConnection: close\r\nContent-Length: 0\r\n" + host + "\r\n");
  EXPECT_THAT(poster.ReadAll(), StartsWith("HTTP/1.1 405 Method Not Allowed"));
}

TEST(LiveServer, OpensAWebSocketToItsOwnPageAndToFoxglovesOnly) {
  const Served served;
  const auto status = [&](const std::string& origin, const std::string& protocol) {
    WebClient client(served.port());
    return client.Upgrade(client.Host() + (origin.empty() ? "" : "Origin: " + origin + "\r\n"),
                          protocol);
  };
  const std::string open = "HTTP/1.1 101 Switching Protocols";
  const std::string own = "http://127.0.0.1:" + std::to_string(served.port());
  EXPECT_EQ(status("", "foxglove.websocket.v1"), open);
  EXPECT_EQ(status(own, "foxglove.websocket.v1"), open);
  EXPECT_EQ(status("https://app.foxglove.dev", "foxglove.sdk.v1"), open);
  for (const char* origin : {"http://127.0.0.1:1", "http://localhost", "https://example.org",
                             "null", "http://127.0.0.1.example.org"})
    EXPECT_EQ(status(origin, "foxglove.websocket.v1"), "HTTP/1.1 403 Forbidden") << origin;
  for (const char* protocol : {"", "chat", "xfoxglove.websocket.v1", "foxglove.websocket.v12"})
    EXPECT_EQ(status("", protocol), "HTTP/1.1 403 Forbidden") << protocol;
}

TEST(LiveServer, AnswersWithTheProtocolThatWasOffered) {
  const Served served;
  for (const char* protocol : {"foxglove.sdk.v1", "chat, foxglove.websocket.v1"}) {
    WebClient client(served.port());
    client.Upgrade(client.Host(), protocol);
    const std::string chosen = std::string(protocol).substr(std::string(protocol).find("foxglove"));
    EXPECT_THAT(client.head(), HasSubstr("Sec-WebSocket-Protocol: " + chosen + "\r\n"));
  }
}

TEST(LiveServer, DeliversMessagesToWhoSubscribes) {
  const Served served;
  WebClient client(served.port());
  client.Upgrade(client.Host());
  EXPECT_THAT(client.ReadFrame(), HasSubstr("\"serverInfo\""));
  EXPECT_THAT(client.ReadFrame(), HasSubstr("\"/text\""));
  client.SendFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})");
  int opcode = 0;
  EXPECT_EQ(client.ReadFrame(&opcode),
            std::string("\1\5\0\0\0\1\0\0\0\0\0\0\0", 13) + std::string(10, 'm'));
  EXPECT_EQ(opcode, 2);
}

TEST(LiveServer, GoesOnServingWhateverClientsDo) {
  Served served;
  served.message_bytes = 1 << 20;  // 20 ms apart: what is not read soon fills all buffers
  std::vector<std::unique_ptr<WebClient>> bad;
  const auto add = [&]() -> WebClient& {
    return *bad.emplace_back(std::make_unique<WebClient>(served.port()));
  };
  const auto subscriber = [&]() -> WebClient& {
    WebClient& client = add();
    client.Upgrade(client.Host());
    client.SendFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})");
    return client;
  };
  for (int k = 0; k < 4; ++k) {
    subscriber();                                                    // reads nothing
    add().Send("GET / HT");                                          // never ends its request
    add().Send(std::string("\x16\x03\x01\x02\0\1", 6));              // TLS
    add().Send("GET / HTTP/1.1\r\nX: " + std::string(20'000, 'x'));  // too long a head
    subscriber().Send(std::string("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff", 10));  // no frame
    try {
      subscriber().SendFrame(std::string(100'000, '['));  // too long a message
    } catch (const std::runtime_error&) {                 // that is closed while it is sent
    }
  }
  const long before = served.pumps;
  EXPECT_TRUE(Served::Comes([&] { return served.pumps > before + 50; }));
  EXPECT_TRUE(Served::Comes([&] { return served.connected == 0; }));  // it has lost patience

  served.message_bytes = 10;
  WebClient good(served.port());
  good.Upgrade(good.Host());
  good.SendFrame(R"({"op":"subscribe","subscriptions":[{"id":5,"channelId":1}]})");
  good.ReadFrame();
  good.ReadFrame();
  EXPECT_THAT(good.ReadFrame(), testing::EndsWith("mmmmmmmmmm"));
}

TEST(LiveServer, TakesThirtyTwoConnectionsAndNoMore) {
  const Served served;
  std::vector<std::unique_ptr<WebClient>> clients;
  for (int k = 0; k < 32; ++k) {
    clients.push_back(std::make_unique<WebClient>(served.port()));
    clients.back()->Upgrade(clients.back()->Host());
  }
  WebClient one_more(served.port());
  EXPECT_EQ(one_more.ReadAll(), "");
  clients.pop_back();
  EXPECT_TRUE(Served::Comes([&] {
    WebClient next(served.port());
    try {
      return next.Upgrade(next.Host()) == "HTTP/1.1 101 Switching Protocols";
    } catch (const std::runtime_error&) {
      return false;
    }
  }));
}

TEST(LiveServer, SaysFarewell) {
  auto served = std::make_unique<Served>();
  WebClient client(served->port());
  client.Upgrade(client.Host());
  client.ReadFrame();
  client.ReadFrame();
  std::jthread end([&] { served.reset(); });
  int opcode = 0;
  EXPECT_EQ(client.ReadFrame(&opcode), std::string("\x03\xe9") + "the run has ended");
  EXPECT_EQ(opcode, 8);
  client.SendFrame("\x03\xe9", 8);
}

TEST(LiveServer, SaysWhyItCannotServe) {
  const LiveServer taken({.port = 0});
  EXPECT_EQ(ErrorOf([&] { LiveServer({.port = taken.port()}); }),
            "cannot serve the page at 127.0.0.1:" + std::to_string(taken.port()) +
                ": Address already in use\ngive another --port, or 0 for any that is free");
  EXPECT_EQ(ErrorOf([] { LiveServer({.address = "here", .port = 0}); }),
            "the address of the page must be one of this machine, such as 127.0.0.1, got 'here'");
  EXPECT_THAT(ErrorOf([] { LiveServer({.address = "192.0.2.1", .port = 0}); }),
              StartsWith("cannot serve the page at 192.0.2.1:0: Cannot assign requested address"));
}

}  // namespace
}  // namespace pliant::internal
