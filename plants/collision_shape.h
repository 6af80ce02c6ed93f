#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "pliant/plants/robot_model.h"

namespace pliant {

/// A convex body: a core and all that is within `radius` of it.
///
///   core           body
///   a point        sphere
///   a segment      capsule
///   a polytope     box, hull of points; sharp where the radius is zero
///
/// The core of a cylinder is a prism of 12 sides around it: flat ends as they are, edges up to
/// 1/cos 15° − 1 = 3.5 % of the cylinder's radius further out.
struct CollisionShape {
  static constexpr int kMaxPoints = 32;  ///< of a core

  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the core, in the frame of the shape [m]
  Eigen::Vector3d half = Eigen::Vector3d::Zero();    ///< from the centre to an end of a segment [m]
  double radius = 0;                                 ///< [m]
  double extent = 0;  ///< R, of the sphere about the centre that holds the core [m]

  /// Of a polytope only: its points, about the centre [m], and the directions of its faces and
  /// edges, each once up to its sign, of length 1.
  std::vector<Eigen::Vector3d> points, faces, edges;

  bool is_polytope() const { return !points.empty(); }

  static CollisionShape Sphere(const Eigen::Vector3d& center, double radius);
  /// Around the segment from a to b.
  static CollisionShape Capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);
  /// `size`: lengths of the edges, along the axes of the pose.
  static CollisionShape Box(const Pose& pose, const Eigen::Vector3d& size);
  /// Of 4 to kMaxPoints points that do not lie in a plane; those inside are left out.
  static CollisionShape Hull(std::span<const Eigen::Vector3d> points, double radius = 0);
  /// Of a link.
  static CollisionShape Of(const Shape& shape);

  /// The same body in another frame A, with X_AS the pose of this one's.
  CollisionShape In(const Pose& X_AS) const;
};

}  // namespace pliant
