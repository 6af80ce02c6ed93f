#include "pliant/plants/pinhole.h"

#include <Eigen/Geometry>

#include "pliant/systems/error.h"

namespace pliant {

Pose LookingAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (to - from).normalized();
  const Eigen::Vector3d right = forward.cross(up.normalized());
  Require((to - from).norm() > 1e-6, "a camera looks at a point away from it", to.transpose());
  Require(right.norm() > 1e-6,
          "a camera does not look straight along `up`; name another direction for it",
          up.transpose());
  Pose X;
  X.position = from;
  X.rotation.col(0) = right.normalized();
  X.rotation.col(1) = forward.cross(X.rotation.col(0));
  X.rotation.col(2) = forward;
  return X;
}

}  // namespace pliant
