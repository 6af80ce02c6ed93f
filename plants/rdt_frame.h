#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "pliant/systems/signal.h"

namespace pliant {

/// Raw Data Transfer: how ATI's Net F/T and those that speak like it send wrenches over UDP. All
/// numbers are big endian.
///
///   request   0x1234 | command u16 | count u32
///   record    rdt_sequence u32 | ft_sequence u32 | status u32 | Fx Fy Fz Tx Ty Tz, each i32
///
/// Forces and torques are counts; how many make 1 N and 1 N·m is set in the sensor.
///
/// Source: ATI Industrial Automation, Net F/T manual 9620-05-Net FT, sec. on RDT.
inline constexpr int kRdtPort = 49152;
inline constexpr std::size_t kRdtRequestBytes = 8, kRdtRecordBytes = 36;

enum class RdtCommand : std::uint16_t {
  Stop = 0,
  Start = 2,    ///< a record for each sample, at once
  Bias = 0x42,  ///< what is measured now becomes zero
};

struct RdtRequest {
  RdtCommand command = RdtCommand::Start;
  std::uint32_t count = 0;  ///< of records; 0: until stopped

  bool operator==(const RdtRequest&) const = default;
};

struct RdtRecord {
  std::uint32_t rdt_sequence = 0;        ///< of records, from 1 at the start
  std::uint32_t ft_sequence = 0;         ///< of measurements
  std::uint32_t status = 0;              ///< 0: nothing is wrong
  std::array<std::int32_t, 6> counts{};  ///< Fx Fy Fz Tx Ty Tz

  bool operator==(const RdtRecord&) const = default;
};

std::array<std::uint8_t, kRdtRequestBytes> Encode(const RdtRequest& request);
std::array<std::uint8_t, kRdtRecordBytes> Encode(const RdtRecord& record);

/// What the bytes say; none if there are more or fewer of them, or another first word.
std::optional<RdtRequest> DecodeRdtRequest(std::span<const std::uint8_t> bytes) noexcept;
std::optional<RdtRecord> DecodeRdtRecord(std::span<const std::uint8_t> bytes) noexcept;

/// Whether a status says that the wrench is not to be used. Bit 31 stands beside any other bit, and
/// bit 16 is a threshold that was passed, which says nothing against the wrench.
constexpr bool IsRdtFault(std::uint32_t status) {
  constexpr std::uint32_t kSummary = 1U << 31, kThreshold = 1U << 16;
  return status == kSummary || (status & ~(kSummary | kThreshold)) != 0;
}

/// Counts per unit, as the sensor has them.
struct RdtScale {
  double counts_per_newton = 1e6;
  double counts_per_newton_meter = 1e6;

  Wrench WrenchOf(const std::array<std::int32_t, 6>& counts) const noexcept;
  /// The nearest counts; the largest there are for a wrench beyond them or NaN.
  std::array<std::int32_t, 6> CountsOf(const Wrench& wrench) const noexcept;
};

}  // namespace pliant
