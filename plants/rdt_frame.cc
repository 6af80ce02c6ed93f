#include "pliant/plants/rdt_frame.h"

#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr std::uint16_t kHeader = 0x1234;

/// `size` bytes of a number, the highest first.
void Put(std::uint8_t* to, std::uint32_t number, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i)
    to[i] = static_cast<std::uint8_t>(number >> 8 * (size - 1 - i));
}

std::uint32_t Get(const std::uint8_t* from, std::size_t size) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < size; ++i) number = number << 8 | from[i];
  return number;
}

}  // namespace

std::array<std::uint8_t, kRdtRequestBytes> Encode(const RdtRequest& request) {
  std::array<std::uint8_t, kRdtRequestBytes> bytes;
  Put(&bytes[0], kHeader, 2);
  Put(&bytes[2], static_cast<std::uint16_t>(request.command), 2);
  Put(&bytes[4], request.count, 4);
  return bytes;
}

std::array<std::uint8_t, kRdtRecordBytes> Encode(const RdtRecord& record) {
  std::array<std::uint8_t, kRdtRecordBytes> bytes;
  Put(&bytes[0], record.rdt_sequence, 4);
  Put(&bytes[4], record.ft_sequence, 4);
  Put(&bytes[8], record.status, 4);
  for (std::size_t i = 0; i < 6; ++i)
    Put(&bytes[12 + 4 * i], static_cast<std::uint32_t>(record.counts[i]), 4);
  return bytes;
}

std::optional<RdtRequest> DecodeRdtRequest(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kRdtRequestBytes || Get(&bytes[0], 2) != kHeader) return {};
  return RdtRequest{static_cast<RdtCommand>(Get(&bytes[2], 2)), Get(&bytes[4], 4)};
}

std::optional<RdtRecord> DecodeRdtRecord(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kRdtRecordBytes) return {};
  RdtRecord record{Get(&bytes[0], 4), Get(&bytes[4], 4), Get(&bytes[8], 4), {}};
  for (std::size_t i = 0; i < 6; ++i)
    record.counts[i] = static_cast<std::int32_t>(Get(&bytes[12 + 4 * i], 4));
  return record;
}

Wrench RdtScale::WrenchOf(const std::array<std::int32_t, 6>& counts) const noexcept {
  Wrench wrench;
  for (int i = 0; i < 3; ++i) {
    wrench(i) = counts[static_cast<std::size_t>(i + 3)] / counts_per_newton_meter;
    wrench(i + 3) = counts[static_cast<std::size_t>(i)] / counts_per_newton;
  }
  return wrench;
}

std::array<std::int32_t, 6> RdtScale::CountsOf(const Wrench& wrench) const noexcept {
  constexpr auto nearest = [](double x) {
    using Limits = std::numeric_limits<std::int32_t>;
    if (!(x < Limits::max())) return Limits::max();
    if (x < Limits::min()) return Limits::min();
    return static_cast<std::int32_t>(std::lround(x));
  };
  std::array<std::int32_t, 6> counts;
  for (int i = 0; i < 3; ++i) {
    counts[static_cast<std::size_t>(i)] = nearest(wrench(i + 3) * counts_per_newton);
    counts[static_cast<std::size_t>(i + 3)] = nearest(wrench(i) * counts_per_newton_meter);
  }
  return counts;
}

}  // namespace pliant
