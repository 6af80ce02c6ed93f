#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "pliant/apps/stop_signals.h"
#include "pliant/systems/time.h"

namespace pliant {

/// Calls `tick` with 0, 1, 2, … at the times of a period, until the duration is over (0: without an
/// end) or Ctrl-C or its like asks to stop. One that is late by more than 100 ms, as after a
/// suspended machine, moves those that follow; less is caught up with.
inline void Pace(Duration period, double duration_s,
                 const std::function<void(std::int64_t)>& tick) {
  using namespace std::chrono;
  const StopSignals signals;
  auto start = steady_clock::now();
  for (std::int64_t k = 0; !StopSignals::requested; ++k) {
    if (duration_s > 0 && 1e-9 * static_cast<double>(period.Times(k)) >= duration_s) return;
    const auto due = start + nanoseconds(period.Times(k));
    std::this_thread::sleep_until(due);
    if (const auto late = steady_clock::now() - due; late > milliseconds(100)) start += late;
    tick(k);
  }
}

}  // namespace pliant
