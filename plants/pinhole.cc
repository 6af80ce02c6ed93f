#include "pliant/plants/pinhole.h"

#include <Eigen/Geometry>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr double kNoWay = 1e-6;  // [m], and of a sine: no direction to speak of

}  // namespace

Pose LookingAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& up) {
  Require(from.allFinite(), "the position of a camera must be three finite numbers",
          from.transpose());
  Require(to.allFinite(), "what a camera looks at must be three finite numbers", to.transpose());
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
