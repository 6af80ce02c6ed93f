// Lines through spheres, capsules, cylinders and boxes, and distances from points, by FCL.

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <gtest/gtest.h>

#include <memory>

#include "pliant/plants/solid.h"
#include "pliant/tests/plants/collision_scene.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

struct Twin {
  Twin(RandomBodies& draw, int kind) {
    Shape shape{.name = "", .kind = Shape::Kind::Sphere, .pose = draw.Pose(0.3), .size = {}};
    const double radius = draw.Uniform(0.02, 0.06), length = draw.Uniform(0.05, 0.3);
    shape.size = {radius, length, draw.Uniform(0.05, 0.3)};
    if (kind == 0) theirs = std::make_unique<fcl::Sphered>(radius);
    if (kind == 1) theirs = std::make_unique<fcl::Capsuled>(radius, length);
    if (kind == 2) theirs = std::make_unique<fcl::Cylinderd>(radius, length);
    if (kind == 3) theirs = std::make_unique<fcl::Boxd>(shape.size);
    constexpr Shape::Kind kKinds[] = {Shape::Kind::Sphere, Shape::Kind::Capsule,
                                      Shape::Kind::Cylinder, Shape::Kind::Box};
    shape.kind = kKinds[kind];
    ours = Solid::Of(shape);
    placement.linear() = shape.pose.rotation;
    placement.translation() = shape.pose.position;
  }

  Solid ours;
  std::unique_ptr<fcl::CollisionGeometryd> theirs;
  fcl::Transform3d placement = fcl::Transform3d::Identity();
};

constexpr double kThin = 1e-5;  // [m] radius of a line and of a point

/// Whether FCL finds a thin rod from a to b in touch with the body.
bool Touches(const Twin& twin, const Vector3d& a, const Vector3d& b) {
  const fcl::Capsuled rod(kThin, (b - a).norm());
  fcl::Transform3d placement = fcl::Transform3d::Identity();
  placement.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), b - a).toRotationMatrix();
  placement.translation() = 0.5 * (a + b);
  fcl::CollisionRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  return fcl::collide(twin.theirs.get(), twin.placement, &rod, placement, request, result) > 0;
}

TEST(Solid, IsPiercedWhereFclFindsARodInTouch) {
  RandomBodies draw(8);
  int hits = 0, misses = 0;
  for (int k = 0; k < 2000; ++k) {
    const Twin twin(draw, k % 4);
    const Vector3d o = draw.Vector(1), d = twin.ours.center + draw.Vector(0.15) - o;
    const Passage in = Pierce(twin.ours, o, d);
    const double tell = 1e-3;
    const auto apart = [&](double t) { return NearestOn(twin.ours, o + t * d).distance > 3e-4; };
    if (in.empty()) {
      double least = 1;
      for (double t = 0; t < 2; t += 1e-3)
        least = std::min(least, NearestOn(twin.ours, o + t * d).distance);
      if (least < 1e-3) continue;
      ++misses;
      EXPECT_FALSE(Touches(twin, o, o + 2 * d)) << k;
    } else if (in.far - in.near > 3 * tell && in.near > tell) {
      // Nothing is claimed of a line that leaves at an angle too flat for FCL to tell.
      if (!apart(in.near - tell) || !apart(in.far + tell)) continue;
      ++hits;
      EXPECT_FALSE(Touches(twin, o, o + (in.near - tell) * d)) << k;
      EXPECT_TRUE(Touches(twin, o, o + (in.near + tell) * d)) << k;
      EXPECT_FALSE(Touches(twin, o + (in.far + tell) * d, o + 3 * d)) << k;
      EXPECT_TRUE(Touches(twin, o + (in.far - tell) * d, o + 3 * d)) << k;
    }
  }
  EXPECT_GT(hits, 250);
  EXPECT_GT(misses, 300);
}

TEST(Solid, IsAsFarFromAPointAsFclSays) {
  RandomBodies draw(9);
  fcl::DistanceRequestd request;
  request.gjk_solver_type = fcl::GST_LIBCCD;
  request.distance_tolerance = 1e-10;
  const fcl::Sphered point(kThin);
  int outside = 0;
  for (int k = 0; k < 1000; ++k) {
    const Twin twin(draw, k % 4);
    const Vector3d x = twin.ours.center + draw.Vector(0.5);
    const double distance = NearestOn(twin.ours, x).distance;
    if (distance < 0.01) continue;
    ++outside;
    fcl::Transform3d placement = fcl::Transform3d::Identity();
    placement.translation() = x;
    fcl::DistanceResultd result;
    const double theirs =
        fcl::distance(twin.theirs.get(), twin.placement, &point, placement, request, result);
    // FCL's search ends when its own estimate does not get better by the tolerance.
    EXPECT_NEAR(distance, theirs + kThin, 1e-6) << k;
  }
  EXPECT_GT(outside, 500);
}

}  // namespace
}  // namespace pliant
