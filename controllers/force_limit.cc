#include "pliant/controllers/force_limit.h"

#include <limits>

#include "pliant/systems/elements.h"

namespace pliant {

ForceLimit::ForceLimit(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      contact{this, "contact"},
      rows{this, "rows", o.model.joints(), AccelerationRows::None(1, o.model.size(), o.priority)},
      o_{o},
      link_{o.model.link_index(o.frame)} {
  RequireInRange("", o);
  Require(o.contact_from < o.force, "contact_from must be below force, " + Text(o.force) + " N",
          o.contact_from);
  if (o.direction) {
    RequireEachInRange("direction", *o.direction, "", kAnyNumber);
    RequireInRange("", "the length of direction", o.direction->norm(), "", kPositive);
  }
  Compute(rows).From(dynamics, contact).As(&ForceLimit::Limit);
}

void ForceLimit::Limit(AccelerationRows& out, const RobotDynamics& d, const Wrench& W) const {
  const FrameDynamics at = PointDynamics(o_.model, d, link_, {0, 0, 0});
  Eigen::Vector3d F = at.pose.rotation * W.tail<3>();
  if (o_.direction) F = F.dot(*o_.direction) / o_.direction->squaredNorm() * *o_.direction;
  const double size = F.norm();
  if (size < o_.contact_from) {
    out.A.setZero();
    out.lower(0) = -std::numeric_limits<double>::infinity();
    return;
  }
  const Eigen::Vector3d u = F / size;
  out.A.row(0).noalias() = u.transpose().lazyProduct(at.J.bottomRows<3>());
  out.lower(0) = o_.damper.Least((o_.force - size) / o_.stiffness, u.dot(at.twist.tail<3>())) -
                 u.dot(at.Jdot_v.tail<3>());
}

}  // namespace pliant
