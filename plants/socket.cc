#include "pliant/plants/socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses Find(const std::string& host, int port, int type) {
  addrinfo hints{};
  hints.ai_socktype = type;
  addrinfo* found = nullptr;
  if (const int rc = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found))
    throw Error(gai_strerror(rc));
  return {found, &freeaddrinfo};
}

/// Until `patience` is over, however many signals come; true also for what reading would tell as an
/// error.
bool Wait(int descriptor, short events, std::chrono::nanoseconds patience) noexcept {
  using std::chrono::nanoseconds;
  const auto until = std::chrono::steady_clock::now() + patience;
  pollfd wait{.fd = descriptor, .events = events, .revents = 0};
  for (;;) {
    if (patience < nanoseconds::zero()) patience = nanoseconds::zero();
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(patience);
    const timespec time{.tv_sec = whole.count(), .tv_nsec = (patience - whole).count()};
    const int ready = ppoll(&wait, 1, &time, nullptr);
    if (ready >= 0 || errno != EINTR) return ready != 0;
    patience = until - std::chrono::steady_clock::now();
  }
}

/// 0, or the errno of what went wrong.
int Connect(const Socket& s, const addrinfo& to, std::chrono::milliseconds limit) {
  if (s.descriptor() < 0) return errno;
  if (connect(s.descriptor(), to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!s.WaitToWrite(limit)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(s.descriptor(), SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

Socket ConnectTo(const std::string& host, int port, int type, std::chrono::milliseconds limit) {
  const Addresses all = Find(host, port, type);
  int error = 0;
  for (const addrinfo* to = all.get(); to; to = to->ai_next) {
    Socket s(socket(to->ai_family, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    error = Connect(s, *to, limit);
    if (error == 0) return s;
  }
  throw Error(std::strerror(error));
}

}  // namespace

bool Socket::WaitToRead(std::chrono::nanoseconds patience) const noexcept {
  return Wait(descriptor_.get(), POLLIN, patience);
}

bool Socket::WaitToWrite(std::chrono::nanoseconds patience) const noexcept {
  return Wait(descriptor_.get(), POLLOUT, patience);
}

Socket ConnectTcp(const std::string& host, int port, std::chrono::milliseconds limit) {
  Socket s = ConnectTo(host, port, SOCK_STREAM, limit);
  // A request is one small write that waits for its answer.
  const int yes = 1;
  setsockopt(s.descriptor(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  return s;
}

Socket ConnectUdp(const std::string& host, int port) {
  return ConnectTo(host, port, SOCK_DGRAM, {});
}

std::string Resolved(const std::string& host) {
  const Addresses all = Find(host, 0, SOCK_STREAM);
  char figures[NI_MAXHOST];
  if (const int rc = getnameinfo(all->ai_addr, all->ai_addrlen, figures, sizeof figures, nullptr, 0,
                                 NI_NUMERICHOST))
    throw Error(gai_strerror(rc));
  return figures;
}

}  // namespace pliant
