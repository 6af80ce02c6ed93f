#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include <BaseCyclic.pb.h>
#include <Errors.pb.h>
#include <Session.pb.h>
#include "pliant/plants/gen3_address.h"
#include "pliant/plants/kortex_frame.h"
#include "pliant/plants/socket.h"

namespace pliant {

/// The other end of the wire, on this machine: an arm that answers what a test wants it to, and
/// remembers what it was asked. No physics and no rules: those are for an emulator.
class FakeGen3 {
 public:
  using Bytes = std::vector<std::byte>;
  static constexpr std::uint16_t kTcpSession = 7, kUdpSession = 9;

  struct Asked {
    bool udp;
    kortex::Header header;
    Bytes payload;
  };
  /// Whole frames to answer with, maybe none; or nothing, for the usual answer.
  using Answer = std::function<std::optional<std::vector<Bytes>>(const Asked&)>;

  explicit FakeGen3(Answer answer = {})
      : answer_{std::move(answer)}, thread_{[this] { Serve(); }} {}
  ~FakeGen3() {
    stop_ = true;
    thread_.join();
  }

  Gen3Address address() const {
    Gen3Address address;
    address.host = "127.0.0.1";
    address.tcp_port = Port(listener_);
    address.udp_port = Port(udp_);
    address.answer_limit = std::chrono::milliseconds(2000);
    return address;
  }

  std::vector<Asked> asked() const {
    const std::lock_guard lock(mutex_);
    return asked_;
  }
  std::vector<Asked> asked(kortex::Function function) const {
    std::vector<Asked> some = asked();
    std::erase_if(some, [&](const Asked& a) { return a.header.function != function; });
    return some;
  }
  /// The servoing it was set to last; 0: never.
  int servoing() const { return servoing_; }
  /// Ends the TCP connections it has.
  void Cut() { cut_ = true; }

  static Bytes Response(const Asked& asked, const Bytes& payload = {}) {
    return Framed({.type = kortex::FrameType::Response,
                   .device = asked.header.device,
                   .session = asked.udp ? kUdpSession : kTcpSession,
                   .id = asked.header.id,
                   .function = asked.header.function},
                  payload);
  }
  static Bytes Refusal(const Asked& asked, Kinova::Api::SubErrorCodes why,
                       const std::string& words) {
    Kinova::Api::Error error;
    error.set_error_code(Kinova::Api::ERROR_DEVICE);
    error.set_error_sub_code(why);
    error.set_error_sub_string(words);
    return Framed({.type = kortex::FrameType::Response,
                   .error = Kinova::Api::ERROR_DEVICE,
                   .error_code = static_cast<std::uint16_t>(why),
                   .session = asked.udp ? kUdpSession : kTcpSession,
                   .id = asked.header.id,
                   .function = asked.header.function},
                  Of(error));
  }
  static Bytes Framed(const kortex::Header& header, const Bytes& payload) {
    Bytes frame(payload.size() + kortex::kEnvelope);
    frame.resize(kortex::WriteFrame(header, payload, frame));
    return frame;
  }
  template <class Message>
  static Bytes Of(const Message& message) {
    Bytes bytes(message.ByteSizeLong());
    message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
    return bytes;
  }
  /// What joint i says: position 10 i + 1, torque i − 3 and so on, of a healthy arm.
  static Kinova::Api::BaseCyclic::Feedback Healthy(int actuators = 7) {
    Kinova::Api::BaseCyclic::Feedback feedback;
    feedback.set_frame_id(77);
    feedback.mutable_base()->set_active_state(Kinova::Api::Common::ARMSTATE_SERVOING_READY);
    for (int i = 0; i < actuators; ++i) {
      auto& a = *feedback.add_actuators();
      a.set_command_id(static_cast<std::uint32_t>(i));
      a.set_position(static_cast<float>(10 * i + 1));
      a.set_velocity(static_cast<float>(-i));
      a.set_torque(static_cast<float>(i - 3));
      a.set_current_motor(0.5F);
      a.set_voltage(24);
      a.set_temperature_motor(30);
      a.set_temperature_core(35);
    }
    return feedback;
  }

 private:
  struct Connection {
    Socket socket;
    kortex::FrameStream stream;
  };

