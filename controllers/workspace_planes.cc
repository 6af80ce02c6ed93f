#include "pliant/controllers/workspace_planes.h"

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

int Count(const WorkspacePlanes::Options& o) {
  const auto count = static_cast<int>(o.planes.size());
  Require(count >= 1 && count <= WorkspacePlanes::kMaxPlanes,
          "a frame has from 1 to " + Text(WorkspacePlanes::kMaxPlanes) + " planes", count);
  return count;
}

}  // namespace

WorkspacePlanes::WorkspacePlanes(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      distance{this, "distance", {}, TaskVector::Zero(Count(o))},
      rows{this, "rows", o.model.joints(),
           AccelerationRows::None(Count(o), o.model.size(), o.priority)},
      o_{o},
      link_{o.model.link_index(o.frame)},
      at_{this, "at", {}, PointDynamics(o.model, RobotDynamics(o.model), link_, {0, 0, 0})} {
  RequireInRange("", o);
  RequireEachInRange("point", o.point, "m", kAnyNumber);
  for (std::size_t i = 0; i < o.planes.size(); ++i) {
    const HalfSpace& plane = o.planes[i];
    const std::string name = "plane " + Text(i);
    RequireEachInRange(name + ": point", plane.point, "m", kAnyNumber);
    RequireEachInRange(name + ": normal", plane.normal, "", kAnyNumber);
    RequireInRange(name, "the length of normal", plane.normal.norm(), "", kPositive);
    normals_.push_back(plane.normal.normalized());
    offsets_.push_back(normals_.back().dot(plane.point));
  }
  Compute(at_).From(dynamics).As(&WorkspacePlanes::Find);
  Compute(distance).From(at_).As(&WorkspacePlanes::Measure);
  Compute(rows).From(at_, distance).As(&WorkspacePlanes::Limit);
}

FrameDynamics WorkspacePlanes::Find(const RobotDynamics& d) const {
  return PointDynamics(o_.model, d, link_, o_.point);
}

TaskVector WorkspacePlanes::Measure(const FrameDynamics& at) const {
  TaskVector e(static_cast<Eigen::Index>(normals_.size()));
  for (int i = 0; i < e.size(); ++i)
    e(i) = normals_[static_cast<std::size_t>(i)].dot(at.pose.position) -
           offsets_[static_cast<std::size_t>(i)];
  return e;
}

void WorkspacePlanes::Limit(AccelerationRows& out, const FrameDynamics& at,
                            const TaskVector& e) const {
  for (int i = 0; i < e.size(); ++i) {
    const Eigen::Vector3d& n = normals_[static_cast<std::size_t>(i)];
    out.A.row(i).noalias() = n.transpose().lazyProduct(at.J.bottomRows<3>());
    out.lower(i) = o_.damper.Least(e(i) - o_.safety_distance, n.dot(at.twist.tail<3>())) -
                   n.dot(at.Jdot_v.tail<3>());
  }
}

}  // namespace pliant
