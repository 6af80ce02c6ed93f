#include "pliant/plants/kortex_cyclic.h"

#include <google/protobuf/io/coded_stream.h>

#include <array>
#include <optional>

#include <BaseCyclic.pb.h>

namespace pliant::kortex {

namespace {

namespace wire = Kinova::Api::BaseCyclic;
using google::protobuf::io::CodedInputStream;

// Of protobuf: field « 3 | wire type, which is 2 for lengths and 5 for fixed32.
constexpr std::uint32_t kFrameIdTag = 1 << 3 | 5, kBaseTag = 2 << 3 | 2, kActuatorTag = 3 << 3 | 2;

// Seven actuators of six numbers, each behind its tag, are 235 bytes.
constexpr std::size_t kLongestCommand = 512;

/// What follows a tag of wire type 2.
std::optional<std::span<const std::byte>> Message(CodedInputStream& in,
                                                  std::span<const std::byte> whole) {
  std::uint32_t length;
  if (!in.ReadVarint32(&length)) return {};
  const auto at = static_cast<std::size_t>(in.CurrentPosition());
  if (length > whole.size() - at || !in.Skip(static_cast<int>(length))) return {};
  return whole.subspan(at, length);
}

bool Skip(CodedInputStream& in, std::span<const std::byte> whole, std::uint32_t tag) {
  std::uint64_t number;
  switch (tag & 7) {
    case 0:
      return in.ReadVarint64(&number);
    case 1:
      return in.Skip(8);
    case 2:
      return Message(in, whole).has_value();
    case 5:
      return in.Skip(4);
    default:
      return false;
  }
}

template <class M>
bool Parse(M& message, const std::optional<std::span<const std::byte>>& bytes) {
  return bytes && message.ParseFromArray(bytes->data(), static_cast<int>(bytes->size()));
}

void Take(const wire::BaseFeedback& from, Gen3Feedback& to) {
  to.arm_state = static_cast<std::uint32_t>(from.active_state());
  to.fault_a = from.fault_bank_a();
  to.fault_b = from.fault_bank_b();
  to.warning_a = from.warning_bank_a();
  to.warning_b = from.warning_bank_b();
}

Gen3Feedback::Actuator Taken(const wire::ActuatorFeedback& from) {
  return {.command_id = from.command_id(),
          .status_flags = from.status_flags(),
          .jitter_us = from.jitter_comm(),
          .position = from.position(),
          .velocity = from.velocity(),
          .torque = from.torque(),
          .current = from.current_motor(),
          .voltage = from.voltage(),
          .motor_temperature = from.temperature_motor(),
          .core_temperature = from.temperature_core(),
          .fault_a = from.fault_bank_a(),
          .fault_b = from.fault_bank_b(),
          .warning_a = from.warning_bank_a(),
          .warning_b = from.warning_bank_b()};
}

}  // namespace

// Messages without messages in them are cleared without being freed, those with them are not: the
// outermost level is read by hand.
struct Cyclic::Messages {
  wire::Command command;
  wire::BaseFeedback base;
  wire::ActuatorFeedback actuator;
  std::array<std::byte, kLongestCommand> bytes;
};

Cyclic::Cyclic() : messages_{std::make_unique<Messages>()} {
  for (int i = 0; i < kGen3Joints; ++i) messages_->command.add_actuators();
}

Cyclic::~Cyclic() = default;

std::span<const std::byte> Cyclic::Write(std::uint16_t id, const Gen3Command& command) noexcept {
  wire::Command& message = messages_->command;
  message.set_frame_id(id);
  for (int i = 0; i < kGen3Joints; ++i) {
    const Gen3Command::Actuator& from = command.actuator[static_cast<std::size_t>(i)];
    wire::ActuatorCommand& to = *message.mutable_actuators(i);
    to.set_command_id(id);
    to.set_position(from.position);
    to.set_velocity(from.velocity);
    to.set_torque_joint(from.torque);
    to.set_current_motor(from.current);
  }
  const std::size_t length = message.ByteSizeLong();
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(messages_->bytes.data()));
  return std::span(messages_->bytes).first(length);
}

bool Cyclic::Read(std::span<const std::byte> payload, Gen3Feedback& feedback) noexcept {
  if (payload.empty()) return false;
  CodedInputStream in(reinterpret_cast<const std::uint8_t*>(payload.data()),
                      static_cast<int>(payload.size()));
  Gen3Feedback read;
  std::size_t actuators = 0;
  while (const std::uint32_t tag = in.ReadTag()) {
    if (tag == kFrameIdTag) {
      if (!in.ReadLittleEndian32(&read.frame_id)) return false;
    } else if (tag == kBaseTag) {
      if (!Parse(messages_->base, Message(in, payload))) return false;
      Take(messages_->base, read);
    } else if (tag == kActuatorTag) {
      if (actuators == kGen3Joints || !Parse(messages_->actuator, Message(in, payload)))
        return false;
      read.actuator[actuators++] = Taken(messages_->actuator);
    } else if (!Skip(in, payload, tag)) {
      return false;
    }
  }
  if (!in.ConsumedEntireMessage() || actuators != kGen3Joints) return false;
  read.answers = feedback.answers;
  feedback = read;
  return true;
}

}  // namespace pliant::kortex
