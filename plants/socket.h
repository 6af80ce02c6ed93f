#pragma once

#include <chrono>
#include <string>

#include "pliant/systems/descriptor.h"

namespace pliant {

/// A socket, closed with its owner and by exec.
class Socket {
 public:
  explicit Socket(int descriptor = -1) : descriptor_{descriptor} {}

  int descriptor() const { return descriptor_.get(); }

  /// Sleeps until there is something to read, or room to write; false if there is not within
  /// `patience`.
  bool WaitToRead(std::chrono::nanoseconds patience) const noexcept;
  bool WaitToWrite(std::chrono::nanoseconds patience) const noexcept;

 private:
  internal::Descriptor descriptor_;
};

/// Connected and non-blocking; each address of the host is tried, for `limit` at most. Throws Error
/// with the reason alone, such as "Connection refused".
Socket ConnectTcp(const std::string& host, int port, std::chrono::milliseconds limit);

/// Its datagrams go to and come from there only. Throws as ConnectTcp.
Socket ConnectUdp(const std::string& host, int port);

/// The host in figures, as "192.168.1.10". Throws Error with the resolver's reason.
std::string Resolved(const std::string& host);

}  // namespace pliant
