#pragma once

#include <cstdint>

#include "pliant/systems/signal.h"

namespace pliant {

/// What went wrong on the way from a sensor, since the start.
struct LinkCounts {
  std::uint32_t lost = 0;          ///< numbers that were passed over
  std::uint32_t corrupted = 0;     ///< arrived, but are none
  std::uint32_t out_of_order = 0;  ///< older than what had arrived before; they are not used
  std::uint32_t duplicated = 0;    ///< the same number again

  bool operator==(const LinkCounts&) const = default;

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("lost", lost, "");
    f("corrupted", corrupted, "");
    f("out_of_order", out_of_order, "");
    f("duplicated", duplicated, "");
  }
};

/// What a sensor measured last.
struct WrenchReading {
  Wrench wrench;                    ///< in its own axes and with its own sign
  std::uint32_t sequence = 0;       ///< of the measurement: the same again is the same measurement
  std::uint32_t device_status = 0;  ///< as the sensor words it
  bool faulty = false;              ///< the status says that the wrench is not to be used
  LinkCounts link;
};

/// A wrist sensor as a tick sees it.
class WrenchSource {
 public:
  virtual ~WrenchSource() = default;

  /// Takes in all that has arrived and puts the newest measurement into `newest`. False, with no
  /// more than the counts changed, if none arrived. It does not wait, allocate or throw.
  virtual bool Read(WrenchReading& newest) noexcept = 0;
};

}  // namespace pliant
