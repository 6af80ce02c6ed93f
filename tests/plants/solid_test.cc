#include "pliant/plants/solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/tests/plants/collision_scene.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// A link's shape of each kind, and a hull.
Solid Draw(RandomBodies& draw, int kind) {
  if (kind == 4) {
    std::vector<Vector3d> points(12);
    for (Vector3d& p : points) p = draw.Vector(0.1);
    return Solid::Of(CollisionShape::Hull(points));
  }
  constexpr Shape::Kind kKinds[] = {Shape::Kind::Sphere, Shape::Kind::Capsule,
                                    Shape::Kind::Cylinder, Shape::Kind::Box};
  Shape shape{.name = "", .kind = kKinds[kind], .pose = draw.Pose(0.1), .size = Vector3d::Zero()};
  shape.size = {draw.Uniform(0.02, 0.06), draw.Uniform(0.05, 0.2), draw.Uniform(0.02, 0.2)};
  return Solid::Of(shape);
}

/// Of a body's surface; below zero inside.
double Height(const Solid& s, const Vector3d& x) { return NearestOn(s, x).distance; }

TEST(Solid, IsPiercedWhereClosedFormsSay) {
  // A ball of radius r, passed at b beside its centre: t = z ∓ √(r² − b²).
  const Solid ball =
      Solid::Of(Shape{.name = "", .kind = Shape::Kind::Sphere, .pose = {}, .size = {0.5, 0, 0}});
  for (const double b : {0.0, 0.2, 0.4, 0.499}) {
    const Passage in = Pierce(ball, {b, 0, -3}, {0, 0, 1});
    EXPECT_NEAR(in.near, 3 - std::sqrt(0.25 - b * b), 1e-14);
    EXPECT_NEAR(in.far, 3 + std::sqrt(0.25 - b * b), 1e-14);
  }
  EXPECT_TRUE(Pierce(ball, {0.501, 0, -3}, {0, 0, 1}).empty());

  // A capsule and a cylinder along z, seen along its axis, across, and askew at 45°.
  Shape rod{.name = "", .kind = Shape::Kind::Capsule, .pose = {}, .size = {0.1, 0.6, 0}};
  const Solid capsule = Solid::Of(rod);
  rod.kind = Shape::Kind::Cylinder;
  const Solid cylinder = Solid::Of(rod);
  EXPECT_NEAR(Pierce(capsule, {0.06, 0, -2}, {0, 0, 2}).near, (2 - 0.3 - 0.08) / 2, 1e-14);
  EXPECT_NEAR(Pierce(capsule, {0.06, 0, -2}, {0, 0, -2}).far, -(2 - 0.3 - 0.08) / 2, 1e-14);
  EXPECT_NEAR(Pierce(cylinder, {0.06, 0, -2}, {0, 0, 2}).near, (2 - 0.3) / 2, 1e-14);
  EXPECT_NEAR(Pierce(cylinder, {0.06, -1, 0.1}, {0, 1, 0}).near, 1 - 0.08, 1e-14);
  EXPECT_NEAR(Pierce(capsule, {0.06, -1, 0.1}, {0, 1, 0}).far, 1 + 0.08, 1e-14);
  // The line z = y + 0.3 meets the end ball about (0, 0, 0.3) through its middle, and the flat end
  // z = 0.3 at y = 0.
  EXPECT_NEAR(Pierce(capsule, {0, -1, -0.7}, {0, 1, 1}).far, 1 + 0.1 / std::numbers::sqrt2, 1e-14);
  EXPECT_NEAR(Pierce(cylinder, {0, -1, -0.7}, {0, 1, 1}).far, 1, 1e-14);
  EXPECT_NEAR(Pierce(cylinder, {0, -1, -0.7}, {0, 1, 1}).near, 0.9, 1e-14);
  EXPECT_TRUE(Pierce(cylinder, {0, -1, -0.59}, {0, 1, 1}).empty());

  const Solid box =
      Solid::Of(Shape{.name = "", .kind = Shape::Kind::Box, .pose = {}, .size = {0.2, 0.4, 0.6}});
  EXPECT_NEAR(Pierce(box, {-1, 0, 0}, {1, 0, 0}).near, 0.9, 1e-14);
  // Enters where y = −0.2, leaves where x = 0.1.
  const Passage askew = Pierce(box, {-0.35, -0.45, 0}, {1, 1, 0});
  EXPECT_NEAR(askew.near, 0.25, 1e-14);
  EXPECT_NEAR(askew.far, 0.45, 1e-14);
}

