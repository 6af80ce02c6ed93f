#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// The envelope of Kinova's Kortex protocol. A frame is the protobuf message
///
///   Frame { Header { fixed32 frame_info, message_info, service_info, payload_info }, bytes payload
///   }
///
///   frame_info    31–28 version = 1, 27–24 type, 23–16 device, 15–12 error, 11–0 error's sub-code
///   message_info  31–16 session, 15–0 id
///   service_info  31–28 version = 1, 27–16 service, 15–0 function
///   payload_info  23–0 length
///
/// A datagram is one frame; in a stream each follows the bytes 07 "xEtRoK" 07 and its length, four
/// bytes, big-endian.
///
/// Source: the bits are those of Kinova's Python client kortex_api 2.6; the vendor does not
/// document them.
namespace pliant::kortex {

enum class FrameType : std::uint8_t {
  Request = 1,
  Raw = 2,
  Response = 3,
  Notification = 5,
  Ping = 7,
  Pong = 8,
};

/// Service « 16 | function.
enum class Function : std::uint32_t {
  CreateSession = 0x10001,
  CloseSession = 0x10002,
  KeepAlive = 0x10003,
  ApplyEmergencyStop = 0x20091,
  ClearFaults = 0x20092,
  SetServoingMode = 0x20098,
  GetServoingMode = 0x20099,
  GetActuatorCount = 0x200ab,
  GetArmState = 0x200af,
  Refresh = 0x30001,
  RefreshCommand = 0x30002,
  RefreshFeedback = 0x30003,
  GetControlMode = 0xa0006,
  SetControlMode = 0xa0007,
  ClearActuatorFaults = 0xa0019,
  ReadAllDevices = 0x170001,
};

struct Header {
  FrameType type = FrameType::Request;
  std::uint8_t device = 0;       ///< 0: the base; 1 … 7: the actuators
  std::uint8_t error = 0;        ///< ErrorCodes; 0: none
  std::uint16_t error_code = 0;  ///< SubErrorCodes
  std::uint16_t session = 0;     ///< 0 before the first answer
  std::uint16_t id = 0;          ///< of a request, and of its response
  Function function = Function::KeepAlive;

  bool operator==(const Header&) const = default;
};

/// A frame as it came; the payload lies in the bytes it was read from.
struct Frame {
  Header header;
  std::span<const std::byte> payload;
};

inline constexpr std::size_t kLargestFrame = 65507;  ///< [bytes] of a datagram
inline constexpr std::size_t kEnvelope = 32;         ///< [bytes] a frame is longer than its payload

/// Writes a frame; the bytes written, or 0 if there is no room.
std::size_t WriteFrame(const Header& header, std::span<const std::byte> payload,
                       std::span<std::byte> out) noexcept;

/// None if the bytes are no frame of version 1 whose payload has the length it says.
std::optional<Frame> ReadFrame(std::span<const std::byte> bytes) noexcept;

/// Finds frames in a stream.
class FrameStream {
 public:
  /// Where to put what arrives next; then Filled says how much did.
  std::span<std::byte> Room();
  void Filled(std::size_t bytes);

  /// The bytes of the next frame that is there whole, valid until Room. Throws Error if the stream
  /// is out of step: what follows has no meaning.
  std::optional<std::span<const std::byte>> Next();

 private:
  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0, end_ = 0;
};

/// The frame with what goes before it in a stream.
std::vector<std::byte> InStream(const Header& header, std::span<const std::byte> payload);

}  // namespace pliant::kortex
