#pragma once

#include <algorithm>
#include <vector>

#include "pliant/controllers/pad_events.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A recorded game controller in the place of a real one: at each tick its state after all events
/// until then. It is not connected before the recording says so.
class PadPlayer final : public Block {
 public:
  struct Options {
    PadEvents recording;
    Duration period = 1ms;
  };

  explicit PadPlayer(const Options& o) : state{this, "state"} {
    o.recording.RequireValid();
    states_.push_back({.stamp_s = -kUnbounded});
    for (const PadEvent& event : o.recording.events)
      states_.push_back(After(states_.back(), event));
    Every(o.period).Compute(state).From(clock).As(&PadPlayer::At);
  }

  Output<PadState> state;

 private:
  PadState At(double t) const {
    PadState now = *std::prev(std::ranges::upper_bound(states_, t, {}, &PadState::stamp_s));
    now.stamp_s = std::max(0.0, now.stamp_s);
    return now;
  }

  std::vector<PadState> states_;
};

}  // namespace pliant