  static Socket Bound(int type) {
    Socket s(socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bind(s.descriptor(), reinterpret_cast<sockaddr*>(&at), sizeof at);
    if (type == SOCK_STREAM) listen(s.descriptor(), 8);
    return s;
  }
  static int Port(const Socket& s) {
    sockaddr_in at{};
    socklen_t size = sizeof at;
    getsockname(s.descriptor(), reinterpret_cast<sockaddr*>(&at), &size);
    return ntohs(at.sin_port);
  }

  std::vector<Bytes> Answered(const Asked& asked) {
    {
      const std::lock_guard lock(mutex_);
      asked_.push_back(asked);
    }
    if (answer_)
      if (auto answers = answer_(asked)) return *answers;
    return {Response(asked, Usual(asked))};
  }

  Bytes Usual(const Asked& asked) {
    const auto size = static_cast<int>(asked.payload.size());
    switch (asked.header.function) {
      case kortex::Function::SetServoingMode: {
        Kinova::Api::Base::ServoingModeInformation mode;
        mode.ParseFromArray(asked.payload.data(), size);
        servoing_ = mode.servoing_mode();
        return {};
      }
      case kortex::Function::GetServoingMode: {
        Kinova::Api::Base::ServoingModeInformation mode;
        mode.set_servoing_mode(servoing_ == 0 ? Kinova::Api::Base::SINGLE_LEVEL_SERVOING
                                              : Kinova::Api::Base::ServoingMode(servoing_.load()));
        return Of(mode);
      }
      case kortex::Function::GetActuatorCount: {
        Kinova::Api::Base::ActuatorInformation actuators;
        actuators.set_count(7);
        return Of(actuators);
      }
      case kortex::Function::GetArmState: {
        Kinova::Api::Base::ArmStateInformation state;
        state.set_active_state(Kinova::Api::Common::ARMSTATE_SERVOING_READY);
        return Of(state);
      }
      case kortex::Function::SetControlMode:
        modes_[asked.header.device % modes_.size()] = asked.payload;
        return {};
      case kortex::Function::GetControlMode:
        return modes_[asked.header.device % modes_.size()];
      case kortex::Function::Refresh:
      case kortex::Function::RefreshFeedback:
        return Of(Healthy());
      default:
        return {};
    }
  }

  static Asked Understood(bool udp, std::span<const std::byte> bytes) {
    const auto frame = kortex::ReadFrame(bytes);
    if (!frame) return {.udp = udp, .header = {.function = kortex::Function(0)}, .payload = {}};
    return {udp, frame->header, {frame->payload.begin(), frame->payload.end()}};
  }

  void Serve() {
    while (!stop_) {
      if (cut_.exchange(false)) connections_.clear();
      std::vector<pollfd> wait{{listener_.descriptor(), POLLIN, 0}, {udp_.descriptor(), POLLIN, 0}};
      for (const Connection& c : connections_) wait.push_back({c.socket.descriptor(), POLLIN, 0});
      poll(wait.data(), wait.size(), 10);
      for (int d; (d = accept4(listener_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK)) >= 0;)
        connections_.push_back({Socket(d), {}});
      ServeUdp();
      std::erase_if(connections_, [this](Connection& c) { return !ServeTcp(c); });
    }
  }

  void ServeUdp() {
    std::array<std::byte, 65536> bytes;
    sockaddr_in from{};
    for (;;) {
      socklen_t size = sizeof from;
      const ssize_t came = recvfrom(udp_.descriptor(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                                    reinterpret_cast<sockaddr*>(&from), &size);
      if (came < 0) return;
      const auto datagram = std::span(bytes).first(static_cast<std::size_t>(came));
      for (const Bytes& answer : Answered(Understood(true, datagram)))
        sendto(udp_.descriptor(), answer.data(), answer.size(), 0,
               reinterpret_cast<sockaddr*>(&from), size);
    }
  }

  bool ServeTcp(Connection& c) {
    const std::span<std::byte> room = c.stream.Room();
    const ssize_t came = recv(c.socket.descriptor(), room.data(), room.size(), MSG_DONTWAIT);
    if (came == 0 || (came < 0 && errno != EAGAIN)) return false;
    if (came > 0) c.stream.Filled(static_cast<std::size_t>(came));
    while (const auto bytes = c.stream.Next()) {
      for (const Bytes& answer : Answered(Understood(false, *bytes))) {
        const Bytes framed = InStream(answer);
        send(c.socket.descriptor(), framed.data(), framed.size(), MSG_NOSIGNAL);
      }
    }
    return true;
  }

  /// A frame that need not be well formed, behind what goes before it in a stream.
  static Bytes InStream(const Bytes& frame) {
    Bytes bytes;
    for (const char c : {'\7', 'x', 'E', 't', 'R', 'o', 'K', '\7'}) bytes.push_back(std::byte(c));
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::byte>(frame.size() >> shift));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    return bytes;
  }

  const Answer answer_;
  Socket listener_ = Bound(SOCK_STREAM), udp_ = Bound(SOCK_DGRAM);
  std::list<Connection> connections_;
  std::array<Bytes, 8> modes_;
  mutable std::mutex mutex_;
  std::vector<Asked> asked_;
  std::atomic<int> servoing_ = 0;
  std::atomic<bool> stop_ = false, cut_ = false;
  std::thread thread_;  // the last: it uses the others
};

/// Waits for what will come, however slow this machine is; false if it does not.
inline bool Eventually(const std::function<bool()>& holds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace pliant
