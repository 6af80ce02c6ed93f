#pragma once

#include <cmath>
#include <cstdint>

#include "pliant/systems/simulator.h"

namespace pliant::internal {

/// Simulates in parts of at most a tenth of a second, as long as `go_on`, asked after each, says
/// so. Whether the run came to its end, or a block ended it.
template <class GoOn>
bool AdvanceInParts(Simulator& sim, double duration_s, const GoOn& go_on) {
  const auto parts = static_cast<std::int64_t>(std::ceil(10 * duration_s));
  for (std::int64_t k = 1; k <= parts; ++k) {
    sim.AdvanceTo(duration_s * static_cast<double>(k) / static_cast<double>(parts));
    const bool goes_on = go_on();
    if (sim.ended()) return true;
    if (!goes_on) return k == parts;
  }
  return true;
}

}  // namespace pliant::internal
