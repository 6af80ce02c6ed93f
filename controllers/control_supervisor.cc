#include "pliant/controllers/control_supervisor.h"

#include <cmath>
#include <numbers>

namespace pliant {

ControlSupervisor::ControlSupervisor(const Options& o)
    : wanted{this, "wanted"},
      reference{this, "reference", o.joints},
      measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      held{this, "held", {}, false},
      control{this, "control"},
      mode{this, "mode"},
      braking{this, "braking"},
      follow{this, "follow"},
      posture{this, "posture", o.joints},
      settings_{o.settings},
      continuous_{o.continuous},
      alpha_{1 - std::exp(-2 * std::numbers::pi * o.settings.filter_hz * seconds(o.period))},
      memory_{this,
              "memory",
              {},
              {.control = o.first, .velocity = JointVelocity::Zero(o.joints), .posture = o.start}} {
  RequireInRange("", o.settings);
  RequireOneForEach(o.joints, "start", o.start.size());
  Every(o.period)
      .Compute(memory_)
      .From(memory_, wanted, reference, measured_position, measured_velocity)
      .As(&ControlSupervisor::Next);
  Compute(control).From(memory_).As([](const Memory& m) { return m.control; });
  Compute(mode).From(memory_).As([](const Memory& m) {
    return m.control == ArmControl::Position ? ControlMode::Position : ControlMode::Current;
  });
  Compute(braking).From(memory_, held).As([](const Memory& m, bool held) {
    return m.braking || (held && m.control == ArmControl::Position);
  });
  Compute(follow).From(memory_, held).As([](const Memory& m, bool held) {
    return held || m.control != ArmControl::Position;
  });
  Compute(posture).From(memory_).As([](const Memory& m) { return m.posture; });
}

bool ControlSupervisor::IsAt(const JointPosition& r, const JointPosition& q) const {
  PerJoint e = r - q;
  for (Eigen::Index j = 0; j < e.size(); ++j)
    if (continuous_ >> j & 1) e(j) = std::remainder(e(j), 2 * std::numbers::pi);
  return e.norm() < settings_.tracked_within;
}

ControlSupervisor::Memory ControlSupervisor::Next(const Memory& last, ArmControl asked,
                                                  const JointPosition& r, const JointPosition& q,
                                                  const JointVelocity& v) const {
  Memory m = last;
  m.velocity += alpha_ * (v - last.velocity);
  if (!m.velocity.allFinite()) m.velocity = v;
  if (asked != ArmControl::Position) {
    if (last.control != ArmControl::Position || IsAt(r, q)) m.control = asked;
    m.braking = false;
  } else if (last.control != ArmControl::Position) {
    if (!last.braking) m.posture = q;
    m.braking = !(m.velocity.norm() < settings_.rest_speed);
    if (!m.braking) m.control = ArmControl::Position;
  }
  return m;
}

}  // namespace pliant