TEST(Solid, IsPiercedBetweenTwoPointsOfItsSurfaceAndNowhereElse) {
  RandomBodies draw(3);
  int hits = 0;
  for (int k = 0; k < 5000; ++k) {
    const Solid s = Draw(draw, k % 5);
    const Vector3d o = 2 * draw.Vector(1), d = (s.center + draw.Vector(0.12) - o) / 2;
    const Passage in = Pierce(s, o, d);
    if (in.empty()) {
      for (double t = 0; t < 4; t += 0.01) EXPECT_GT(Height(s, o + t * d), 0) << k;
      continue;
    }
    ++hits;
    // Two roots of a square at 2 m: round-off 1e-16 · 2 m, times 1/cos of a flat angle.
    EXPECT_NEAR(Height(s, o + in.near * d), 0, 1e-9) << k;
    EXPECT_NEAR(Height(s, o + in.far * d), 0, 1e-9) << k;
    for (const double part : {0.01, 0.5, 0.99})
      EXPECT_LE(Height(s, o + (in.near + part * (in.far - in.near)) * d), 1e-12) << k;
    for (const double out : {0.01, 0.3}) {
      EXPECT_GT(Height(s, o + (in.near - out) * d), 0) << k;
      EXPECT_GT(Height(s, o + (in.far + out) * d), 0) << k;
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(Solid, HasItsNearestPointOnItsSurfaceAlongTheNormal) {
  RandomBodies draw(4);
  for (int k = 0; k < 2000; ++k) {
    const Solid s = Draw(draw, k % 4);
    const Vector3d x = s.center + draw.Vector(0.4);
    const SurfacePoint on = NearestOn(s, x);
    EXPECT_NEAR(on.normal.norm(), 1, 1e-12);
    EXPECT_LT((on.point - (x - on.distance * on.normal)).norm(), 1e-14);
    EXPECT_NEAR(Height(s, on.point), 0, 1e-12);
    // No point of the surface is nearer: those that lines through x meet are not.
    for (int i = 0; i < 20; ++i) {
      const Vector3d d = draw.Vector(1).normalized();
      const Passage in = Pierce(s, x, d);
      if (in.empty()) continue;
      EXPECT_GE(std::min(std::abs(in.near), std::abs(in.far)), std::abs(on.distance) - 1e-9) << k;
    }
  }
}

TEST(Solid, GrownByAMarginHasItsSurfaceThatMuchFurtherOut) {
  RandomBodies draw(5);
  for (int k = 0; k < 400; ++k) {
    const Solid s = Draw(draw, k % 4);
    Solid grown = s;
    const Pose X = draw.Pose(0.5);
    s.Place(X, 0.02, grown);
    const Vector3d x = s.center + draw.Vector(0.4);
    const SurfacePoint on = NearestOn(s, x);
    // Not so beyond the edges of boxes and cylinders, which stay sharp.
    const Vector3d out = X.position + X.rotation * (on.point + 0.02 * on.normal);
    if (k % 4 < 2)
      EXPECT_NEAR(Height(grown, out), 0, 1e-12);
    else
      EXPECT_LE(Height(grown, out), 1e-12);
  }
}

TEST(Solid, IsSeenByNoPixelOutsideItsRange) {
  RandomBodies draw(6);
  Pinhole view{.width = 160, .height = 120, .focal = 140, .pose = {}};
  int seen = 0;
  for (int k = 0; k < 300; ++k) {
    Solid s = Draw(draw, k % 5);
    const Solid there = s;
    there.Place({Vector3d(0, 0, 0.4) + draw.Vector(0.6), draw.Rotation()}, 0, s);
    const PixelRange range = PixelsOf(s, view);
    for (int row = 0; row < view.height; ++row)
      for (int column = 0; column < view.width; ++column) {
        const Passage in = Pierce(s, Vector3d::Zero(), view.Ray(column, row));
        if (in.empty() || in.near <= 0) continue;
        ++seen;
        EXPECT_TRUE(column >= range.left && column < range.right && row >= range.top &&
                    row < range.bottom)
            << k << ": " << column << ", " << row;
      }
  }
  EXPECT_GT(seen, 10'000);
}

TEST(Solid, OfABallHasTheTightestRange) {
  const Pinhole view{.width = 640, .height = 480, .focal = 500, .pose = {}};
  Solid s;
  s.PlaceBall({0.5, 0, 2}, 0.1);
  // Tangents at asin(0.1/√4.25) about atan(0.5/2); pixels whose middle lies between them, and at
  // most one more on each side.
  const double middle = std::atan(0.25), half = std::asin(0.1 / std::sqrt(4.25));
  const PixelRange range = PixelsOf(s, view);
  EXPECT_EQ(range.left, std::floor(319.5 + 500 * std::tan(middle - half)));
  EXPECT_EQ(range.right, std::ceil(319.5 + 500 * std::tan(middle + half)) + 1);
}

TEST(Solid, RefusesAHullWithRoundedEdges) {
  const std::vector<Vector3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(ErrorOf([&] { Solid::Of(CollisionShape::Hull(points, 0.01)); }),
            "a depth camera sees hulls with sharp edges: their radius must be 0, got 0.01");
}

}  // namespace
}  // namespace pliant
