#include "pliant/plants/hardware_wrench.h"

#include <Eigen/LU>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

Wrench Checked(const Wrench& w, const char* name, const Range& range) {
  RequireEachInRange(name, w, Wrench::quantity.unit, range);
  return w;
}

std::int64_t Ticks(Duration time, Duration period) {
  Require(Duration{} < period, "a period must be > 0", period.text());
  const double ticks = seconds(time) / seconds(period);
  Require(ticks > 0 && ticks <= 1e6, "stale_after must be > 0, and 10⁶ periods at most",
          time.text());
  // A whole number of periods is one, whatever the division makes of it.
  return static_cast<std::int64_t>(std::ceil(ticks * (1 - 1e-12)));
}

}  // namespace

HardwareWrench::HardwareWrench(const Options& o)
    : wrench{this, "wrench", Frame(o.frame)},
      valid{this, "valid"},
      status{this, "status"},
      source_{o.source},
      h_{seconds(o.period)},
      stale_{Ticks(o.stale_after, o.period)},
      bias_{Checked(o.bias, "bias", kAnyNumber)},
      range_{Checked(o.range, "range", kNotNegative)},
      R_{o.axes},
      sign_{o.sign},
      memory_{this, "memory", Frame(o.frame)} {
  // A rotation that was written down with nine digits passes.
  Require((R_ * R_.transpose()).isIdentity(1e-8) && R_.determinant() > 0,
          "axes must be a rotation: R Rᵀ = I, det R = 1, got\n" + Text(R_));
  Require(o.sign == 1 || o.sign == -1, "sign must be 1 or -1", o.sign);
  Every(o.period).Compute(memory_).From(memory_).As(&HardwareWrench::Next);
  Compute(wrench).From(memory_).As([](const Memory& m) { return m.wrench; });
  Compute(valid).From(memory_).As(&HardwareWrench::IsValid);
  Compute(status).From(memory_).As(&HardwareWrench::StatusOf);
}

HardwareWrench::Memory HardwareWrench::Next(const Memory& last) const {
  Memory now = last;
  ++now.since_new;
  ++now.since_good;
  WrenchReading reading;
  const bool arrived = source_ && source_->Read(reading);
  now.link = reading.link;
  if (!arrived || (last.any && reading.sequence == last.sequence)) return now;

  Wrench W;
  W.head<3>() = sign_ * R_ * reading.wrench.head<3>();
  W.tail<3>() = sign_ * R_ * reading.wrench.tail<3>();
  const bool within =
      W.allFinite() && ((range_.array() == 0) || (W.array().abs() <= range_.array())).all();
  now.any = true;
  now.sequence = reading.sequence;
  now.device = reading.device_status;
  now.since_new = 0;
  now.good = within && !reading.faulty;
  if (now.good) {
    now.wrench = W - bias_;
    now.since_good = 0;
  }
  return now;
}

WrenchStatus HardwareWrench::StatusOf(const Memory& m) const {
  return {.age = h_ * static_cast<double>(m.since_good), .link = m.link, .device = m.device};
}

}  // namespace pliant
