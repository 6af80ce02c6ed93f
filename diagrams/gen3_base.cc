#include "pliant/diagrams/gen3_base.h"

#include <ActuatorConfig.pb.h>
#include <Base.pb.h>
#include <BaseCyclic.pb.h>
#include <DeviceManager.pb.h>
#include <Errors.pb.h>
#include <Session.pb.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <array>
#include <utility>

namespace pliant {

namespace {

namespace api = Kinova::Api;
using kortex::Function;

constexpr double kUsualPatience = 60, kLeastPatience = 0.1;  // of a session [s]

constexpr std::array kFunctions{
    Function::CreateSession,       Function::CloseSession,     Function::KeepAlive,
    Function::SetServoingMode,     Function::GetServoingMode,  Function::ClearFaults,
    Function::ApplyEmergencyStop,  Function::GetActuatorCount, Function::GetArmState,
    Function::ReadAllDevices,      Function::GetControlMode,   Function::SetControlMode,
    Function::ClearActuatorFaults, Function::Refresh,          Function::RefreshCommand,
    Function::RefreshFeedback};

constexpr std::uint32_t Service(Function f) { return static_cast<std::uint32_t>(f) >> 16; }
constexpr std::uint32_t kSession = Service(Function::CreateSession),
                        kCyclic = Service(Function::Refresh),
                        kActuatorConfig = Service(Function::SetControlMode);

}  // namespace

/// Why a request is not done.
struct Gen3Base::Refusal {
  api::SubErrorCodes code;
  const char* text;
};

/// Kept, so that the cyclic exchange does not allocate.
struct Gen3Base::Messages {
  api::BaseCyclic::Command command;
  api::BaseCyclic::Feedback feedback;
};

Gen3Base::Gen3Base(Gen3Body& arm, const Options& o)
    : arm_{arm}, o_{o}, messages_{std::make_unique<Messages>()} {
  Require(o.most_sessions > 0 && o.most_sessions < 0xffff, "most_sessions must be in 1 … 65534",
          o.most_sessions);
}

Gen3Base::~Gen3Base() = default;

std::size_t Gen3Base::sessions(Channel channel) const {
  return sessions_[static_cast<std::size_t>(channel)].size();
}

std::optional<Gen3Base::Answer> Gen3Base::Serve(const Request& request) {
  kortex::Header answer = request.header;
  answer.error = 0;
  answer.error_code = 0;
  payload_.clear();
  if (request.header.type == kortex::FrameType::Ping) {
    answer.type = kortex::FrameType::Pong;
  } else if (request.header.type == kortex::FrameType::Request) {
    answer.type = kortex::FrameType::Response;
    try {
      Do(request, answer);
    } catch (const Refusal& refusal) {
      ++refused_;
      // The first 16 codes are of the protocol itself.
      const auto error =
          refusal.code <= api::USER_NOT_FOUND ? api::ERROR_PROTOCOL_SERVER : api::ERROR_DEVICE;
      answer.error = static_cast<std::uint8_t>(error);
      answer.error_code = static_cast<std::uint16_t>(refusal.code);
      api::Error told;
      told.set_error_code(error);
      told.set_error_sub_code(refusal.code);
      told.set_error_sub_string(refusal.text);
      told.SerializeToString(&payload_);
    }
  } else {
    return {};
  }
  return Answer{answer, std::as_bytes(std::span(payload_))};
}

void Gen3Base::Do(const Request& request, kortex::Header& answer) {
  const Function function = request.header.function;
  const std::uint32_t service = Service(function);
  const auto same_service = [service](Function f) { return Service(f) == service; };
  if (std::ranges::none_of(kFunctions, same_service) ||
      (request.channel == Channel::Datagrams && service != kSession && service != kCyclic))
    throw Refusal{api::UNSUPPORTED_SERVICE, "this service is not offered here"};
  if (std::ranges::find(kFunctions, function) == kFunctions.end())
    throw Refusal{api::UNSUPPORTED_METHOD, "the service does not have this function"};
  if (function == Function::CreateSession) return Open(request, answer);

  Sessions& sessions = Of(request.channel);
  const auto session = sessions.find(request.header.session);
  if (session == sessions.end() || session->second.peer != request.peer)
    throw Refusal{api::INVALID_SESSION, "this session was not opened by who asks, or is over"};
  session->second.last_s = request.time_s;
  session->second.last_use = ++uses_;

  const int device = request.header.device;
  const bool known =
      service == kActuatorConfig ? device >= 1 && device <= kGen3Joints : device == 0;
  if (!known) throw Refusal{api::INVALID_DEVICE, "there is no such device for this service"};

  switch (function) {
    case Function::CloseSession:
      return End(request.channel, request.header.session);
    case Function::SetServoingMode:
      return SetServoing(request);
    case Function::GetServoingMode: {
      api::Base::ServoingModeInformation told;
      told.set_servoing_mode(static_cast<api::Base::ServoingMode>(arm_.servoing()));
      told.SerializeToString(&payload_);
      return;
    }
    case Function::ClearFaults:
      return arm_.ClearFaults();
    case Function::ApplyEmergencyStop:
      return arm_.EmergencyStop();
    case Function::GetActuatorCount: {
      api::Base::ActuatorInformation told;
      told.set_count(kGen3Joints);
      told.SerializeToString(&payload_);
      return;
    }
    case Function::GetArmState: {
      api::Base::ArmStateInformation told;
      told.set_active_state(static_cast<api::Common::ArmState>(arm_.feedback().arm_state));
      told.SerializeToString(&payload_);
      return;
    }
    case Function::ReadAllDevices:
      return ListDevices();
    case Function::GetControlMode: {
      api::ActuatorConfig::ControlModeInformation told;
      told.set_control_mode(static_cast<api::ActuatorConfig::ControlMode>(arm_.mode(device - 1)));
      told.SerializeToString(&payload_);
      return;
    }
    case Function::SetControlMode:
      return SetMode(request, device - 1);
    case Function::ClearActuatorFaults:
      return arm_.ClearFaults(device - 1);
    case Function::Refresh:
      Take(request);
      return WriteFeedback();
    case Function::RefreshCommand:
      return Take(request);
    case Function::RefreshFeedback:
      return WriteFeedback();
    default:  // KeepAlive
      return;
  }
}

/// The message of a request's payload.
template <class Message>
void Gen3Base::Read(const Request& request, Message& message) {
  if (!message.ParseFromArray(request.payload.data(), static_cast<int>(request.payload.size())))
    throw Refusal{api::PAYLOAD_DECODING_ERR, "the payload is not this function's message"};
}

void Gen3Base::Open(const Request& request, kortex::Header& answer) {
  api::Session::CreateSessionInfo asked;
  // Names that are no text are the client's business, not a line of ours for each.
  const google::protobuf::LogSilencer quiet;
  Read(request, asked);
  if (asked.username() != o_.user) throw Refusal{api::USER_NOT_FOUND, "there is no such user"};
  if (asked.password() != o_.password)
    throw Refusal{api::INVALID_PASSWORD, "this is not the user's password"};

  Sessions& sessions = Of(request.channel);
  if (sessions.size() >= o_.most_sessions)
    End(request.channel, std::ranges::min_element(sessions, {}, [](const auto& session) {
                           return session.second.last_use;
                         })->first);
  std::uint16_t& next = next_session_[static_cast<std::size_t>(request.channel)];
  while (next == 0 || sessions.contains(next)) ++next;
  const double patience = asked.session_inactivity_timeout() == 0
                              ? kUsualPatience
                              : asked.session_inactivity_timeout() / 1e3;
  sessions[next] = {.peer = request.peer,
                    .last_s = request.time_s,
                    .patience_s = std::max(patience, kLeastPatience),
                    .last_use = ++uses_};
  ++opened_;
  answer.session = next++;
}

void Gen3Base::End(Channel channel, std::uint16_t session) {
  Of(channel).erase(session);
  if (channel == Channel::Stream && servoing_by_ == session) {
    arm_.LeaveLowLevel();
    servoing_by_.reset();
  }
}

void Gen3Base::Expire(double time_s) {
  for (const Channel channel : {Channel::Stream, Channel::Datagrams}) {
    Sessions& sessions = Of(channel);
    for (auto at = sessions.begin(); at != sessions.end();) {
      const auto [id, session] = *at++;
      if (time_s - session.last_s > session.patience_s) End(channel, id);
    }
  }
}

void Gen3Base::EndAllSessions() {
  for (const Channel channel : {Channel::Stream, Channel::Datagrams})
    while (!Of(channel).empty()) End(channel, Of(channel).begin()->first);
}

void Gen3Base::SetServoing(const Request& request) {
  api::Base::ServoingModeInformation asked;
  Read(request, asked);
  switch (asked.servoing_mode()) {
    case api::Base::SINGLE_LEVEL_SERVOING:
      return arm_.LeaveLowLevel();
    case api::Base::BYPASS_SERVOING:
      throw Refusal{api::UNIMPLEMENTED, "this servoing mode is not emulated"};
    case api::Base::LOW_LEVEL_SERVOING:
      break;
    default:
      throw Refusal{api::INVALID_PARAM, "this is no servoing mode"};
  }
  RefuseInFault();
  if (refuses_servoing)
    throw Refusal{api::ROBOT_NOT_READY, "the arm is not ready for low-level servoing"};
  arm_.EnterLowLevel();
  servoing_by_ = request.header.session;
}

void Gen3Base::RefuseInFault() const {
  if (arm_.emergency_stopped())
    throw Refusal{api::ROBOT_IN_EMERGENCY_STOP, "the arm is in an emergency stop"};
  if (arm_.in_fault()) throw Refusal{api::ROBOT_IN_FAULT, "the arm is in a fault"};
}

void Gen3Base::SetMode(const Request& request, int joint) {
  api::ActuatorConfig::ControlModeInformation asked;
  Read(request, asked);
  RefuseInFault();
  if (arm_.servoing() != Gen3Servoing::LowLevel)
    throw Refusal{api::WRONG_SERVOING_MODE, "control modes are for low-level servoing"};
  switch (asked.control_mode()) {
    case api::ActuatorConfig::POSITION:
    case api::ActuatorConfig::TORQUE:
    case api::ActuatorConfig::CURRENT:
    case api::ActuatorConfig::TORQUE_HIGH_VELOCITY:
      return arm_.SetMode(joint, static_cast<Gen3Mode>(asked.control_mode()));
    case api::ActuatorConfig::VELOCITY:
    case api::ActuatorConfig::CUSTOM:
      throw Refusal{api::UNIMPLEMENTED, "this control mode is not emulated"};
    default:
      throw Refusal{api::INVALID_PARAM, "this is no control mode"};
  }
}

void Gen3Base::Take(const Request& request) {
  auto& asked = messages_->command;
  Read(request, asked);
  if (asked.actuators_size() != kGen3Joints)
    throw Refusal{api::CONTROL_ACTUATOR_COUNT_MISMATCH, "a command is for 7 actuators"};
  Gen3Command command;
  Gen3Body::Ids ids;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const auto& a = asked.actuators(static_cast<int>(j));
    ids[j] = a.command_id();
    command.actuator[j] = {.position = a.position(),
                           .velocity = a.velocity(),
                           .torque = a.torque_joint(),
                           .current = a.current_motor()};
  }
  arm_.Command(command, ids, asked.frame_id(), request.jitter_us);
  if (o_.lock_step) arm_.Step();
}

