// Distances of spheres, capsules, boxes and cylinders by FCL against ours.

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <memory>

#include "pliant/tests/plants/collision_scene.h"

namespace pliant {
namespace {

/// The same shape for both, and where it is.
struct Twin {
  Twin(RandomBodies& draw, int kind) {
    const double radius = draw.Uniform(0.02, 0.06), length = draw.Uniform(0.05, 0.3);
    const Eigen::Vector3d size{length, draw.Uniform(0.05, 0.3), draw.Uniform(0.05, 0.3)};
    Shape shape{
        .name = "", .kind = Shape::Kind::Sphere, .pose = Pose(), .size = {radius, length, 0}};
    switch (kind) {
      case 0:
        theirs = std::make_unique<fcl::Sphered>(radius);
        break;
      case 1:
        shape.kind = Shape::Kind::Capsule;
        theirs = std::make_unique<fcl::Capsuled>(radius, length);
        break;
      case 2:
        shape.kind = Shape::Kind::Box;
        shape.size = size;
        theirs = std::make_unique<fcl::Boxd>(size);
        break;
      default:
        shape.kind = Shape::Kind::Cylinder;
        theirs = std::make_unique<fcl::Cylinderd>(radius, length);
        // How far the corners of the prism stand out, at most: r (1/cos 15° − 1).
        outside = 0.0353 * radius;
    }
    ours = {CollisionShape::Of(shape), draw.Pose(0.3)};
    placement.linear() = ours.pose.rotation;
    placement.translation() = ours.pose.position;
  }

  PosedShape ours;
  std::unique_ptr<fcl::CollisionGeometryd> theirs;
  fcl::Transform3d placement = fcl::Transform3d::Identity();
  double outside = 0;
};

TEST(CollisionDistance, IsThatOfFclForShapesThatAreApart) {
  RandomBodies draw(17);
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = 1e-10;
  int apart = 0;
  for (int k = 0; k < 400; ++k) {
    const Twin a(draw, k % 4), b(draw, k / 4 % 4);
    const double e = Between(a.ours, b.ours).distance;
    if (e < 0.005) continue;
    ++apart;
    fcl::DistanceResultd result;
    const double theirs =
        fcl::distance(a.theirs.get(), a.placement, b.theirs.get(), b.placement, request, result);
    // FCL's search ends when its own estimate does not get better by the tolerance.
    EXPECT_LE(e, theirs + 1e-6) << k;
    EXPECT_GE(e, theirs - a.outside - b.outside - 1e-6) << k;
  }
  EXPECT_GT(apart, 200);
}

}  // namespace
}  // namespace pliant
