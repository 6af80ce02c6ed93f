#include "pliant/analysis/live_server.h"

// Boost 1.74 uses std::exchange without it.
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <future>
#include <optional>
#include <thread>

#include "pliant/analysis/foxglove_session.h"
#include "pliant/analysis/without_signals.h"
#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using namespace std::chrono_literals;

constexpr auto kPumpPeriod = 20ms;
constexpr auto kRequestTime = 5s;
constexpr auto kIdleTime = 30s;  // without an answer to a ping
constexpr auto kWriteTime = 10s;
constexpr auto kFarewellTime = 1s;
constexpr auto kPageAge = 2s;
constexpr int kPageShare = 10;  // of the time, for what pages take to be made
constexpr std::size_t kMostConnections = 32;
constexpr std::size_t kMostHeader = 8 << 10;
constexpr std::size_t kMostMessage = 64 << 10;  // of a client
constexpr std::size_t kMostWaiting = 4 << 20;   // [bytes] for a client; beyond, messages are lost
constexpr std::size_t kTooMuch = 2 * kMostWaiting;  // of what may not be lost

using Request = http::request<http::empty_body>;

std::string ToString(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// The end here, as a browser names it.
std::string AddressOf(const tcp::socket& socket) {
  boost::system::error_code ignored;
  const asio::ip::address address = socket.local_endpoint(ignored).address();
  return address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
}

/// "localhost" of "localhost:8765", "[::1]" of "[::1]:8765".
std::string HostName(const std::string& host) {
  const std::size_t bracket = host.rfind(']');
  const std::size_t colon = host.rfind(':');
  return colon == host.npos || (bracket != host.npos && colon < bracket) ? host
                                                                         : host.substr(0, colon);
}

}  // namespace

struct LiveServer::State {
  /// A WebSocket and what waits to be sent through it.
  class Client : public std::enable_shared_from_this<Client> {
   public:
    Client(State& state, websocket::stream<beast::tcp_stream> socket)
        : state_{state}, socket_{std::move(socket)}, news_{state.io} {}

    asio::awaitable<void> Run() {
      const auto self = shared_from_this();
      session_.emplace(FoxgloveSession::Options{
          .name = state_.options.name,
          .session = state_.options.session,
          .channels = state_.served.channels,
          .commands = state_.served.commands,
          .send = [this](FoxgloveSession::Frame frame) { Send(std::move(frame)); },
          .has_room = [this] { return waiting_ <= kMostWaiting; },
          .parameters_changed =
              [this](const std::set<std::size_t>& which) {
                for (Client* client : state_.clients) client->session_->ParametersChanged(which);
              },
          .subscribed =
              [this](FoxgloveSession& session, const LiveChannel& channel) {
                if (const std::string first = state_.served.first(channel); !first.empty())
                  session.Deliver(channel, channel.time_ns, first);
              }});
      state_.clients.insert(this);
      asio::co_spawn(state_.io, Write(self), asio::detached);
      try {
        for (;;) {
          beast::flat_buffer in(kMostMessage);
          co_await socket_.async_read(in, asio::use_awaitable);
          const std::string_view message(static_cast<const char*>(in.data().data()), in.size());
          if (socket_.got_text())
            session_->HearText(message);
          else
            session_->HearBinary(message);
        }
      } catch (const std::exception&) {
        // Gone, or it did not keep to the protocol.
      }
      state_.clients.erase(this);
      session_.reset();
      closed_ = true;
      news_.cancel();
      beast::get_lowest_layer(socket_).cancel();
    }

    FoxgloveSession& session() { return *session_; }
    std::size_t waiting() const { return waiting_; }

    void Drop() {
      closed_ = true;
      news_.cancel();
      beast::get_lowest_layer(socket_).close();
    }
    void SayFarewell() {
      leaving_ = true;
      news_.cancel();
    }
    /// A client that takes nothing.
    void DropIfStuck(std::chrono::steady_clock::time_point now) {
      if (writing_ && now > write_begun_ + state_.options.patience) Drop();
    }

   private:
    void Send(FoxgloveSession::Frame frame) {
      if (closed_) return;
      if (waiting_ > kMostWaiting && frame.may_be_lost) return;
      if (waiting_ > kTooMuch) return Drop();
      waiting_ += frame.content.size();
      queue_.push_back(std::move(frame));
      news_.cancel();
    }

    asio::awaitable<void> Write([[maybe_unused]] std::shared_ptr<Client> self) {
      try {
        while (!closed_) {
          if (queue_.empty()) {
            if (leaving_) {
              co_await socket_.async_close({websocket::close_code::going_away, "the run has ended"},
                                           asio::use_awaitable);
              co_return;
            }
            boost::system::error_code woken;
            news_.expires_at(std::chrono::steady_clock::time_point::max());
            co_await news_.async_wait(asio::redirect_error(asio::use_awaitable, woken));
            continue;
          }
          const FoxgloveSession::Frame frame = std::move(queue_.front());
          queue_.pop_front();
          socket_.text(frame.text);
          write_begun_ = std::chrono::steady_clock::now();
          writing_ = true;
          co_await socket_.async_write(asio::buffer(frame.content), asio::use_awaitable);
          writing_ = false;
          waiting_ -= frame.content.size();
        }
      } catch (const std::exception&) {
        // The one that reads finds out too.
      }
      closed_ = true;
      beast::get_lowest_layer(socket_).cancel();
    }

