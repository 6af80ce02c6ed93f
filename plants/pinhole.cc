#include "pliant/plants/pinhole.h"

#include <Eigen/Geometry>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr double kNoWay = 1e-6;  // [m], and of a sine: no direction to speak of

void RequireFinite(const Eigen::Vector3d& p, const std::string& what) {
  Require(p.allFinite(), what + " must be three finite numbers",
          Text(p.x()) + " " + Text(p.y()) + " " + Text(p.z()));
}

}  // namespace

Pose LookingAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& up) {
  RequireFinite(from, "the position of a camera");
  RequireFinite(to, "what a camera looks at");
  Require((to - from).norm() > kNoWay, "a camera looks at a point away from it", to.transpose());
  const Eigen::Vector3d forward = (to - from).normalized();
  Eigen::Vector3d right = forward.cross(up.normalized());
  if (!(right.norm() > kNoWay)) {
    int across = 0;
    forward.cwiseAbs().minCoeff(&across);
    right = forward.cross(Eigen::Vector3d::Unit(across));
  }
  Pose X;
  X.position = from;
  X.rotation.col(0) = right.normalized();
  X.rotation.col(1) = forward.cross(X.rotation.col(0));
  X.rotation.col(2) = forward;
  return X;
}

}  // namespace pliant
