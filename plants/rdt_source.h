#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "pliant/plants/rdt_frame.h"
#include "pliant/plants/wrench_source.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/time.h"

namespace pliant {

/// A sensor that sends RDT records over UDP (IPv4): asks it to start, again each time it has been
/// silent for a while, and to stop in the end. Only what comes from the address that was asked is
/// taken; what is no record counts as corrupted.
///
/// Records are in order by rdt_sequence; measurements are told apart by ft_sequence, so a sensor
/// that repeats itself is noticed. A number that is 1000 behind or 10⁶ ahead, or behind at all
/// after a start that was asked for again, is that of a sensor that began anew.
class RdtSource final : public WrenchSource {
 public:
  struct Options {
    std::string host;  ///< such as "192.168.1.1"
    int port = kRdtPort;
    RdtScale scale = {};
    Duration ask_again = 100ms;  ///< after that much silence
  };

  /// Throws Error if the host is not known or the network not there; a sensor that does not answer
  /// is one that is silent.
  explicit RdtSource(const Options& o);
  ~RdtSource() override;
  RdtSource(const RdtSource&) = delete;
  RdtSource& operator=(const RdtSource&) = delete;

  bool Read(WrenchReading& newest) noexcept override;

 private:
  void Ask(RdtCommand command) noexcept;
  bool Take(const RdtRecord& record, WrenchReading& newest) noexcept;

  const RdtScale scale_;
  const std::chrono::duration<double> patience_;
  internal::Descriptor socket_;
  std::chrono::steady_clock::time_point heard_;  // or asked, whichever is later
  LinkCounts link_;
  bool begins_ = true;      // whatever number comes next is the first
  bool may_begin_ = false;  // anew, since it was asked to
  std::uint32_t last_ = 0;
};

}  // namespace pliant