    State& state_;
    websocket::stream<beast::tcp_stream> socket_;
    std::optional<FoxgloveSession> session_;
    asio::steady_timer news_;  // cancelled when there is something to send
    std::deque<FoxgloveSession::Frame> queue_;
    std::size_t waiting_ = 0;  // [bytes]
    bool closed_ = false, leaving_ = false, writing_ = false;
    std::chrono::steady_clock::time_point write_begun_;
  };

  explicit State(Options o) : options{std::move(o)} {
    boost::system::error_code error;
    const auto address = asio::ip::make_address(options.address, error);
    if (error)
      throw Error("the address of the page must be one of this machine, such as 127.0.0.1, got '" +
                  options.address + "'");
    const tcp::endpoint endpoint(address, options.port);
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw Error("cannot serve the page at " + options.address + ":" +
                  std::to_string(options.port) + ": " + error.message() +
                  "\ngive another --port, or 0 for any that is free");
    options.port = acceptor.local_endpoint().port();
  }

  asio::awaitable<void> Accept() {
    for (;;) {
      boost::system::error_code error;
      tcp::socket socket =
          co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
      if (error == asio::error::operation_aborted) co_return;
      if (error) {  // such as too many open files
        asio::steady_timer later(io, 100ms);
        co_await later.async_wait(asio::use_awaitable);
        continue;
      }
      if (connections >= kMostConnections) continue;  // closes it
      asio::co_spawn(io, Serve(std::move(socket)), asio::detached);
    }
  }

  asio::awaitable<void> Serve(tcp::socket socket) {
    const Counted counted(connections);
    try {
      beast::tcp_stream stream(std::move(socket));
      stream.socket().set_option(tcp::no_delay(true));
      beast::flat_buffer buffer(kMostHeader);
      for (;;) {
        http::request_parser<http::empty_body> parser;
        parser.header_limit(kMostHeader);
        stream.expires_after(kRequestTime);
        co_await http::async_read(stream, buffer, parser, asio::use_awaitable);
        const Request& request = parser.get();
        const std::string here = AddressOf(stream.socket());
        if (websocket::is_upgrade(request) && Refusal(request, here).empty()) {
          co_await ServeSocket(std::move(stream), request);
          co_return;
        }
        auto response = Answer(request, here);
        stream.expires_after(kWriteTime);
        co_await http::async_write(stream, response, asio::use_awaitable);
        if (!response.keep_alive()) break;
      }
      boost::system::error_code ignored;
      stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    } catch (const std::exception&) {
      // Gone, too slow, or no HTTP.
    }
  }

