#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace pliant {

/// What a Bota sensor with a serial port sends 800 times a second, at 460 800 baud: 37 bytes, all
/// numbers little endian.
///
///   0xAA | status u16 | Fx Fy Fz Mx My Mz f32 | time u32 [µs] | temperature f32 [°C] | CRC u16
///
/// The CRC is that of the 34 bytes between the header and itself.
///
/// Source: the drivers that Bota Systems publishes for its serial sensors.
struct BotaFrame {
  std::uint16_t status = 0;
  std::array<float, 3> force{};    ///< [N]
  std::array<float, 3> torque{};   ///< [N·m]
  std::uint32_t timestamp_us = 0;  ///< of the sensor's clock; begins again after 2³² µs
  float temperature = 0;           ///< [°C]

  bool operator==(const BotaFrame&) const = default;
};

inline constexpr std::size_t kBotaFrameBytes = 37;
inline constexpr std::uint8_t kBotaHeader = 0xAA;

/// Bits of the status.
inline constexpr std::uint16_t kBotaTooLate = 1;    ///< a measurement was skipped
inline constexpr std::uint16_t kBotaOverRange = 2;  ///< the load is beyond what is measured
inline constexpr std::uint16_t kBotaInvalid = 4;    ///< the sensor may be damaged
inline constexpr std::uint16_t kBotaRaw = 8;        ///< gauges, not forces and torques

/// Whether a status says that the wrench is not to be used.
constexpr bool IsBotaFault(std::uint16_t status) {
  return (status & (kBotaOverRange | kBotaInvalid | kBotaRaw)) != 0;
}

/// CRC-16/X-25: polynomial 0x1021 reflected, initial value and final xor 0xFFFF.
std::uint16_t Crc16X25(std::span<const std::uint8_t> bytes) noexcept;

std::array<std::uint8_t, kBotaFrameBytes> Encode(const BotaFrame& frame);

/// Finds frames in a stream of bytes that may begin anywhere, hold junk and be cut in any pieces. A
/// frame is found as soon as its last byte is there. Bytes that are none are given up one header at
/// a time, so a whole frame is lost only if it overlaps with others that pass the CRC: 1 of 2¹⁶
/// headers in junk.
class BotaParser {
 public:
  /// One byte more; the frame that ends with it, if one does.
  std::optional<BotaFrame> Next(std::uint8_t byte) noexcept;

  /// Stretches of 37 bytes, begun, that were no frame. The first 36 may be the rest of a frame that
  /// began before the stream, and do not count.
  std::uint32_t corrupted() const { return corrupted_; }

 private:
  void Skip(std::size_t bytes) noexcept;

  std::array<std::uint8_t, kBotaFrameBytes> held_{};  // a header, and what follows it
  std::size_t size_ = 0;
  int junk_ = 1 - static_cast<int>(kBotaFrameBytes);  // bytes since the last frame
  std::uint32_t corrupted_ = 0;
};

}  // namespace pliant
