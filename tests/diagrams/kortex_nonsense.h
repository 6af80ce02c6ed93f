#pragma once

#include <array>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "pliant/tests/diagrams/kortex_client.h"

namespace pliant {

/// Bytes with what goes before a frame in a stream: eight bytes and their number.
inline std::vector<std::byte> InStreamAsIs(const std::vector<std::byte>& bytes) {
  std::vector<std::byte> all = kortex::InStream({}, {});
  all.resize(12);
  all[10] = static_cast<std::byte>(bytes.size() >> 8);
  all[11] = static_cast<std::byte>(bytes.size());
  all.insert(all.end(), bytes.begin(), bytes.end());
  return all;
}

/// Frames as a client sends them, then damaged.
class Nonsense {
 public:
  explicit Nonsense(unsigned seed) : random_{seed} {}

  std::vector<std::byte> Next(std::uint16_t session) {
    static constexpr std::array kKnown{
        Function::CreateSession,   Function::CloseSession,       Function::KeepAlive,
        Function::SetServoingMode, Function::ClearFaults,        Function::ApplyEmergencyStop,
        Function::GetArmState,     Function::SetControlMode,     Function::GetControlMode,
        Function::Refresh,         Function::RefreshCommand,     Function::RefreshFeedback,
        Function::ReadAllDevices,  Function::ClearActuatorFaults};
    std::string payload;
    switch (Below(5)) {
      case 0:
        payload = SessionOf(Below(2) ? "admin" : std::string(Below(300), 'x'));
        break;
      case 1: {
        api::BaseCyclic::Command command;
        command.set_frame_id(Word());
        for (unsigned j = Below(4) ? 7 : Below(50); j > 0; --j) {
          auto& a = *command.add_actuators();
          a.set_command_id(Word());
          a.set_position(Wild());
          a.set_torque_joint(Wild());
          a.set_current_motor(Wild());
        }
        payload = command.SerializeAsString();
        break;
      }
      case 2:
        payload = Mode(static_cast<api::ActuatorConfig::ControlMode>(Below(9)));
        break;
      case 3:
        payload.resize(Below(400));
        for (char& c : payload) c = static_cast<char>(Below(256));
        break;
      default:
        break;
    }
    if (Below(4) == 0 && !payload.empty())
      payload[Below(static_cast<unsigned>(payload.size()))] ^= static_cast<char>(1 << Below(8));
    const kortex::Header header{
        .type = Below(8) ? kortex::FrameType::Request : static_cast<kortex::FrameType>(Below(16)),
        .device = static_cast<std::uint8_t>(Below(3) ? Below(9) : Word()),
        .session = Below(4) ? session : static_cast<std::uint16_t>(Word()),
        .id = static_cast<std::uint16_t>(Word()),
        .function =
            Below(8) ? kKnown[Below(kKnown.size())] : static_cast<Function>(Word() & 0xfffffff)};
    std::vector<std::byte> bytes(payload.size() + kortex::kEnvelope);
    bytes.resize(kortex::WriteFrame(header, BytesOf(payload), bytes));
    if (Below(8) == 0) bytes.resize(Below(static_cast<unsigned>(bytes.size())));
    if (Below(8) == 0 && !bytes.empty())
      bytes[Below(static_cast<unsigned>(bytes.size()))] ^= std::byte{1} << Below(8);
    return bytes;
  }

 private:
  unsigned Below(std::size_t end) { return static_cast<unsigned>(random_() % end); }
  std::uint32_t Word() { return static_cast<std::uint32_t>(random_()); }
  float Wild() {
    const std::uint32_t bits = Word();
    float number;
    std::memcpy(&number, &bits, sizeof number);
    return Below(2) ? number : static_cast<float>(Below(720)) - 180;
  }

  std::mt19937 random_;
};

}  // namespace pliant
