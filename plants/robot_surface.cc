#include "pliant/plants/robot_surface.h"

#include <limits>

#include "pliant/systems/error.h"

namespace pliant {

RobotSurface::RobotSurface(const RobotModel& model) {
  for (int i = 0; i < std::ssize(model.links()); ++i) {
    const Link& link = model.link(i);
    for (const Shape& shape : link.collisions) {
      const Solid solid = Solid::Of(shape);
      Part part{i, link.body, solid};
      solid.Place(link.pose, 0, part.solid);
      parts_.push_back(std::move(part));
    }
  }
  Require(!parts_.empty(), "the robot '" + model.name() +
                               "' has no collision shapes, so it has no surface; give its links "
                               "<collision> elements");
}

std::vector<Solid> RobotSurface::Solids() const {
  std::vector<Solid> solids;
  for (const Part& part : parts_) solids.push_back(part.solid);
  return solids;
}

void RobotSurface::Place(const RobotDynamics& d, const Pose& X_WC, double margin,
                         std::span<Solid> placed) const {
  const Pose X_CW = X_WC.inverse();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Pose X_WB;
    if (parts_[i].body >= 0) {
      const BodyMotion& body = d.body[static_cast<std::size_t>(parts_[i].body)];
      X_WB.position = body.position;
      X_WB.rotation = body.rotation;
    }
    parts_[i].solid.Place(X_CW * X_WB, margin, placed[i]);
  }
}

SurfacePoint RobotSurface::NearestOnLink(int link, std::span<const Solid> placed,
                                         const Eigen::Vector3d& x) const {
  SurfacePoint nearest{std::numeric_limits<double>::infinity(), x, Eigen::Vector3d::UnitZ()};
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].link != link) continue;
    const SurfacePoint on = NearestOn(placed[i], x);
    if (on.distance < nearest.distance) nearest = on;
  }
  return nearest;
}

}  // namespace pliant
