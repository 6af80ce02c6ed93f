#include "pliant/controllers/joint_damper.h"

#include <cmath>
#include <limits>

namespace pliant {

namespace {

PerJoint Margin(const JointDamper::Options& o) {
  const PerJoint range = o.model.upper_limit() - o.model.lower_limit();
  // a continuous joint has an infinite range and no limit to keep away from
  return range.unaryExpr([&](double r) { return std::isfinite(r) ? o.safety_distance * r : 0; });
}

}  // namespace

JointDamper::JointDamper(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      bounds{this,
             "bounds",
             o.model.joints(),
             {PerJoint::Constant(o.model.size(), -std::numeric_limits<double>::infinity()),
              PerJoint::Constant(o.model.size(), std::numeric_limits<double>::infinity())}},
      lambda_{o.rate},
      M_{o.damping_ratio},
      lower_{o.model.lower_limit() + Margin(o)},
      upper_{o.model.upper_limit() - Margin(o)},
      speed_{o.velocity_fraction * o.model.velocity_limit()} {
  RequireInRange("", o);
  Compute(bounds).From(dynamics).As(&JointDamper::Bound);
}

void JointDamper::Bound(AccelerationBounds& out, const RobotDynamics& d) const {
  const double stiffness = lambda_ * lambda_ / (4 * M_ * M_);
  // ë = −q̈ above and q̈ below, so ë ≥ max(ë_p, ë_v) bounds q̈ from both sides.
  out.upper = (-lambda_ * d.v + stiffness * (upper_ - d.q)).cwiseMin(lambda_ * (speed_ - d.v));
  out.lower = (-lambda_ * d.v + stiffness * (lower_ - d.q)).cwiseMax(-lambda_ * (speed_ + d.v));
}

}  // namespace pliant
