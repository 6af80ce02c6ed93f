#include "pliant/plants/rdt_source.h"

#include <netdb.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include "pliant/systems/error.h"
#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

constexpr int kMostAtOnce = 1000;                         // a tick ends even if a sensor floods it
constexpr std::int32_t kBehind = 1000, kAhead = 1000000;  // numbers of a sensor that began anew

internal::Descriptor ConnectTo(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int rc = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
      rc != 0)
    throw Error("cannot find the force sensor '" + host + "': " + gai_strerror(rc) +
                "; expected its IPv4 address, such as 192.168.1.1, or a name the network knows");
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, &freeaddrinfo);
  internal::Descriptor s(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // Connected, the kernel drops what comes from any other address.
  if (s.get() >= 0 && connect(s.get(), all->ai_addr, all->ai_addrlen) == 0) return s;
  throw Error("cannot reach the force sensor '" + host + "': " + std::strerror(errno) +
              "; is this machine in the sensor's network? `ip route` tells");
}

}  // namespace

RdtSource::RdtSource(const Options& o) : scale_{o.scale}, patience_{seconds(o.ask_again)} {
  Require(!o.host.empty(), "host must be the address of a force sensor, such as 192.168.1.1");
  Require(o.port >= 1 && o.port <= 65535, "port must be from 1 to 65535", o.port);
  RequireInRange("", "scale.counts_per_newton", scale_.counts_per_newton, "1/N", kPositive);
  RequireInRange("", "scale.counts_per_newton_meter", scale_.counts_per_newton_meter, "1/(N·m)",
                 kPositive);
  Require(Duration{} < o.ask_again, "ask_again must be > 0", o.ask_again.text());
  socket_ = ConnectTo(o.host, o.port);
  Ask(RdtCommand::Start);
}

RdtSource::~RdtSource() { Ask(RdtCommand::Stop); }

void RdtSource::Ask(RdtCommand command) noexcept {
  heard_ = std::chrono::steady_clock::now();
  may_begin_ = true;
  const std::array<std::uint8_t, kRdtRequestBytes> bytes = Encode(RdtRequest{.command = command});
  // One that is lost is asked again; so is one that nobody listened to, which the next call tells.
  for (int i = 0; i < 2; ++i)
    if (send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0) return;
}

bool RdtSource::Read(WrenchReading& newest) noexcept {
  bool any = false, news = false;
  std::array<std::uint8_t, kRdtRecordBytes> bytes;
  for (int i = 0; i < kMostAtOnce; ++i) {
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), MSG_TRUNC);
    if (size < 0) {
      if (errno == ECONNREFUSED || errno == EINTR) continue;  // what was asked was not heard
      break;
    }
    any = true;
    const auto record = static_cast<std::size_t>(size) == bytes.size() ? DecodeRdtRecord(bytes)
                                                                       : std::optional<RdtRecord>{};
    if (record)
      news |= Take(*record, newest);
    else
      ++link_.corrupted;
  }
  const auto now = std::chrono::steady_clock::now();
  if (any)
    heard_ = now;
  else if (now - heard_ >= patience_)
    Ask(RdtCommand::Start);
  newest.link = link_;
  return news;
}

bool RdtSource::Take(const RdtRecord& record, WrenchReading& newest) noexcept {
  const auto ahead = static_cast<std::int32_t>(record.rdt_sequence - last_);
  const bool anew = begins_ || ahead <= -kBehind || ahead >= kAhead || (ahead < 0 && may_begin_);
  if (!anew) {
    if (ahead == 0) ++link_.duplicated;
    if (ahead < 0) ++link_.out_of_order;
    if (ahead <= 0) return false;
    link_.lost += static_cast<std::uint32_t>(ahead - 1);
  }
  begins_ = may_begin_ = false;
  last_ = record.rdt_sequence;
  newest.wrench = scale_.WrenchOf(record.counts);
  newest.sequence = record.ft_sequence;
  newest.device_status = record.status;
  newest.faulty = IsRdtFault(record.status);
  return true;
}

}  // namespace pliant
