#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "pliant/plants/bota_frame.h"
#include "pliant/plants/wrench_source.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/time.h"

namespace pliant {

/// A Bota sensor at a serial port, or at what stands for one: a pseudo terminal. It sends by
/// itself; nothing is asked of it. An adapter that is unplugged is silent from then on.
///
/// Frames are in order by the sensor's clock; how many are lost is the time between two of them in
/// periods. A time that is a second behind or a minute ahead, or behind at all after a silence, is
/// that of a sensor that began anew.
class BotaSource final : public WrenchSource {
 public:
  struct Options {
    std::filesystem::path device;  ///< such as "/dev/ttyUSB0"
    Duration period = 1250us;      ///< of the sensor's frames, for counting those lost
    Duration silence = 100ms;      ///< after which it may have begun anew
  };

  /// Throws Error if there is no such device, it is none, or it may not be opened.
  explicit BotaSource(const Options& o);

  bool Read(WrenchReading& newest) noexcept override;

 private:
  bool Take(const BotaFrame& frame, WrenchReading& newest) noexcept;

  const double period_us_;
  const std::chrono::duration<double> silence_;
  internal::Descriptor port_;
  BotaParser parser_;
  LinkCounts link_;
  std::chrono::steady_clock::time_point heard_;
  bool begins_ = true, may_begin_ = false;
  std::uint32_t last_us_ = 0;
};

}  // namespace pliant
