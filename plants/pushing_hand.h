#pragma once

#include <span>

#include "pliant/plants/robot_surface.h"

namespace pliant {

/// A hand that pushes, as a camera sees it: a ball that touches a link, and a forearm behind it.
///
/// A force acts along its line, wherever on it its point is. So the hand stands where the line of
/// the force F enters the link's surface, which is the point of the force if that lies on the
/// surface and is pushed inwards:
///
///   s = x + t F̂ with the least t,   ball about s + r n,   forearm from there along −F̂
///
/// n is the normal of the surface at s. Where the line passes the link by, s = x and n = −F̂.
///
/// A hand only pushes. One that pulls, with a force outwards at its point, is drawn where the same
/// force pushes: on the other side of the link.
struct PushingHand {
  Eigen::Vector3d touch;   ///< s
  Eigen::Vector3d center;  ///< of the ball
  Eigen::Vector3d elbow;   ///< the other end of the forearm
};

/// `placed` are the parts of the surface, `point` x, `force` F ≠ 0, all in one frame; r and the
/// forearm's length in metres.
PushingHand HandOf(const RobotSurface& surface, std::span<const Solid> placed, int link,
                   const Eigen::Vector3d& point, const Eigen::Vector3d& force, double radius,
                   double forearm);

}  // namespace pliant
