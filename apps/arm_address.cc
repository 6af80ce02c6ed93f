#include "pliant/apps/arm_address.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <memory>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr int kTimeoutMs = 2000;

struct Socket {
  ~Socket() {
    if (descriptor >= 0) close(descriptor);
  }
  int descriptor;
};

/// 0, or the errno of what went wrong.
int Connect(const addrinfo& to) {
  const Socket s{socket(to.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  if (s.descriptor < 0) return errno;
  if (connect(s.descriptor, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  pollfd wait{.fd = s.descriptor, .events = POLLOUT, .revents = 0};
  const int ready = poll(&wait, 1, kTimeoutMs);
  if (ready == 0) return ETIMEDOUT;
  if (ready < 0) return errno;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(s.descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

ArmAddress ArmAddress::Of(const std::string& text) {
  const auto refuse = [&] {
    throw Error("--arm wants an address such as 192.168.1.10 or 192.168.1.10:10000, got '" + text +
                "'");
  };
  ArmAddress address;
  std::string port;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string::npos) refuse();
    address.host = text.substr(1, end - 1);
    if (end + 1 < text.size()) port = text.substr(end + 1);
  } else {
    const std::size_t colon = text.find(':');
    address.host = text.substr(0, colon);
    if (colon != std::string::npos) port = text.substr(colon);
  }
  if (address.host.empty() || address.host.find_first_of(" \t\n/") != std::string::npos) refuse();
  if (port.empty()) return address;
  const char* const end = port.data() + port.size();
  const auto [stop, error] = std::from_chars(port.data() + 1, end, address.port);
  if (port[0] != ':' || error != std::errc() || stop != end || address.port < 1 ||
      address.port > 65535)
    refuse();
  return address;
}

std::string ArmAddress::text() const {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

ArmFacts TryArm(const ArmAddress& address) {
  ArmFacts facts{.address = address.text(), .fault = {}, .answered_s = 0};
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string port = std::to_string(address.port);
  if (const int rc = getaddrinfo(address.host.c_str(), port.c_str(), &hints, &found); rc != 0) {
    facts.fault = gai_strerror(rc);
    return facts;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, &freeaddrinfo);
  for (const addrinfo* to = all.get(); to; to = to->ai_next) {
    const auto begin = std::chrono::steady_clock::now();
    const int error = Connect(*to);
    facts.fault = error ? std::strerror(error) : "";
    facts.answered_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!error) break;
  }
  return facts;
}

}  // namespace pliant
