#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/diagrams/packet_faults.h"
#include "pliant/plants/bota_frame.h"
#include "pliant/systems/descriptor.h"
#include "pliant/systems/signal.h"
#include "pliant/systems/time.h"

namespace pliant {

/// A Bota sensor that is not there: sends a frame a tick into a pseudo terminal. What nobody reads
/// is kept until the terminal is full, and lost then.
class BotaEmulator {
 public:
  struct Options {
    Duration period = 1250us;             ///< of a tick
    std::vector<FaultOrder> faults = {};  ///< of WristFaultKinds
  };

  /// Throws Error if there is no pseudo terminal.
  explicit BotaEmulator(const Options& o);

  const std::string& path() const { return path_; }  ///< the device to read

  /// One period passes, in which it measures a wrench; it does not wait.
  void Tick(const Wrench& wrench);

  std::int64_t sent() const { return sent_; }  ///< frames

 private:
  const Options options_;
  PacketFaults faults_;
  internal::Descriptor ours_, theirs_;  // the two ends; theirs is held open, so that it is there
  std::string path_;
  std::int64_t tick_ = 0, sent_ = 0;
  std::int64_t on_since_ = 0;  // tick
  BotaFrame frame_;
};

}  // namespace pliant
