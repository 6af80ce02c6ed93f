#include "pliant/diagrams/gen3_emulator.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

#include "pliant/diagrams/faulty_replies.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using kortex::Function;
using std::chrono::steady_clock;

constexpr double kSlowService = 0.5;         // [s]
constexpr double kPatienceWithReaders = 10;  // until a client that does not read is hung up on
constexpr std::size_t kMostAnswers = 64;     // waiting for a client before it is read again
constexpr std::size_t kMostBytes = 1 << 16;  // the same, of those the kernel did not take
constexpr std::size_t kBite = 2048;          // read from a client before others have a turn
constexpr int kDatagramsATurn = 32, kTicksATurn = 4;
constexpr double kTick = 1e-3;        // [s]
constexpr double kMostBehind = 0.05;  // time that is caught up with [s]

std::string SystemError() { return std::strerror(errno); }

sockaddr_in AddressOf(const std::string& text, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  Require(inet_pton(AF_INET, text.c_str(), &address.sin_addr) == 1,
          "the address to listen on must be one of IPv4, such as 127.0.0.1", text);
  return address;
}

std::uint64_t Key(const sockaddr_in& address) {
  return static_cast<std::uint64_t>(address.sin_addr.s_addr) << 16 | address.sin_port;
}

sockaddr_in AddressOf(std::uint64_t key) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = static_cast<in_addr_t>(key >> 16);
  address.sin_port = static_cast<in_port_t>(key);
  return address;
}

