#include "pliant/controllers/joint_damper.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

PerJoint RangeOf(const RobotModel& m) { return m.upper_limit() - m.lower_limit(); }

PerJoint Margin(const JointDamper::Options& o) {
  // a continuous joint has an infinite range and no limit to keep away from
  return RangeOf(o.model).unaryExpr(
      [&](double r) { return std::isfinite(r) ? o.safety_distance * r : 0; });
}

}  // namespace

JointDamper::JointDamper(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      bounds{this,
             "bounds",
             o.model.joints(),
             {PerJoint::Constant(o.model.size(), -std::numeric_limits<double>::infinity()),
              PerJoint::Constant(o.model.size(), std::numeric_limits<double>::infinity())}},
      law_{o.rate, o.damping_ratio},
      xi0_{o.speed_offset},
      step_{seconds(o.step)},
      lower_{o.model.lower_limit() + Margin(o)},
      upper_{o.model.upper_limit() - Margin(o)},
      speed_{o.velocity_fraction * o.model.velocity_limit()},
      influence_{(o.influence_distance - o.safety_distance) * RangeOf(o.model)} {
  RequireInRange("", o);
  if (o.form == Form::Proposed) {
    Compute(bounds).From(dynamics).As(&JointDamper::Bound);
  } else {
    Require(o.influence_distance > o.safety_distance,
            "influence_distance must be > safety_distance, " + Text(o.safety_distance),
            o.influence_distance);
    const PerJoint none = PerJoint::Zero(o.model.size());
    const Output<Approach>& approach =
        approach_.emplace(this, "approach", Nothing{}, Approach{none, none});
    Every(o.step).Compute(approach).From(approach, dynamics).As(&JointDamper::Enter);
    Compute(bounds).From(dynamics, approach).As(&JointDamper::BoundClassically);
  }
}

void JointDamper::Bound(AccelerationBounds& out, const RobotDynamics& d) const {
  // ë = −q̈ above and q̈ below, so ë ≥ max(ë_p, ë_v) bounds q̈ from both sides.
  for (int i = 0; i < d.q.size(); ++i) {
    out.upper(i) =
        std::min(-law_.Least(upper_(i) - d.q(i), -d.v(i)), law_.rate * (speed_(i) - d.v(i)));
    out.lower(i) =
        std::max(law_.Least(d.q(i) - lower_(i), d.v(i)), -law_.rate * (speed_(i) + d.v(i)));
  }
}

JointDamper::Approach JointDamper::Enter(const Approach& last, const RobotDynamics& d) const {
  const auto xi = [this](double before, double room, double influence, double edot) {
    if (!(room < influence)) return 0.0;
    // On the line d_s and beyond there is no such speed; what was found before stays.
    if (before > 0 || room <= 0) return std::max(before, xi0_);
    return std::abs(edot) * influence / room + xi0_;
  };
  Approach now = last;
  for (int i = 0; i < d.q.size(); ++i) {
    now.upper(i) = xi(last.upper(i), upper_(i) - d.q(i), influence_(i), d.v(i));
    now.lower(i) = xi(last.lower(i), d.q(i) - lower_(i), influence_(i), d.v(i));
  }
  return now;
}

void JointDamper::BoundClassically(AccelerationBounds& out, const RobotDynamics& d,
                                   const Approach& xi) const {
  const auto least = [this](double speed, double room, double influence, double edot) {
    return room < influence ? -(edot + speed * room / influence) / step_
                            : -std::numeric_limits<double>::infinity();
  };
  for (int i = 0; i < d.q.size(); ++i) {
    out.upper(i) = std::min(-least(xi.upper(i), upper_(i) - d.q(i), influence_(i), -d.v(i)),
                            (speed_(i) - d.v(i)) / step_);
    out.lower(i) = std::max(least(xi.lower(i), d.q(i) - lower_(i), influence_(i), d.v(i)),
                            -(speed_(i) + d.v(i)) / step_);
  }
}

}  // namespace pliant
