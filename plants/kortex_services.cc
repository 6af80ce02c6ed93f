#include "pliant/plants/kortex_services.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include "pliant/plants/gen3_faults.h"

namespace pliant::kortex {

namespace {

using namespace std::chrono_literals;

Socket Connected(const Gen3Address& address) {
  try {
    return ConnectTcp(address.host, address.tcp_port, address.connect_limit);
  } catch (const Error& e) {
    throw Unreachable(address, e.what());
  }
}

template <class Message>
std::vector<std::byte> Bytes(const Message& message) {
  std::vector<std::byte> bytes(message.ByteSizeLong());
  message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

template <class Message>
Message Parsed(const Gen3Address& address, const char* what, const std::vector<std::byte>& bytes) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw Error("cannot read the answer of " + address.text() + " to " + what + ": its " +
                Text(bytes.size()) + " bytes are another message; is its firmware of a version 2?");
  return message;
}

std::uint8_t Device(int joint) {
  Require(joint >= 0 && joint < kGen3Joints, "a joint of a Gen3 must be 0 ... 6", joint);
  return static_cast<std::uint8_t>(joint + 1);
}

}  // namespace

Services::Services(const Gen3Address& address)
    : address_{address}, socket_{Connected(address)}, last_sent_{Clock::now()} {
  try {
    Call(SessionRequest(address));
  } catch (const Error& e) {
    if (connected_) throw;
    throw Error(std::string(e.what()) +
                "; is this the port of a Kinova Gen3's services? It is 10000 from the factory");
  }
}

Services::~Services() {
  if (!connected_) return;
  try {
    Call({.function = Function::CloseSession, .text = "CloseSession"}, 500ms);
  } catch (const std::exception&) {
    // The arm ends a silent session by itself.
  }
}

void Services::ClearFaults() { Call({.function = Function::ClearFaults, .text = "ClearFaults"}); }

std::uint32_t Services::ArmState() {
  const auto state = Parsed<Kinova::Api::Base::ArmStateInformation>(
      address_, "GetArmState", Call({.function = Function::GetArmState, .text = "GetArmState"}));
  return static_cast<std::uint32_t>(state.active_state());
}

int Services::ActuatorCount() {
  const auto actuators = Parsed<Kinova::Api::Base::ActuatorInformation>(
      address_, "GetActuatorCount",
      Call({.function = Function::GetActuatorCount, .text = "GetActuatorCount"}));
  return static_cast<int>(actuators.count());
}

Gen3Servoing Services::Servoing() {
  const auto mode = Parsed<Kinova::Api::Base::ServoingModeInformation>(
      address_, "GetServoingMode",
      Call({.function = Function::GetServoingMode, .text = "GetServoingMode"}));
  return static_cast<Gen3Servoing>(mode.servoing_mode());
}

void Services::SetServoing(Gen3Servoing servoing) {
  Kinova::Api::Base::ServoingModeInformation mode;
  mode.set_servoing_mode(static_cast<Kinova::Api::Base::ServoingMode>(servoing));
  Call({.function = Function::SetServoingMode,
        .text = "SetServoingMode " + Gen3ServoingName(servoing),
        .payload = Bytes(mode)});
}

Gen3Mode Services::Mode(int joint) {
  const Request request{.function = Function::GetControlMode,
                        .text = "GetControlMode of actuator " + Text(joint + 1),
                        .device = Device(joint)};
  const auto mode = Parsed<Kinova::Api::ActuatorConfig::ControlModeInformation>(
      address_, "GetControlMode", Call(request));
  return static_cast<Gen3Mode>(mode.control_mode());
}

void Services::SetMode(int joint, Gen3Mode mode) {
  Kinova::Api::ActuatorConfig::ControlModeInformation information;
  information.set_control_mode(static_cast<Kinova::Api::ActuatorConfig::ControlMode>(mode));
  Call({.function = Function::SetControlMode,
        .text = "SetControlMode " + Gen3ModeName(mode) + " of actuator " + Text(joint + 1),
        .device = Device(joint),
        .payload = Bytes(information)});
}

void Services::KeepAlive(std::chrono::milliseconds silent) noexcept {
  try {
    {
      const std::lock_guard lock(call_);
      if (!connected_ || Clock::now() - last_sent_ < silent) return;
    }
    Call({.function = Function::KeepAlive, .text = "KeepAlive"}, address_.connection_timeout);
  } catch (const std::exception&) {
    // Nobody listens here: who calls next is told.
    connected_ = false;
  }
}

std::vector<std::byte> Services::Call(const Request& request) {
  return Call(request, address_.answer_limit);
}

std::vector<std::byte> Services::Call(const Request& request, std::chrono::milliseconds limit) {
  const std::lock_guard lock(call_);
  if (!connected_) throw Lost(request.text + " was not sent");
  const auto until = Clock::now() + limit;
  const Header header{.device = request.device,
                      .session = session_,
                      .id = next_id_++,
                      .function = request.function};
  Write(InStream(header, request.payload), until);
  last_sent_ = Clock::now();
  for (;;) {
    std::optional<std::span<const std::byte>> bytes;
    try {
      bytes = stream_.Next();
    } catch (const Error& e) {
      throw Lost(e.what());
    }
    if (!bytes) {
      if (!Fill(until)) throw Silence(address_, request, limit);
      continue;
    }
    const std::optional<Frame> answer = ReadFrame(*bytes);
    if (!answer || answer->header.type != FrameType::Response || answer->header.id != header.id ||
        answer->header.function != header.function) {
      ++skipped_;
      continue;
    }
    if (answer->header.error != 0) throw Refusal(address_, request, *answer);
    if (session_ == 0) session_ = answer->header.session;
    return {answer->payload.begin(), answer->payload.end()};
  }
}

void Services::Write(std::span<const std::byte> bytes, Clock::time_point until) {
  while (!bytes.empty()) {
    const ssize_t sent =
        send(socket_.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN) {
      // Half a frame would put the stream out of step.
      if (!socket_.WaitToWrite(until - Clock::now())) throw Lost("it takes no more bytes");
    } else if (errno != EINTR) {
      throw Lost(std::strerror(errno));
    }
  }
}

bool Services::Fill(Clock::time_point until) {
  for (;;) {
    const std::span<std::byte> room = stream_.Room();
    const ssize_t came = recv(socket_.descriptor(), room.data(), room.size(), MSG_DONTWAIT);
    if (came > 0) {
      stream_.Filled(static_cast<std::size_t>(came));
      return true;
    }
    if (came == 0) throw Lost("the arm has closed it");
    if (errno == EINTR) continue;
    if (errno != EAGAIN) throw Lost(std::strerror(errno));
    if (!socket_.WaitToRead(until - Clock::now())) return false;
  }
}

Error Services::Lost(const std::string& reason) {
  connected_ = false;
  return Error("the connection to " + address_.text() + " is lost: " + reason + "; connect anew");
}

}  // namespace pliant::kortex
