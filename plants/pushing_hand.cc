#include "pliant/plants/pushing_hand.h"

#include <limits>

namespace pliant {

PushingHand HandOf(const RobotSurface& surface, std::span<const Solid> placed, int link,
                   const Eigen::Vector3d& point, const Eigen::Vector3d& force, double radius,
                   double forearm) {
  const Eigen::Vector3d along = force.normalized();
  double enters = std::numeric_limits<double>::infinity();
  std::size_t part = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (surface.parts()[i].link != link) continue;
    const Passage in = Pierce(placed[i], point, along);
    if (in.empty() || in.near >= enters) continue;
    enters = in.near;
    part = i;
  }
  PushingHand hand{point, point, point};
  Eigen::Vector3d normal = -along;
  if (enters < std::numeric_limits<double>::infinity()) {
    hand.touch = point + enters * along;
    normal = NearestOn(placed[part], hand.touch).normal;
  }
  hand.center = hand.touch + radius * normal;
  hand.elbow = hand.center - forearm * along;
  return hand;
}

}  // namespace pliant
