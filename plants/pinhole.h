#pragma once

#include <Eigen/Core>

#include "pliant/systems/parameter.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// A camera without distortion, its frame C with x to the right, y down and z forward:
///
///   u = f x/z + c_x,   v = f y/z + c_y
///
/// c is the middle of the picture. Pixel (column, row) is the square of side 1 about (u, v), so the
/// first one is (0, 0) and c = ((width − 1)/2, (height − 1)/2).
///
/// Defaults: the depth picture of a Kinect, f as the drivers of ROS have it without a calibration.
struct Pinhole {
  int width = 640, height = 480;  ///< [px]
  double focal = 575.8;           ///< f [px]
  Pose pose;                      ///< X_WC

  template <class F>
  void Parameters(F&& f) {
    f("width", width, "px", Between(1, 4096));
    f("height", height, "px", Between(1, 4096));
    f("focal", focal, "px", kPositive);
  }

  int pixels() const { return width * height; }

  /// d in C with z = 1: what a pixel sees at depth z is at z d.
  Eigen::Vector3d Ray(int column, int row) const {
    return {(column - 0.5 * (width - 1)) / focal, (row - 0.5 * (height - 1)) / focal, 1};
  }
  /// (u, v) of a point in C with z > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& x) const {
    return {focal * x.x() / x.z() + 0.5 * (width - 1), focal * x.y() / x.z() + 0.5 * (height - 1)};
  }
};

/// X_WC of a camera at `from` that has `to` in the middle of its picture and `up` upwards in it.
/// Where it looks along `up`, that says nothing, and the axis of the world most across its line of
/// sight is upwards instead: x of a camera that looks straight down. Throws if `to` is at `from`.
Pose LookingAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
               const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

}  // namespace pliant
