#pragma once

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include <BaseCyclic.pb.h>
#include <DeviceManager.pb.h>
#include <Errors.pb.h>
#include <Session.pb.h>
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pliant/plants/gen3_link.h"
#include "pliant/plants/kortex_frame.h"

namespace pliant {

namespace api = Kinova::Api;
using kortex::Function;

/// An answer with bytes of its own.
struct Answered {
  kortex::Header header;
  std::string payload;

  api::SubErrorCodes error() const { return static_cast<api::SubErrorCodes>(header.error_code); }
  template <class Message>
  Message As() const {
    Message message;
    EXPECT_TRUE(message.ParseFromString(payload));
    return message;
  }
};

inline std::span<const std::byte> BytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

inline Answered Own(const kortex::Frame& frame) {
  return {frame.header,
          {reinterpret_cast<const char*>(frame.payload.data()), frame.payload.size()}};
}

inline std::string SessionOf(const std::string& user = "admin",
                             const std::string& password = "admin", unsigned patience_ms = 60000) {
  api::Session::CreateSessionInfo info;
  info.set_username(user);
  info.set_password(password);
  info.set_session_inactivity_timeout(patience_ms);
  info.set_connection_inactivity_timeout(2000);
  return info.SerializeAsString();
}

inline std::string Servoing(api::Base::ServoingMode mode) {
  api::Base::ServoingModeInformation info;
  info.set_servoing_mode(mode);
  return info.SerializeAsString();
}

inline std::string Mode(api::ActuatorConfig::ControlMode mode) {
  api::ActuatorConfig::ControlModeInformation info;
  info.set_control_mode(mode);
  return info.SerializeAsString();
}

/// A command that repeats what was measured.
inline api::BaseCyclic::Command Echo(const api::BaseCyclic::Feedback& feedback, unsigned id) {
  api::BaseCyclic::Command command;
  command.set_frame_id(id);
  for (const auto& a : feedback.actuators()) {
    auto& b = *command.add_actuators();
    b.set_command_id(id);
    b.set_position(a.position());
    b.set_torque_joint(-a.torque());
    b.set_current_motor(a.current_motor());
  }
  return command;
}

/// The plainest client of the protocol: blocking sockets to this machine, patient for 5 s.
class KortexClient {
 public:
  KortexClient(int type, int port) : type_{type}, fd_{::socket(AF_INET, type, 0)} {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  KortexClient(KortexClient&& o) noexcept
      : type_{o.type_}, fd_{std::exchange(o.fd_, -1)}, session{o.session}, id{o.id} {}
  KortexClient& operator=(KortexClient&& o) noexcept {
    std::swap(type_, o.type_);
    std::swap(fd_, o.fd_);
    std::swap(stream_, o.stream_);
    std::swap(session, o.session);
    std::swap(id, o.id);
    return *this;
  }
  ~KortexClient() {
    if (fd_ >= 0) ::close(fd_);
  }

  void Put(std::span<const std::byte> bytes) {
    ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void Send(Function function, const std::string& payload = "", std::uint8_t device = 0) {
    const kortex::Header header{
        .device = device, .session = session, .id = ++id, .function = function};
    if (type_ == SOCK_STREAM) return Put(kortex::InStream(header, BytesOf(payload)));
    std::vector<std::byte> bytes(payload.size() + kortex::kEnvelope);
    bytes.resize(kortex::WriteFrame(header, BytesOf(payload), bytes));
    Put(bytes);
  }
  /// The next frame; none within the patience, or once the other side hung up.
  std::optional<Answered> Receive(int patience_ms = 5000) {
    for (;;) {
      if (type_ == SOCK_STREAM)
        if (const auto bytes = stream_.Next()) {
          const auto frame = kortex::ReadFrame(*bytes);
          return frame ? std::optional(Own(*frame)) : std::nullopt;
        }
      pollfd p{fd_, POLLIN, 0};
      if (::poll(&p, 1, patience_ms) <= 0) return {};
      if (type_ == SOCK_DGRAM) {
        std::array<std::byte, 4096> bytes;
        const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
        if (got < 0) return {};
        const auto frame = kortex::ReadFrame(std::span(bytes).first(static_cast<std::size_t>(got)));
        return frame ? std::optional(Own(*frame)) : std::nullopt;
      }
      const std::span<std::byte> room = stream_.Room();
      const ssize_t got = ::recv(fd_, room.data(), room.size(), 0);
      if (got <= 0) {
        hung_up = true;
        return {};
      }
      stream_.Filled(static_cast<std::size_t>(got));
    }
  }
  Answered Ask(Function function, const std::string& payload = "", std::uint8_t device = 0) {
    Send(function, payload, device);
    const auto answer = Receive();
    EXPECT_TRUE(answer) << "no answer";
    if (!answer) return {};
    EXPECT_EQ(answer->header.id, id);
    return *answer;
  }
  /// A datagram may be lost where many are under way: asks again.
  void Open() {
    const bool stream = type_ == SOCK_STREAM;
    session = 0;
    for (int tries = stream ? 1 : 50; tries > 0 && session == 0; --tries) {
      Send(Function::CreateSession, SessionOf());
      while (const auto answer = Receive(stream ? 5000 : 200))
        if (answer->header.id == id) {
          EXPECT_EQ(answer->header.error, 0);
          session = answer->header.session;
          break;
        }
    }
    EXPECT_NE(session, 0);
  }
  /// The datagrams that are there.
  std::vector<std::vector<std::byte>> Drain() {
    std::vector<std::vector<std::byte>> all;
    for (;;) {
      std::vector<std::byte> bytes(kortex::kLargestFrame);
      const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (got < 0) return all;
      bytes.resize(static_cast<std::size_t>(got));
      all.push_back(std::move(bytes));
    }
  }
  int descriptor() const { return fd_; }

 private:
  int type_, fd_;
  kortex::FrameStream stream_;

 public:
  std::uint16_t session = 0, id = 0;
  bool hung_up = false;
};

}  // namespace pliant
