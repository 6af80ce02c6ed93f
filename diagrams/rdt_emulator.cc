#include "pliant/diagrams/rdt_emulator.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

internal::Descriptor Listen(const std::string& bind_to, int port) {
  Require(port >= 0 && port <= 65535, "port must be from 0 to 65535", port);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, bind_to.c_str(), &at.sin_addr) != 1)
    throw Error("cannot listen at '" + bind_to +
                "': expected an IPv4 address of this machine, such as 127.0.0.1, or 0.0.0.0 for "
                "all it has");
  internal::Descriptor s(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (s.get() >= 0 && bind(s.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0)
    return s;
  throw Error("cannot listen at " + bind_to + ":" + std::to_string(port) + ": " +
              std::strerror(errno) + "; port 0 is any that is free");
}

/// A record that is too short: a wrong bit on the way is noticed by UDP itself.
void CutShort(PacketFaults::Packet& packet, std::uint32_t number) {
  packet.resize(number % packet.size());
}

}  // namespace

struct RdtEmulator::Peer {
  sockaddr_in address{};
  std::uint32_t left = 0;  // records; without an end if it is endless
  bool endless = true;

  bool operator==(const sockaddr_in& other) const {
    return address.sin_addr.s_addr == other.sin_addr.s_addr && address.sin_port == other.sin_port;
  }
};

RdtEmulator::RdtEmulator(const Options& o)
    : options_{o}, faults_{o.faults, CutShort}, socket_{Listen(o.bind, o.port)} {}

RdtEmulator::~RdtEmulator() = default;

int RdtEmulator::port() const {
  sockaddr_in at{};
  socklen_t size = sizeof at;
  getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&at), &size);
  return ntohs(at.sin_port);
}

void RdtEmulator::Answer(bool hears, const Wrench& wrench) {
  std::array<std::uint8_t, kRdtRequestBytes> bytes;
  for (int i = 0; i < 1000; ++i) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = recvfrom(socket_.get(), bytes.data(), bytes.size(), MSG_TRUNC,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0 && errno != EINTR && errno != ECONNREFUSED) return;
    if (!hears || got != static_cast<ssize_t>(bytes.size())) continue;
    const auto request = DecodeRdtRequest(bytes);
    if (!request) continue;
    switch (request->command) {
      case RdtCommand::Start:
        peer_ = std::make_unique<Peer>(Peer{from, request->count, request->count == 0});
        record_.rdt_sequence = 0;
        break;
      case RdtCommand::Stop:
        if (peer_ && *peer_ == from) peer_.reset();
        break;
      case RdtCommand::Bias:
        bias_ = wrench;
        break;
    }
  }
}

void RdtEmulator::Tick(const Wrench& wrench) {
  const double t = 1e-9 * static_cast<double>(options_.period.Times(tick_++));
  const bool on = !Shows(options_.faults, "silent", t);
  Answer(on, wrench);
  if (!on) {
    peer_.reset();
    bias_ = {};
    record_ = {};
  } else if (!Shows(options_.faults, "frozen", t)) {
    ++record_.ft_sequence;
    record_.counts = options_.scale.CountsOf(wrench - bias_);
  }
  std::optional<PacketFaults::Packet> packet;
  if (peer_ && (peer_->endless || peer_->left > 0)) {
    if (!peer_->endless) --peer_->left;
    ++record_.rdt_sequence;
    const auto bytes = Encode(record_);
    packet.emplace(bytes.begin(), bytes.end());
  }
  const std::vector<PacketFaults::Packet> arrives = faults_.Pass(t, std::move(packet));
  if (!peer_) return;
  for (const PacketFaults::Packet& each : arrives)
    sent_ += sendto(socket_.get(), each.data(), each.size(), MSG_NOSIGNAL,
                    reinterpret_cast<const sockaddr*>(&peer_->address), sizeof peer_->address) >= 0;
}

}  // namespace pliant