void Gen3Base::WriteFeedback() {
  const Gen3Feedback& from = arm_.feedback();
  auto& to = messages_->feedback;
  to.set_frame_id(from.frame_id);
  auto& base = *to.mutable_base();
  base.set_active_state(static_cast<api::Common::ArmState>(from.arm_state));
  base.set_arm_voltage(from.actuator.front().voltage);
  base.set_fault_bank_a(from.fault_a);
  base.set_fault_bank_b(from.fault_b);
  base.set_warning_bank_a(from.warning_a);
  base.set_warning_bank_b(from.warning_b);
  while (to.actuators_size() < kGen3Joints) to.add_actuators();
  for (std::size_t j = 0; j < from.actuator.size(); ++j) {
    const Gen3Feedback::Actuator& a = from.actuator[j];
    auto& b = *to.mutable_actuators(static_cast<int>(j));
    b.set_command_id(a.command_id);
    b.set_status_flags(a.status_flags);
    b.set_jitter_comm(a.jitter_us);
    b.set_position(a.position);
    b.set_velocity(a.velocity);
    b.set_torque(a.torque);
    b.set_current_motor(a.current);
    b.set_voltage(a.voltage);
    b.set_temperature_motor(a.motor_temperature);
    b.set_temperature_core(a.core_temperature);
    b.set_fault_bank_a(a.fault_a);
    b.set_fault_bank_b(a.fault_b);
    b.set_warning_bank_a(a.warning_a);
    b.set_warning_bank_b(a.warning_b);
  }
  to.SerializeToString(&payload_);
}

void Gen3Base::ListDevices() {
  api::DeviceManager::DeviceHandles told;
  const auto add = [&](api::Common::DeviceTypes type, std::uint32_t id) {
    auto& device = *told.add_device_handle();
    device.set_device_type(type);
    device.set_device_identifier(id);
    device.set_order(id);
  };
  add(api::Common::BASE, 0);
  for (std::uint32_t id = 1; id <= kGen3Joints; ++id)
    add(id <= 4 ? api::Common::BIG_ACTUATOR : api::Common::SMALL_ACTUATOR, id);
  told.SerializeToString(&payload_);
}

}  // namespace pliant