internal::Descriptor Bound(int type, const std::string& text, int port) {
  const char* const name = type == SOCK_STREAM ? "port" : "UDP port";
  Require(port >= 0 && port <= 65535, std::string(name) + " must be in 0 … 65535", port);
  const sockaddr_in address = AddressOf(text, port);
  internal::Descriptor fd(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int yes = 1;
  if (type == SOCK_STREAM) ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (fd.get() < 0 ||
      ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      (type == SOCK_STREAM && ::listen(fd.get(), 256) != 0))
    throw Error("cannot listen on " + text + ", " + name + " " + Text(port) + ": " + SystemError() +
                "; is another emulator running? 0 is any port that is free");
  return fd;
}

int PortOf(const internal::Descriptor& fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool IsCyclic(Function f) { return f == Function::Refresh || f == Function::RefreshCommand; }

bool ForServices(const std::string& kind) {
  return kind == "servoing_refused" || kind == "slow_services";
}

Gen3Body::Options WithFaults(Gen3Body::Options arm, const std::vector<FaultOrder>& faults) {
  Require(arm.faults.empty(), "faults are those of the emulator, not of its arm");
  arm.faults = faults;
  return arm;
}

}  // namespace

class Gen3Emulator::Loop {
 public:
  explicit Loop(const Options& o)
      : o_{o},
        arm_{WithFaults(o.arm, o.faults)},
        base_{arm_, {.user = o.user, .password = o.password, .lock_step = o.lock_step}},
        replies_{{.faults = o.faults,
                  .delay_s = o.lock_step ? 0 : static_cast<double>(o.reply_delay.count()) / 1e6,
                  .seed = o.seed}},
        listener_{Bound(SOCK_STREAM, o.bind, o.port)},
        datagrams_{Bound(SOCK_DGRAM, o.bind, o.udp_port)},
        wake_{::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)} {
    Require(o.most_connections > 0, "most_connections must be > 0", o.most_connections);
    Require(o.reply_delay.count() >= 0, "reply_delay must be >= 0 µs", o.reply_delay.count());
    Require(o.service_delay.count() >= 0, "service_delay must be >= 0 µs", o.service_delay.count());
    thread_ = std::thread([this] { Run(); });
  }

  ~Loop() {
    stop_ = true;
    const std::uint64_t one = 1;
    if (::write(wake_.get(), &one, sizeof one) < 0) stop_ = true;  // it looks there anyway
    thread_.join();
  }

  int port() const { return PortOf(listener_); }
  int udp_port() const { return PortOf(datagrams_); }
  Counts counts() const {
    const std::lock_guard lock(turn_);
    return counts_;
  }
  std::string failure() const {
    const std::lock_guard lock(turn_);
    return failure_;
  }

 private:
  struct Pending {
    double due_s;
    std::vector<std::byte> bytes;
  };
  struct Connection {
    internal::Descriptor fd;
    std::uint64_t number;
    double last_s;  // it was heard
    kortex::FrameStream stream = {};
    std::deque<Pending> answers = {};  // that are not due
    std::vector<std::byte> out = {};   // that are
    double stuck_s = 0;                // since when the kernel takes none of `out`
    bool over = false;
  };

  // Seconds of the wall clock since the start.
  double Now() const { return std::chrono::duration<double>(steady_clock::now() - start_).count(); }
  // The clock of sessions and replies, which in lock-step is the arm's.
  double Time() const { return o_.lock_step ? static_cast<double>(arm_.ticks()) / 1000 : Now(); }
  bool ShowsNow(const std::string& kind) const {
    std::optional<double> t = arm_.servoed();
    if (!t && ForServices(kind)) t = 0;
    return t && Shows(o_.faults, kind, *t);
  }

  void Run();
  void Turn();
  void Wait();
  void TickIfDue();
  void AfterTicks();
  void ReadDatagrams();
  void SendReplies();
  void Accept();
  void ReadFrom(Connection& c);
  void WriteTo(Connection& c);
  std::optional<Gen3Base::Answer> Serve(Gen3Base::Channel channel, std::uint64_t peer,
                                        const kortex::Frame& frame);
  std::uint32_t Jitter();

  const Options o_;
  Gen3Body arm_;
  Gen3Base base_;
  FaultyReplies replies_;
  internal::Descriptor listener_, datagrams_, wake_;
  std::list<Connection> connections_;
  std::uint64_t next_number_ = 0;

  const steady_clock::time_point start_ = steady_clock::now();
  std::int64_t due_ticks_ = 0;  // of the arm, lost ones included
  double last_command_s_ = -1;
  bool expired_ = false;
  std::vector<pollfd> polled_;
  std::vector<std::byte> buffer_ = std::vector<std::byte>(kortex::kLargestFrame + 1);
  std::vector<std::byte> frame_ = std::vector<std::byte>(kortex::kLargestFrame);

  // Who asks for them waits for the end of a turn: what was answered then is counted.
  mutable std::mutex turn_;
  Counts counts_;
  std::string failure_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

void Gen3Emulator::Loop::Run() {
  ::prctl(PR_SET_TIMERSLACK, 1);
  due_ticks_ = static_cast<std::int64_t>(Now() * 1000) + 1;
  try {
    while (!stop_) Turn();
  } catch (const std::exception& e) {
    const std::lock_guard lock(turn_);
    failure_ = e.what();
  }
  connections_.clear();
}

void Gen3Emulator::Loop::Turn() {
  Wait();
  const std::lock_guard lock(turn_);
  ReadDatagrams();
  TickIfDue();
  if (polled_[1].revents != 0) Accept();
  std::size_t i = 3;
  for (Connection& c : connections_) {
    if (i < polled_.size() && (polled_[i].revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
      ReadFrom(c);
      TickIfDue();
    }
    ++i;
    WriteTo(c);
  }
  if (ShowsNow("tcp_reset"))
    for (Connection& c : connections_) {
      const linger at_once{.l_onoff = 1, .l_linger = 0};
      ::setsockopt(c.fd.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
      c.over = true;
    }
  connections_.remove_if([](const Connection& c) { return c.over; });
  SendReplies();
  base_.Expire(Time());
  counts_.sessions = base_.opened();
  counts_.refused = base_.refused();
  counts_.ticks = arm_.ticks();
}

void Gen3Emulator::Loop::Wait() {
  polled_.clear();
  const double now = Now();
  double until = now + 0.1;
  if (!o_.lock_step) {
    until = std::min(until, static_cast<double>(due_ticks_) / 1000);
    if (const auto due = replies_.due_s()) until = std::min(until, *due);
  }
  polled_.push_back({wake_.get(), POLLIN, 0});
  polled_.push_back({listener_.get(), POLLIN, 0});
  polled_.push_back({datagrams_.get(), POLLIN, 0});
  for (const Connection& c : connections_) {
    const bool reads = c.answers.size() < kMostAnswers && c.out.size() < kMostBytes;
    const int events = (reads ? POLLIN : 0) | (c.out.empty() ? 0 : POLLOUT);
    polled_.push_back({c.fd.get(), static_cast<short>(events), 0});
    if (!c.answers.empty()) until = std::min(until, c.answers.front().due_s);
  }
  const double wait = std::max(until - now, 0.0);
  const timespec patience{static_cast<time_t>(wait),
                          static_cast<long>(1e9 * (wait - std::floor(wait)))};
  if (::ppoll(polled_.data(), polled_.size(), &patience, nullptr) < 0)
    for (pollfd& p : polled_) p.revents = 0;
}

void Gen3Emulator::Loop::TickIfDue() {
  if (!o_.lock_step) {
    for (int n = 0; n < kTicksATurn; ++n) {
      const double late = Now() - static_cast<double>(due_ticks_) / 1000;
      if (late < 0) break;
      counts_.worst_late_ms = std::max(counts_.worst_late_ms, 1000 * late);
      if (late > kMostBehind) {
        const auto lost = static_cast<std::int64_t>(1000 * late);
        counts_.lost_ticks += lost;
        due_ticks_ += lost;
      }
      arm_.Step(late > kTick);
      ++due_ticks_;
    }
  }
  AfterTicks();
}

void Gen3Emulator::Loop::AfterTicks() {
  base_.refuses_servoing = ShowsNow("servoing_refused");
  const bool expired = ShowsNow("session_expired");
  if (expired && !expired_) base_.EndAllSessions();
  expired_ = expired;
}

std::uint32_t Gen3Emulator::Loop::Jitter() {
  if (o_.lock_step) return 0;
  const double now = Now();
  const double last = std::exchange(last_command_s_, now);
  if (last < 0) return 0;
  return static_cast<std::uint32_t>(std::min(1e6 * std::abs(now - last - 1e-3), 1e9));
}

std::optional<Gen3Base::Answer> Gen3Emulator::Loop::Serve(Gen3Base::Channel channel,
                                                          std::uint64_t peer,
                                                          const kortex::Frame& frame) {
  const bool cyclic = IsCyclic(frame.header.function);
  auto answer = base_.Serve({.channel = channel,
                             .peer = peer,
                             .time_s = Time(),
                             .jitter_us = cyclic ? Jitter() : 0,
                             .header = frame.header,
                             .payload = frame.payload});
  if (answer && cyclic && answer->header.error == 0) ++counts_.commands;
  if (o_.lock_step && cyclic) AfterTicks();
  return answer;
}

void Gen3Emulator::Loop::ReadDatagrams() {
  for (int n = 0; n < kDatagramsATurn; ++n) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = ::recvfrom(datagrams_.get(), buffer_.data(), buffer_.size(), 0,
                                   reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0) return;
    const auto frame = kortex::ReadFrame(std::span(buffer_).first(static_cast<std::size_t>(got)));
    if (!frame) {
      ++counts_.unreadable;
      continue;
    }
    if (IsCyclic(frame->header.function) && ShowsNow("lost_requests")) {
      if (o_.lock_step) {
        arm_.Step();
        AfterTicks();
      }
      continue;
    }
    const auto answer = Serve(Gen3Base::Channel::Datagrams, Key(from), *frame);
    if (!answer || ShowsNow("silent")) continue;
    const std::size_t length = kortex::WriteFrame(answer->header, answer->payload, frame_);
    replies_.Send(Key(from), std::span(frame_).first(length), Time(), arm_.servoed());
    SendReplies();
  }
}

void Gen3Emulator::Loop::SendReplies() {
  while (const auto reply = replies_.Next(Time())) {
    const sockaddr_in to = AddressOf(reply->peer);
    ::sendto(datagrams_.get(), reply->bytes.data(), reply->bytes.size(), MSG_DONTWAIT,
             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
}

void Gen3Emulator::Loop::Accept() {
  for (int n = 0; n < 16; ++n) {
    internal::Descriptor fd(
        ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    const bool full = fd.get() < 0 ? errno == EMFILE || errno == ENFILE
                                   : connections_.size() >= o_.most_connections;
    if (full && !connections_.empty())
      std::ranges::min_element(connections_, {}, &Connection::last_s)->over = true;
    connections_.remove_if([](const Connection& c) { return c.over; });
    if (fd.get() < 0) return;
    const int yes = 1;
    ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    ++counts_.connections;
    connections_.push_back({.fd = std::move(fd), .number = ++next_number_, .last_s = Now()});
  }
}

void Gen3Emulator::Loop::ReadFrom(Connection& c) {
  if (c.answers.size() >= kMostAnswers || c.out.size() >= kMostBytes) return;
  const std::span<std::byte> room = c.stream.Room();
  const ssize_t got = ::recv(c.fd.get(), room.data(), std::min(room.size(), kBite), 0);
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) c.over = true;
  if (got <= 0) return;
  c.stream.Filled(static_cast<std::size_t>(got));
  c.last_s = Now();
  try {
    while (const auto bytes = c.stream.Next()) {
      const auto frame = kortex::ReadFrame(*bytes);
      if (!frame) {
        ++counts_.unreadable;
        continue;
      }
      const auto answer = Serve(Gen3Base::Channel::Stream, c.number, *frame);
      if (!answer || ShowsNow("silent")) continue;
      const double delay = ShowsNow("slow_services") ? kSlowService
                           : o_.lock_step            ? 0
                                          : static_cast<double>(o_.service_delay.count()) / 1e6;
      c.answers.push_back({c.last_s + delay, kortex::InStream(answer->header, answer->payload)});
    }
  } catch (const Error&) {  // out of step
    ++counts_.unreadable;
    c.over = true;
  }
}

void Gen3Emulator::Loop::WriteTo(Connection& c) {
  const double now = Now();
  while (!c.answers.empty() && c.answers.front().due_s <= now) {
    const auto& bytes = c.answers.front().bytes;
    if (c.out.empty()) c.stuck_s = now;
    c.out.insert(c.out.end(), bytes.begin(), bytes.end());
    c.answers.pop_front();
  }
  if (c.out.empty() || c.over) return;
  const ssize_t sent = ::send(c.fd.get(), c.out.data(), c.out.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent > 0) {
    c.out.erase(c.out.begin(), c.out.begin() + sent);
    c.stuck_s = now;
  } else if (errno != EAGAIN && errno != EINTR) {
    c.over = true;
  } else if (now - c.stuck_s > kPatienceWithReaders) {
    c.over = true;
  }
}

Gen3Emulator::Gen3Emulator(const Options& o) : loop_{std::make_unique<Loop>(o)} {}
Gen3Emulator::~Gen3Emulator() = default;
int Gen3Emulator::port() const { return loop_->port(); }
int Gen3Emulator::udp_port() const { return loop_->udp_port(); }
Gen3Emulator::Counts Gen3Emulator::counts() const { return loop_->counts(); }
std::string Gen3Emulator::failure() const { return loop_->failure(); }

std::vector<FaultOrder::Kind> Gen3Emulator::Kinds() {
  std::vector<FaultOrder::Kind> all = FaultyReplies::Kinds();
  for (const char* kind : {"lost_requests", "silent", "session_expired", "tcp_reset",
                           "servoing_refused", "slow_services"})
    all.push_back({kind});
  for (const FaultOrder::Kind& kind : Gen3Body::Kinds()) all.push_back(kind);
  return all;
}

}  // namespace pliant
