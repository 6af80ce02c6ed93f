#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>
#include <vector>

#include "pliant/plants/collision_distance.h"

namespace pliant {

/// Shapes and poses, drawn from a seed.
struct RandomBodies {
  explicit RandomBodies(unsigned seed) : random{seed} {}

  double Uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  }
  Eigen::Vector3d Vector(double largest) {
    return {Uniform(-largest, largest), Uniform(-largest, largest), Uniform(-largest, largest)};
  }
  Eigen::Matrix3d Rotation() {
    std::normal_distribution<double> normal;
    Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    return q.normalized().toRotationMatrix();
  }
  pliant::Pose Pose(double largest) { return {Vector(largest), Rotation()}; }

  /// A sphere, a capsule, a box, a hull or a cylinder, some 0.2 m large.
  CollisionShape Shape(int kind) {
    const double radius = Uniform(0.02, 0.06);
    switch (kind % 5) {
      case 0:
        return CollisionShape::Sphere(Vector(0.1), radius);
      case 1:
        return CollisionShape::Capsule(Vector(0.1), Vector(0.1), radius);
      case 2:
        return CollisionShape::Box(Pose(0.05),
                                   {Uniform(0.02, 0.2), Uniform(0.02, 0.2), Uniform(0.02, 0.2)});
      case 3: {
        std::vector<Eigen::Vector3d> points(4 + random() % 20);
        for (Eigen::Vector3d& p : points) p = Vector(0.1);
        return CollisionShape::Hull(points, random() % 2 ? radius : 0);
      }
      default:
        return CollisionShape::Of({.name = "",
                                   .kind = Shape::Kind::Cylinder,
                                   .pose = Pose(0.05),
                                   .size = {radius, Uniform(0.05, 0.2), 0}});
    }
  }
  static constexpr int kKinds = 5;

  std::mt19937 random;
};

/// A shape that is somewhere.
struct PosedShape {
  CollisionShape shape;
  Pose pose;
  PlacedShape placed() const { return {shape, pose.rotation, pose.position}; }
};

inline Proximity Between(const PosedShape& a, const PosedShape& b, double softening = 0) {
  return Closest(a.placed(), b.placed(), softening);
}

/// The points of a core, in the world.
inline std::vector<Eigen::Vector3d> CorePoints(const PosedShape& body) {
  std::vector<Eigen::Vector3d> all = body.shape.points;
  if (!body.shape.is_polytope()) all = {body.shape.half, -body.shape.half};
  for (Eigen::Vector3d& p : all)
    p = body.pose.position + body.pose.rotation * (body.shape.center + p);
  return all;
}

}  // namespace pliant