  asio::awaitable<void> ServeSocket(beast::tcp_stream stream, const Request& request) {
    stream.expires_never();
    websocket::stream<beast::tcp_stream> socket(std::move(stream));
    socket.set_option(websocket::stream_base::timeout{kRequestTime, kIdleTime, true});
    socket.set_option(websocket::stream_base::decorator(
        [protocol = ProtocolOf(request)](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
    socket.read_message_max(kMostMessage);
    socket.auto_fragment(false);
    co_await socket.async_accept(request, asio::use_awaitable);
    co_await std::make_shared<Client>(*this, std::move(socket))->Run();
  }

  /// The first that is offered and known; empty: none.
  static std::string ProtocolOf(const Request& request) {
    std::string offered = ToString(request[http::field::sec_websocket_protocol]);
    offered.erase(std::remove(offered.begin(), offered.end(), ' '), offered.end());
    offered = "," + offered + ",";
    for (const std::string_view known : FoxgloveSession::kProtocols)
      if (offered.find("," + std::string(known) + ",") != offered.npos) return std::string(known);
    return "";
  }

  /// Why a request is not served; empty: it is.
  std::string Refusal(const Request& request, const std::string& here) const {
    const std::string host = ToString(request[http::field::host]);
    const std::string name = HostName(host);
    const std::array<std::string, 4> known{"127.0.0.1", "localhost", "[::1]", here};
    if (std::ranges::find(known, name) == known.end())
      return "the host must be localhost or " + here;
    // Browsers say so of what pages from elsewhere ask for, but of a link that is followed.
    const std::string site = ToString(request["Sec-Fetch-Site"]);
    const bool is_link = request["Sec-Fetch-Dest"] == "document";
    if ((site == "cross-site" || site == "same-site") && !is_link)
      return "pages from elsewhere may not ask";
    if (const auto origin = request.find(http::field::origin); origin != request.end()) {
      const std::string from = ToString(origin->value());
      if (from != "http://" + host &&
          std::ranges::find(options.origins, from) == options.origins.end())
        return "pages from elsewhere may not ask";
    }
    if (websocket::is_upgrade(request) && ProtocolOf(request).empty())
      return "the protocol must be foxglove.websocket.v1 or foxglove.sdk.v1";
    return "";
  }

  http::response<http::string_body> Answer(const Request& request, const std::string& here) {
    http::response<http::string_body> response(http::status::ok, request.version());
    response.keep_alive(request.keep_alive());
    response.set(http::field::cache_control, "no-store");
    response.set(http::field::x_frame_options, "DENY");
    response.set("X-Content-Type-Options", "nosniff");
    const auto say = [&](http::status status, std::string text) {
      response.result(status);
      response.set(http::field::content_type, "text/plain; charset=utf-8");
      response.body() = std::move(text) + "\n";
    };
    const std::string refusal = Refusal(request, here);
    if (!refusal.empty()) response.keep_alive(false);
    const bool head = request.method() == http::verb::head;
    std::string shown;
    try {
      if (refusal.empty() && ToString(request.target()) == "/") shown = Page();
    } catch (const std::exception& e) {
      say(http::status::internal_server_error, e.what());
      response.prepare_payload();
      return response;
    }
    if (!refusal.empty()) {
      say(http::status::forbidden, refusal);
    } else if (request.method() != http::verb::get && !head) {
      say(http::status::method_not_allowed, "only GET is served here");
      response.set(http::field::allow, "GET, HEAD");
    } else if (ToString(request.target()) != "/") {
      say(http::status::not_found, "there is only / here");
    } else {
      response.set(http::field::content_type, "text/html; charset=utf-8");
      response.set("Content-Security-Policy",
                   "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                   "img-src data: blob:; connect-src 'self' data: ws://" +
                       ToString(request[http::field::host]) +
                       "; base-uri 'none'; form-action 'none'");
      response.body() = std::move(shown);
    }
    if (head) response.body().clear();
    response.prepare_payload();
    return response;
  }

  /// Made anew at most once in two seconds, and a tenth of the time, whoever asks how often.
  const std::string& Page() {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    if (page.empty() || begin > page_until) {
      page = served.page();
      const Clock::time_point end = Clock::now();
      page_until = end + std::max<Clock::duration>(kPageAge, kPageShare * (end - begin));
    }
    return page;
  }

  asio::awaitable<void> Pump() {
    asio::steady_timer timer(io);
    for (;;) {
      try {
        served.pump();
      } catch (const std::exception&) {
        // Such as no memory: what was to be shown is lost, and the next call shows what is new.
      }
      const auto now = std::chrono::steady_clock::now();
      const std::set<Client*> all = clients;
      for (Client* client : all) client->DropIfStuck(now);
      timer.expires_after(kPumpPeriod);
      co_await timer.async_wait(asio::use_awaitable);
    }
  }

  struct Counted {
    explicit Counted(std::size_t& n) : n{n} { ++n; }
    ~Counted() { --n; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    std::size_t& n;
  };

  Options options;
  Served served;
  std::size_t connections = 0;
  std::set<Client*> clients;
  std::string page;
  std::chrono::steady_clock::time_point page_until;

  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  std::jthread thread;
};

LiveServer::LiveServer(Options o) : state_{std::make_unique<State>(std::move(o))} {}

LiveServer::~LiveServer() { state_->io.stop(); }

std::uint16_t LiveServer::port() const { return state_->options.port; }

std::string LiveServer::url() const {
  const std::string& address = state_->options.address;
  return "http://" + (address.find(':') == address.npos ? address : "[" + address + "]") + ":" +
         std::to_string(port()) + "/";
}

void LiveServer::Begin(Served served) {
  State& state = *state_;
  state.served = std::move(served);
  asio::co_spawn(state.io, state.Accept(), asio::detached);
  asio::co_spawn(state.io, state.Pump(), asio::detached);
  const WithoutSignals in_thread;
  state.thread = std::jthread([&state] { state.io.run(); });
}

void LiveServer::End(const std::function<void()>& act) {
  State& state = *state_;
  if (!state.thread.joinable()) return;
  std::promise<void> done;
  asio::post(state.io, [&] {
    try {
      if (act) act();
    } catch (const std::exception&) {
      // What was to be said last is lost.
    }
    state.acceptor.close();
    for (State::Client* client : state.clients) client->SayFarewell();
    done.set_value();
  });
  done.get_future().wait();
  const auto end = std::chrono::steady_clock::now() + kFarewellTime;
  for (bool left = true; left && std::chrono::steady_clock::now() < end;) {
    std::promise<bool> some;
    asio::post(state.io, [&] { some.set_value(!state.clients.empty()); });
    left = some.get_future().get();
    if (left) std::this_thread::sleep_for(5ms);
  }
  state.io.stop();
  state.thread.join();
}

void LiveServer::Advertise(const LiveChannel& channel) {
  for (State::Client* client : state_->clients) client->session().Advertise(channel);
}

void LiveServer::Deliver(const LiveChannel& channel, std::int64_t time_ns,
                         std::string_view content) {
  if (channel.subscribers == 0) return;
  for (State::Client* client : state_->clients)
    client->session().Deliver(channel, time_ns, content);
}

int LiveServer::clients() const { return static_cast<int>(state_->clients.size()); }

}  // namespace pliant::internal
