#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace pliant {

/// A client of a server on the loopback, by hand: HTTP as it is written, and frames of WebSockets.
/// What does not come within 5 s is an exception.
class WebClient {
 public:
  explicit WebClient(std::uint16_t port) : socket_{::socket(AF_INET, SOCK_STREAM, 0)}, port_{port} {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("cannot connect");
  }
  ~WebClient() { ::close(socket_); }
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  void Send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) throw std::runtime_error("cannot send");
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  /// Until the other side closes.
  std::string ReadAll() {
    while (Receive()) continue;
    return std::exchange(in_, {});
  }
  std::string ReadUntil(std::string_view end) {
    while (in_.find(end) == in_.npos)
      if (!Receive()) throw std::runtime_error("closed after '" + in_ + "'");
    const std::size_t past = in_.find(end) + end.size();
    std::string read = in_.substr(0, past);
    in_.erase(0, past);
    return read;
  }

  /// The status line.
  std::string Get(const std::string& path, const std::string& headers) {
    Send("GET " + path + " HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n");
    const std::string answer = ReadAll();
    return answer.substr(0, answer.find("\r\n"));
  }
  std::string Host() const { return "Host: 127.0.0.1:" + std::to_string(port_) + "\r\n"; }

  /// Asks for a WebSocket; the status line.
  std::string Upgrade(const std::string& headers,
                      const std::string& protocol = "foxglove.websocket.v1") {
    Send(
        "GET / HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Protocol: " +
        protocol + "\r\n" + headers + "\r\n");
    head_ = ReadUntil("\r\n\r\n");
    return head_.substr(0, head_.find("\r\n"));
  }
  const std::string& head() const { return head_; }

  void SendFrame(std::string_view content, int opcode = 1) {
    std::string frame(1, static_cast<char>(0x80 | opcode));
    const std::size_t n = content.size();
    if (n < 126) {
      frame += static_cast<char>(0x80 | n);
    } else {
      const bool is_short = n < 65536;
      frame += static_cast<char>(0x80 | (is_short ? 126 : 127));
      for (int shift = is_short ? 8 : 56; shift >= 0; shift -= 8)
        frame += static_cast<char>(n >> shift);
    }
    frame.append(4, '\0');  // a mask that changes nothing
    Send(frame.append(content));
  }
  /// The content of the next frame; its opcode in `opcode`.
  std::string ReadFrame(int* opcode = nullptr) {
    const std::string head = Take(2);
    if (opcode) *opcode = head[0] & 15;
    std::uint64_t n = static_cast<unsigned char>(head[1]) & 127u;
    if (n >= 126) {
      const std::string more = Take(n == 126 ? 2 : 8);
      n = 0;
      for (const char c : more) n = n << 8 | static_cast<unsigned char>(c);
    }
    return Take(n);
  }

 private:
  /// False at the end.
  bool Receive() {
    pollfd ready{.fd = socket_, .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, 5000) <= 0) throw std::runtime_error("nothing comes");
    char bytes[65536];
    const ssize_t n = ::recv(socket_, bytes, sizeof bytes, 0);
    if (n > 0) in_.append(bytes, static_cast<std::size_t>(n));
    return n > 0;
  }
  std::string Take(std::size_t n) {
    while (in_.size() < n)
      if (!Receive()) throw std::runtime_error("closed");
    std::string taken = in_.substr(0, n);
    in_.erase(0, n);
    return taken;
  }

  const int socket_;
  const std::uint16_t port_;
  std::string in_, head_;
};

}  // namespace pliant
