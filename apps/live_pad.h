#pragma once

#include <memory>

#include "pliant/apps/pad_device.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What a game controller says at each tick, for runs that keep pace with a clock. It reads a word
/// of another thread, so a run is not repeated by restoring it: replay a recording for that.
class LivePad final : public Block {
 public:
  struct Options {
    std::shared_ptr<const PadDevice> device;
    Duration period = 1ms;
  };

  explicit LivePad(const Options& o) : state{this, "state"}, device_{o.device} {
    Require(device_ != nullptr, "device must be one");
    Every(o.period).Compute(state).From().As(&LivePad::Now);
  }

  Output<PadState> state;

 private:
  PadState Now() const { return device_->latest(); }

  const std::shared_ptr<const PadDevice> device_;
};

}  // namespace pliant
