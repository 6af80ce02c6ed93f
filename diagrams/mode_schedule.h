#pragma once

#include <algorithm>
#include <vector>

#include "pliant/plants/arm_status.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// From when on an arm is in a mode.
struct ModeChange {
  double at_s = kToBeGiven;
  ControlMode mode = ControlMode::Torque;

  template <class F>
  void Parameters(F&& f) {
    f("at_s", at_s, "s", Between(0, 1e6));
    f("mode", mode);
  }
};

/// The mode of an arm over time: `first` until the first change, then that of the last change that
/// has come, at ticks of a period.
class ModeSchedule final : public Block {
 public:
  struct Options {
    ControlMode first = ControlMode::Torque;
    std::vector<ModeChange> changes = {};  ///< in order of time
    Duration period = 1ms;
  };

  explicit ModeSchedule(const Options& o)
      : mode{this, "mode", {}, o.first}, first_{o.first}, changes_{o.changes} {
    for (const ModeChange& change : changes_) RequireInRange("a mode", change);
    for (std::size_t i = 1; i < changes_.size(); ++i)
      Require(changes_[i - 1].at_s < changes_[i].at_s, "each mode begins after the one before it",
              Text(changes_[i].at_s) + " s behind " + Text(changes_[i - 1].at_s) + " s");
    Every(o.period).Compute(mode).From(clock).As(&ModeSchedule::At);
  }

  Output<ControlMode> mode;

 private:
  ControlMode At(double t) const {
    const auto after = std::ranges::upper_bound(changes_, t, {}, &ModeChange::at_s);
    return after == changes_.begin() ? first_ : std::prev(after)->mode;
  }

  const ControlMode first_;
  const std::vector<ModeChange> changes_;
};

}  // namespace pliant
