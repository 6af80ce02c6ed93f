#pragma once

#include <string>
#include <variant>
#include <vector>

#include "pliant/plants/collision_shape.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// What stands in the world and does not move, for links to keep clear of. `except` names links
/// that may come near it, such as the one beside which it stands.
struct SphereObstacle {
  static constexpr const char* kTag = "Sphere";

  std::string name;
  Eigen::Vector3d center = Eigen::Vector3d::Constant(kToBeGiven);  ///< [m]
  double radius = kToBeGiven;                                      ///< [m]
  std::vector<std::string> except = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("center", center, "m");
    f("radius", radius, "m", kPositive);
    f("except", except);
  }
  CollisionShape shape() const { return CollisionShape::Sphere(center, radius); }
};

/// All that is within `radius` of the segment from a to b.
struct CapsuleObstacle {
  static constexpr const char* kTag = "Capsule";

  std::string name;
  Eigen::Vector3d a = Eigen::Vector3d::Constant(kToBeGiven);  ///< [m]
  Eigen::Vector3d b = Eigen::Vector3d::Constant(kToBeGiven);  ///< [m]
  double radius = kToBeGiven;                                 ///< [m]
  std::vector<std::string> except = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("a", a, "m");
    f("b", b, "m");
    f("radius", radius, "m", kPositive);
    f("except", except);
  }
  CollisionShape shape() const { return CollisionShape::Capsule(a, b, radius); }
};

struct BoxObstacle {
  static constexpr const char* kTag = "Box";

  std::string name;
  Eigen::Vector3d center = Eigen::Vector3d::Constant(kToBeGiven);  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Constant(kToBeGiven);    ///< lengths of the edges [m]
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  ///< roll, pitch, yaw of its axes, as in URDF
  std::vector<std::string> except = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("center", center, "m");
    f("size", size, "m", kPositive);
    f("rpy", rpy, "rad");
    f("except", except);
  }
  CollisionShape shape() const;
};

/// The convex hull of points and all that is within `radius` of it.
struct HullObstacle {
  static constexpr const char* kTag = "Hull";

  std::string name;
  std::vector<Eigen::Vector3d> points = {};  ///< 4 to 32 that do not lie in a plane [m]
  double radius = 0;                         ///< [m]
  std::vector<std::string> except = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("points", points, "m");
    f("radius", radius, "m", kNotNegative);
    f("except", except);
  }
  CollisionShape shape() const { return CollisionShape::Hull(points, radius); }
};

/// In a scenario file:
///
///   obstacles:
///     - !Box {name: table, center: [0.5, 0, -0.02], size: [1, 1, 0.04]}
///     - !Sphere {name: head, center: [0, 0.8, 0.6], radius: 150 mm}
using Obstacle = std::variant<BoxObstacle, SphereObstacle, CapsuleObstacle, HullObstacle>;

const std::string& NameOf(const Obstacle& obstacle);
const std::vector<std::string>& ExceptedBy(const Obstacle& obstacle);

/// In the world. Throws "<name>: …" unless it is a body.
CollisionShape ShapeOf(const Obstacle& obstacle);

}  // namespace pliant
