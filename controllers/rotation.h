#pragma once

#include <Eigen/Geometry>

namespace pliant::internal {

/// log of a rotation as a vector: the axis times the angle.
inline Eigen::Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

}  // namespace pliant::internal
