#include "pliant/plants/bota_frame.h"

#include <algorithm>
#include <bit>

namespace pliant {

namespace {

constexpr std::size_t kFrame = kBotaFrameBytes, kCrc = kFrame - 2;

template <class T>
void Put(std::uint8_t* to, T number) {
  for (std::size_t i = 0; i < sizeof(T); ++i) to[i] = static_cast<std::uint8_t>(number >> 8 * i);
}
void Put(std::uint8_t* to, float number) { Put(to, std::bit_cast<std::uint32_t>(number)); }

template <class T>
T Get(const std::uint8_t* from) {
  T number = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    number = static_cast<T>(number | static_cast<T>(from[i]) << 8 * i);
  return number;
}
template <>
float Get(const std::uint8_t* from) {
  return std::bit_cast<float>(Get<std::uint32_t>(from));
}

std::uint16_t CrcOf(std::span<const std::uint8_t, kFrame> frame) {
  return Crc16X25(frame.subspan(1, kCrc - 1));
}

}  // namespace

std::uint16_t Crc16X25(std::span<const std::uint8_t> bytes) noexcept {
  constexpr auto table = [] {
    std::array<std::uint16_t, 256> of_byte{};
    for (unsigned byte = 0; byte < 256; ++byte) {
      unsigned crc = byte;
      for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0x8408U : crc >> 1;
      of_byte[byte] = static_cast<std::uint16_t>(crc);
    }
    return of_byte;
  }();
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ table[(crc ^ byte) & 0xFF];
  return static_cast<std::uint16_t>(~crc);
}

std::array<std::uint8_t, kFrame> Encode(const BotaFrame& frame) {
  std::array<std::uint8_t, kFrame> bytes;
  bytes[0] = kBotaHeader;
  Put(&bytes[1], frame.status);
  for (std::size_t i = 0; i < 3; ++i) {
    Put(&bytes[3 + 4 * i], frame.force[i]);
    Put(&bytes[15 + 4 * i], frame.torque[i]);
  }
  Put(&bytes[27], frame.timestamp_us);
  Put(&bytes[31], frame.temperature);
  Put(&bytes[kCrc], CrcOf(bytes));
  return bytes;
}

std::optional<BotaFrame> BotaParser::Next(std::uint8_t byte) noexcept {
  held_[size_++] = byte;
  if (held_[0] != kBotaHeader) Skip(1);
  if (size_ < kFrame) return {};
  if (CrcOf(held_) != Get<std::uint16_t>(&held_[kCrc])) {
    const auto next = std::find(held_.begin() + 1, held_.end(), kBotaHeader);
    Skip(static_cast<std::size_t>(next - held_.begin()));
    return {};
  }
  BotaFrame frame;
  frame.status = Get<std::uint16_t>(&held_[1]);
  for (std::size_t i = 0; i < 3; ++i) {
    frame.force[i] = Get<float>(&held_[3 + 4 * i]);
    frame.torque[i] = Get<float>(&held_[15 + 4 * i]);
  }
  frame.timestamp_us = Get<std::uint32_t>(&held_[27]);
  frame.temperature = Get<float>(&held_[31]);
  size_ = 0;
  junk_ = 0;
  return frame;
}

void BotaParser::Skip(std::size_t bytes) noexcept {
  for (std::size_t i = 0; i < bytes; ++i) {
    if (junk_ == 0) ++corrupted_;
    if (++junk_ == static_cast<int>(kFrame)) junk_ = 0;
  }
  std::copy(held_.begin() + static_cast<std::ptrdiff_t>(bytes),
            held_.begin() + static_cast<std::ptrdiff_t>(size_), held_.begin());
  size_ -= bytes;
}

}  // namespace pliant
