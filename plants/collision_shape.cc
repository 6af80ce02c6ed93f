#include "pliant/plants/collision_shape.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kSides = 12;  // of the prism around a cylinder

/// Adds a direction unless it, or its opposite, is there.
void AddDirection(const Vector3d& direction, std::vector<Vector3d>& all) {
  const auto same = [&](const Vector3d& other) { return other.cross(direction).norm() < 1e-7; };
  if (std::ranges::none_of(all, same)) all.push_back(direction);
}

/// How thick points are in the direction in which they are thinnest, relative to their size.
double Thickness(std::span<const Vector3d> points) {
  Eigen::Matrix3Xd all(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = points[i];
  all.colwise() -= all.rowwise().mean().eval();
  const Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3Xd>(all).singularValues();
  return singular(2) / singular(0);
}

/// A plane that all points lie in or on one side of, and which of them lie in it.
struct Face {
  Vector3d normal;
  std::vector<std::size_t> points;
};

std::vector<Face> FacesOf(const std::vector<Vector3d>& points, double tolerance) {
  std::vector<Face> faces;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vector3d across = (points[j] - points[i]).cross(points[k] - points[i]);
        if (across.norm() < tolerance * tolerance) continue;  // the three lie in a line
        Face face{across.normalized(), {}};
        double below = 0, above = 0;
        for (std::size_t l = 0; l < n; ++l) {
          const double height = face.normal.dot(points[l] - points[i]);
          below = std::min(below, height);
          above = std::max(above, height);
          if (std::abs(height) < tolerance) face.points.push_back(l);
        }
        const bool known =
            std::ranges::any_of(faces, [&](const Face& f) { return f.points == face.points; });
        if ((below > -tolerance || above < tolerance) && !known) faces.push_back(std::move(face));
      }
  return faces;
}

bool Holds(const Face& face, std::size_t point) {
  return std::ranges::find(face.points, point) != face.points.end();
}

}  // namespace

CollisionShape CollisionShape::Sphere(const Vector3d& center, double radius) {
  CollisionShape shape;
  shape.center = center;
  shape.radius = radius;
  return shape;
}

CollisionShape CollisionShape::Capsule(const Vector3d& a, const Vector3d& b, double radius) {
  CollisionShape shape = Sphere(0.5 * (a + b), radius);
  shape.half = 0.5 * (b - a);
  shape.extent = shape.half.norm();
  return shape;
}

CollisionShape CollisionShape::Box(const Pose& pose, const Vector3d& size) {
  std::vector<Vector3d> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.5, 0.5})
        corners.push_back(pose.position + pose.rotation * Vector3d(x, y, z).cwiseProduct(size));
  return Hull(corners);
}

CollisionShape CollisionShape::Hull(std::span<const Vector3d> points, double radius) {
  Require(points.size() >= 4 && points.size() <= kMaxPoints,
          "a hull has from 4 to " + Text(kMaxPoints) + " points", points.size());
  for (const Vector3d& p : points)
    Require(p.allFinite(), "the points of a hull must be finite", p.transpose());
  Require(Thickness(points) > 1e-6, "the points of a hull may not lie in a plane");

  CollisionShape shape;
  shape.radius = radius;
  Vector3d least = points[0], most = points[0];
  for (const Vector3d& p : points) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  shape.center = 0.5 * (least + most);

  std::vector<Vector3d> all;
  for (const Vector3d& p : points) all.push_back(p - shape.center);
  const std::vector<Face> faces = FacesOf(all, 1e-9 * (most - least).norm());
  for (const Face& face : faces) AddDirection(face.normal, shape.faces);
  for (std::size_t i = 0; i < all.size(); ++i) {
    // What lies in three planes is a corner; two of them meet in an edge.
    const auto in = [&](const Face& face) { return Holds(face, i); };
    if (std::ranges::count_if(faces, in) < 3) continue;
    shape.points.push_back(all[i]);
    shape.extent = std::max(shape.extent, all[i].norm());
    for (std::size_t k = 0; k < i; ++k) {
      const auto in_both = [&](const Face& face) { return Holds(face, i) && Holds(face, k); };
      if (std::ranges::count_if(faces, in_both) >= 2)
        AddDirection((all[i] - all[k]).normalized(), shape.edges);
    }
  }
  return shape;
}

CollisionShape CollisionShape::Of(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::Box:
      return Box(shape.pose, shape.size);
    case Shape::Kind::Sphere:
      return Sphere(shape.pose.position, shape.size.x());
    case Shape::Kind::Cylinder: {
      const double outer = shape.size.x() / std::cos(std::numbers::pi / kSides);
      std::vector<Vector3d> rims;
      for (int i = 0; i < kSides; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        for (const double z : {-0.5, 0.5})
          rims.push_back(shape.pose.position +
                         shape.pose.rotation * Vector3d(outer * std::cos(angle),
                                                        outer * std::sin(angle),
                                                        z * shape.size.y()));
      }
      return Hull(rims);
    }
    case Shape::Kind::Capsule:
      break;
  }
  const Vector3d half = 0.5 * shape.size.y() * shape.pose.rotation.col(2);
  return Capsule(shape.pose.position - half, shape.pose.position + half, shape.size.x());
}

CollisionShape CollisionShape::In(const Pose& X_AS) const {
  CollisionShape shape = *this;
  shape.center = X_AS.position + X_AS.rotation * center;
  shape.half = X_AS.rotation * half;
  for (auto* directions : {&shape.points, &shape.faces, &shape.edges})
    for (Vector3d& direction : *directions) direction = X_AS.rotation * direction;
  return shape;
}

}  // namespace pliant
