#include "pliant/controllers/frame_speed_limit.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

/// Axes of which the first is along v; any, where v is 0.
Eigen::Matrix3d AxesAlong(const Eigen::Vector3d& v) {
  const Eigen::Vector3d u = v.norm() > 0 ? v.normalized().eval() : Eigen::Vector3d::UnitX();
  Eigen::Matrix3d axes;
  axes.col(0) = u;
  axes.col(1) = u.unitOrthogonal();
  axes.col(2) = u.cross(axes.col(1));
  return axes;
}

}  // namespace

FrameSpeedLimit::FrameSpeedLimit(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      rows{this, "rows", o.model.joints(),
           AccelerationRows::None(kRows, o.model.size(), o.priority)},
      o_{o},
      link_{o.model.link_index(o.frame)} {
  RequireInRange("", o);
  RequireEachInRange("point", o.point, "m", kAnyNumber);
  Compute(rows).From(dynamics).As(&FrameSpeedLimit::Limit);
}

void FrameSpeedLimit::Limit(AccelerationRows& out, const RobotDynamics& d) const {
  const FrameDynamics at = PointDynamics(o_.model, d, link_, o_.point);
  for (const int first : {0, 3}) {
    const double most = first == 0 ? o_.angular : o_.linear;
    if (std::isinf(most)) continue;  // its rows stay without bounds
    const Eigen::Vector3d v = at.twist.segment<3>(first);
    const Eigen::Matrix3d axes = AxesAlong(v);
    const Eigen::Vector3d bias = axes.transpose() * at.Jdot_v.segment<3>(first);
    out.A.middleRows(first, 3).noalias() = axes.transpose().lazyProduct(at.J.middleRows(first, 3));
    const Eigen::Vector3d speed(v.norm(), 0, 0);
    out.lower.segment<3>(first) = (-o_.rate * (most + speed.array())).matrix() - bias;
    out.upper.segment<3>(first) = (o_.rate * (most - speed.array())).matrix() - bias;
  }
}

}  // namespace pliant
