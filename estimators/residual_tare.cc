#include "pliant/estimators/residual_tare.h"

namespace pliant {

ResidualTare::ResidualTare(const Options& o)
    : residual{this, "residual", o.joints},
      tared{this, "tared", o.joints},
      ready{this, "ready"},
      from_{o.from_s},
      until_{o.until_s},
      memory_{this, "memory", o.joints,
              Memory{JointTorque::Zero(o.joints), 0, JointTorque::Zero(o.joints), false}} {
  RequireInRange("", o);
  Require(o.until_s == 0 || o.until_s >= o.from_s + seconds(o.period),
          "until_s must be 0 or a period after from_s, " + Text(o.from_s) + " s", o.until_s);
  Every(o.period).Compute(memory_).From(memory_, clock, residual).As(&ResidualTare::Next);
  Compute(tared).From(memory_).As([](const Memory& m) { return m.y; });
  Compute(ready).From(memory_).As([](const Memory& m) { return m.ready; });
}

ResidualTare::Memory ResidualTare::Next(const Memory& last, double t, const JointTorque& r) const {
  Memory now = last;
  if (t >= from_ && t < until_ && r.allFinite()) {
    now.sum += r;
    ++now.samples;
  }
  now.ready = t >= until_;
  if (!now.ready) return now;
  now.y = r;
  if (now.samples > 0) now.y -= now.sum / now.samples;
  return now;
}

}  // namespace pliant
