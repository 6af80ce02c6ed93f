#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "pliant/systems/block.h"

namespace pliant {

/// How well a run keeps pace with the wall clock.
struct TickTiming {
  using Space = Nothing;
  static constexpr Quantity quantity{"tick timing", ""};

  double lateness = 0;      ///< of the beginning of this tick against its time
  double compute = 0;       ///< what the tick before took
  std::int64_t missed = 0;  ///< ticks so far that did not begin within their period
  bool overran = false;     ///< this tick began a period or more after its time

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("lateness", lateness, "s");
    f("compute", compute, "s");
    f("missed", missed, "");
    f("overran", overran, "");
  }
};

/// What a RealTimeRunner writes before each tick and the tick reads, in the same thread.
struct TickTimes {
  std::int64_t lateness_ns = 0;
  std::int64_t compute_ns = 0;
  std::int64_t missed = 0;
};

/// Shows a diagram how well it keeps pace, so that it can react, and its log can tell. Zeros in a
/// simulation. A run is not repeated by restoring it: a replay takes the timing from the recording.
class TickTimer final : public Block {
 public:
  struct Options {
    std::shared_ptr<const TickTimes> times = {};  ///< those given to the runner; none: a simulation
    Duration period;
  };

  explicit TickTimer(const Options& o)
      : timing{this, "timing"},
        times_{o.times ? o.times : std::make_shared<const TickTimes>()},
        period_ns_{o.period.Times(1)} {
    Every(o.period).Compute(timing).From().As(&TickTimer::Now);
  }

  Output<TickTiming> timing;

 private:
  TickTiming Now() const {
    return {.lateness = 1e-9 * static_cast<double>(times_->lateness_ns),
            .compute = 1e-9 * static_cast<double>(times_->compute_ns),
            .missed = times_->missed,
            .overran = times_->lateness_ns >= period_ns_};
  }

  const std::shared_ptr<const TickTimes> times_;
  const std::int64_t period_ns_;
};

}  // namespace pliant
