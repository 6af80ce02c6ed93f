#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/plants/collision_shape.h"
#include "pliant/plants/pinhole.h"
#include "pliant/plants/robot_model.h"

namespace pliant {

/// A convex body as rays meet it, in closed form:
///
///   Round     all within `radius` of the segment c ± L a: sphere, capsule
///   Cylinder  about the same segment, with flat ends
///   Box       |Rᵀ(x − c)| ≤ size/2
///   Hull      low ≤ nᵀ x ≤ high for each slab
struct Solid {
  enum class Kind { Round, Cylinder, Box, Hull };
  struct Slab {
    Eigen::Vector3d normal;
    double low, high;
  };

  Kind kind = Kind::Round;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();        ///< c [m]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< R, a is its third column
  Eigen::Vector3d half = Eigen::Vector3d::Zero();          ///< size/2; L is the third number [m]
  double radius = 0;                                       ///< [m]
  std::vector<Slab> slabs;                                 ///< of a hull
  std::vector<Eigen::Vector3d> corners;                    ///< of a hull [m]

  Eigen::Vector3d axis() const { return rotation.col(2); }

  static Solid Of(const Shape& shape);
  /// Throws for a hull with a radius: rays do not meet its rounded edges in closed form.
  static Solid Of(const CollisionShape& shape);

  /// Writes the body as it is in another frame A, all its faces `margin` further out (corners and
  /// edges that are sharp stay so). The body written to was copied from this one. No heap.
  void Place(const Pose& X_AS, double margin, Solid& placed) const;
  void PlaceBall(const Eigen::Vector3d& at, double r);
  void PlaceCapsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double r);
};

/// The part of a line o + t d that is inside a body, from t = near to far; near > far: none.
struct Passage {
  double near = 1, far = -1;
  bool empty() const { return near > far; }
};
Passage Pierce(const Solid& solid, const Eigen::Vector3d& o, const Eigen::Vector3d& d);

/// The point of a surface that is nearest to x.
struct SurfacePoint {
  double distance = 0;     ///< below zero inside [m]
  Eigen::Vector3d point;   ///< [m]
  Eigen::Vector3d normal;  ///< outwards, of length 1; point = x − distance normal
};
/// Of a hull: as if only its farthest face were there.
SurfacePoint NearestOn(const Solid& solid, const Eigen::Vector3d& x);

/// Pixels from (left, top) up to, and without, (right, bottom).
struct PixelRange {
  int left = 0, top = 0, right = 0, bottom = 0;
};
/// Pixels outside do not see the body, given in the camera's frame.
PixelRange PixelsOf(const Solid& solid, const Pinhole& view);

}  // namespace pliant
