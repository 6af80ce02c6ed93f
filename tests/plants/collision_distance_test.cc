#include "pliant/plants/collision_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/tests/plants/collision_scene.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSoftening = 5e-4;

PosedShape Capsule(const Vector3d& center, const Vector3d& half, double radius) {
  return {CollisionShape::Capsule(center - half, center + half, radius), Pose()};
}
PosedShape Sphere(const Vector3d& center, double radius) {
  return {CollisionShape::Sphere(center, radius), Pose()};
}
PosedShape Box(const Vector3d& center, const Vector3d& size, const Matrix3d& R) {
  return {CollisionShape::Box({center, R}, size), Pose()};
}

TEST(CollisionDistance, OfSpheresIsThatOfTheirCentresLessTheirRadii) {
  const Proximity p = Between(Sphere({1, 2, 3}, 0.2), Sphere({1, 2, 5}, 0.3), kSoftening);
  EXPECT_NEAR(p.distance, 1.5, 1e-15);
  EXPECT_EQ(p.normal, Vector3d(0, 0, -1)) << "from b to a";
  EXPECT_EQ(p.a, Vector3d(1, 2, 3));
  EXPECT_EQ(p.b, Vector3d(1, 2, 5));
}

TEST(CollisionDistance, OfASphereAndACapsuleHasThreeCases) {
  const PosedShape capsule = Capsule({0, 0, 0}, {0, 0, 1}, 0.1);
  const double e = 2 - 0.1 - 0.2;
  EXPECT_NEAR(Between(Sphere({2, 0, 0.7}, 0.2), capsule, kSoftening).distance, e, 1e-15) << "side";
  EXPECT_NEAR(Between(Sphere({0, 0, 3}, 0.2), capsule, kSoftening).distance, e, 1e-15) << "end";
  EXPECT_NEAR(Between(Sphere({0, 0, -3}, 0.2), capsule, kSoftening).distance, e, 1e-15) << "end";
}

TEST(CollisionDistance, OfSkewCapsulesIsThatOfTheirAxes) {
  RandomBodies draw(1);
  for (int k = 0; k < 1000; ++k) {
    const Vector3d u = draw.Vector(1).normalized(), v = draw.Vector(1).normalized();
    const Vector3d n = u.cross(v).normalized();
    const double d = draw.Uniform(0.01, 2);
    const Vector3d x = draw.Vector(1);
    // Their common normal meets both between their ends.
    const PosedShape a = Capsule(x + d * n + draw.Uniform(-0.5, 0.5) * u, 0.6 * u, 0.02);
    const PosedShape b = Capsule(x + draw.Uniform(-0.5, 0.5) * v, 0.6 * v, 0.03);
    const Proximity p = Between(a, b);
    EXPECT_NEAR(p.distance, d - 0.05, 1e-14);
    EXPECT_LT((p.normal - n).norm(), 1e-12 / (d * u.cross(v).norm()));
  }
}

TEST(CollisionDistance, OfABoxAndASphereIsThatOfTheNearestFaceEdgeOrCorner) {
  const PosedShape box = Box({0, 0, 0}, {2, 4, 6}, Matrix3d::Identity());
  const double r = 0.1;
  EXPECT_NEAR(Between(Sphere({1.5, 0.3, -2}, r), box).distance, 0.5 - r, 1e-14);
  EXPECT_NEAR(Between(Sphere({1.3, 2.4, -2}, r), box).distance, 0.5 - r, 1e-14);
  EXPECT_NEAR(Between(Sphere({1.2, 2.3, 3.6}, r), box).distance, 0.7 - r, 1e-14);
  // Inside, the nearest face is the way out.
  const Proximity inside = Between(Sphere({0.4, 0.3, -2}, r), box);
  EXPECT_NEAR(inside.distance, -0.6 - r, 1e-14);
  EXPECT_LT((inside.normal - Vector3d::UnitX()).norm(), 1e-15);
}

TEST(CollisionDistance, OfBoxesIsTheirDepthWhereTheyOverlap) {
  const PosedShape a = Box({0, 0, 0.9}, {1, 1, 1}, Matrix3d::Identity());
  const PosedShape b = Box({0.1, 0.2, 0}, {1, 1, 1}, Matrix3d::Identity());
  const Proximity faces = Between(a, b);
  EXPECT_NEAR(faces.distance, -0.1, 1e-14);
  EXPECT_LT((faces.normal - Vector3d::UnitZ()).norm(), 1e-15);

  // Two edges cross at right angles, ε deep.
  const double eps = 0.02, root = std::sqrt(0.5);
  const Matrix3d on_x = AngleAxisd(std::numbers::pi / 4, Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d on_y = AngleAxisd(std::numbers::pi / 4, Vector3d::UnitY()).toRotationMatrix();
  const Proximity edges =
      Between(Box({0, 0, 2 * root - eps}, {1, 1, 1}, on_x), Box({0, 0, 0}, {1, 1, 1}, on_y));
  EXPECT_NEAR(edges.distance, -eps, 1e-14);
  EXPECT_LT((edges.normal - Vector3d::UnitZ()).norm(), 1e-14);
}

TEST(CollisionDistance, IsPartedByItsDepthAlongItsNormal) {
  RandomBodies draw(5);
  int deep = 0;
  for (int k = 0; k < 2000; ++k) {
    PosedShape a{draw.Shape(k), draw.Pose(0.06)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.06)};
    const Proximity p = Between(a, b);
    EXPECT_NEAR(p.normal.norm(), 1, 1e-12);
    if (p.distance > 0) continue;
    ++deep;
    // After it they touch; nothing shorter parts them.
    const Vector3d start = a.pose.position;
    a.pose.position = start - p.distance * p.normal;
    EXPECT_NEAR(Between(a, b).distance, 0, 3e-7) << k;  // cores within 1e-7 m are taken to touch
    for (int way = 0; way < 20; ++way) {
      const Vector3d n = draw.Vector(1).normalized();
      a.pose.position = start - 0.999 * p.distance * n;
      EXPECT_LT(Between(a, b).distance, 0) << k;
    }
  }
  EXPECT_GT(deep, 1000);
}

TEST(CollisionDistance, OfCapsulesGoesOnThroughTheCrossingOfTheirAxes) {
  const PosedShape b = Capsule({0, 0, 0}, {0.5, 0, 0}, 0.05);
  for (const double z : {0.3, 0.05, 1e-6, 1e-12, 0.0}) {
    const Proximity p = Between(Capsule({0.1, 0.1, z}, {0, 0.5, 0}, 0.05), b);
    EXPECT_NEAR(p.distance, z - 0.1, 1e-16);
    // To the side of a's centre, where it is on one; a difference of 1e-17 m turns n.
    EXPECT_LT(
        (p.normal.z() < 0 && z > 0 ? Vector3d(1, 1, 1) : p.normal.cross(Vector3d::UnitZ())).norm(),
        1e-10);
  }
  // Nothing at all tells a direction.
  const Proximity same = Between(Sphere({1, 1, 1}, 0.1), Sphere({1, 1, 1}, 0.2));
  EXPECT_NEAR(same.distance, -0.3, 1e-16);
  EXPECT_EQ(same.normal.norm(), 1);
}

TEST(CollisionDistance, IsTheSameFromBothSides) {
  RandomBodies draw(7);
  for (int k = 0; k < 3000; ++k) {
    const PosedShape a{draw.Shape(k), draw.Pose(0.15)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.15)};
    for (const double softening : {0.0, kSoftening}) {
      const Proximity p = Between(a, b, softening), q = Between(b, a, softening);
      EXPECT_NEAR(p.distance, q.distance, 1e-10) << k;
      if (p.distance + a.shape.radius + b.shape.radius < 1e-3) continue;
      EXPECT_LT((p.normal + q.normal).norm(), 1e-6) << k;
    }
  }
}

TEST(CollisionDistance, DoesNotChangeWhenAllMovesTogether) {
  RandomBodies draw(8);
  for (int k = 0; k < 3000; ++k) {
    PosedShape a{draw.Shape(k), draw.Pose(0.15)};
    PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.15)};
    const Proximity before = Between(a, b, kSoftening);
    const Pose X = draw.Pose(1);
    a.pose = X * a.pose;
    b.pose = X * b.pose;
    const Proximity after = Between(a, b, kSoftening);
    EXPECT_NEAR(after.distance, before.distance, 1e-10) << k;
    if (before.distance + a.shape.radius + b.shape.radius < 1e-3) continue;
    EXPECT_LT((after.normal - X.rotation * before.normal).norm(), 1e-6) << k;
  }
}

TEST(CollisionDistance, SoftenedIsNeverMoreThanTheTrueOneAndLittleLess) {
  RandomBodies draw(9);
  for (int k = 0; k < 5000; ++k) {
    const PosedShape a{draw.Shape(k), draw.Pose(0.15)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.15)};
    const double d = Between(a, b).distance;
    for (const double softening : {1e-5, kSoftening, 5e-3}) {
      const double e = Between(a, b, softening).distance;
      EXPECT_LE(e, d + 1e-10) << k;
      EXPECT_GE(e, d - softening - 1e-10) << k;
    }
  }
}

TEST(CollisionDistance, SoftenedTakesTheMiddleOfWhatIsParallel) {
  // Two capsules side by side, two boxes face to face: x at the centres, e = d − δ.
  const Proximity capsules = Between(Capsule({0, 0, 0.2}, {0.1, 0, 0}, 0.05),
                                     Capsule({0, 0, 0}, {-0.3, 0, 0}, 0.05), kSoftening);
  EXPECT_NEAR(capsules.distance, 0.1 - kSoftening, 1e-14);
  EXPECT_LT((capsules.a - Vector3d(0, 0, 0.2)).norm(), 1e-12);
  EXPECT_LT(capsules.b.norm(), 1e-12);
  const Matrix3d turned = AngleAxisd(0.3, Vector3d::UnitZ()).toRotationMatrix();
  const Proximity boxes = Between(Box({0, 0, 1.2}, {1, 2, 1}, turned),
                                  Box({0, 0, 0}, {3, 3, 1}, Matrix3d::Identity()), kSoftening);
  EXPECT_LT((boxes.a - Vector3d(0, 0, 0.7)).norm(), 1e-9);
  EXPECT_LT((boxes.b - Vector3d(0, 0, 0.5)).norm(), 1e-9);
  EXPECT_LT((boxes.normal - Vector3d::UnitZ()).norm(), 1e-9);
}

/// A body that turns with ω about the origin of its frame, which moves with v.
Pose Moved(const Pose& X, const Vector3d& omega, const Vector3d& v, double t) {
  return {X.position + t * v,
          AngleAxisd(omega.norm() * t, omega.normalized()).toRotationMatrix() * X.rotation};
}

TEST(CollisionDistance, ChangesAsItsPointsMoveAsPointsOfTheirBodies) {
  RandomBodies draw(11);
  const double h = 1e-6;
  int apart = 0, deep = 0;
  for (int k = 0; k < 3000; ++k) {
    const double reach = k % 2 ? 0.3 : 0.06;
    const PosedShape a{draw.Shape(k), draw.Pose(reach)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(reach)};
    const Proximity p = Between(a, b, kSoftening);
    const Vector3d omega_a = draw.Vector(1), omega_b = draw.Vector(1);
    const Vector3d v_a = draw.Vector(1), v_b = draw.Vector(1);
    const auto at = [&](double t) {
      return Between({a.shape, Moved(a.pose, omega_a, v_a, t)},
                     {b.shape, Moved(b.pose, omega_b, v_b, t)}, kSoftening)
          .distance;
    };
    const double edot = p.normal.dot(v_a + omega_a.cross(p.a - a.pose.position) - v_b -
                                     omega_b.cross(p.b - b.pose.position));
    const double before = (p.distance - at(-h)) / h, after = (at(h) - p.distance) / h;
    // |ë| ≤ ‖w‖²/z + ω² R²/δ ≤ 5²/0.02 + 3 · 0.2²/5e-4 = 1500 m/s²; e is right to some 1e-13 m
    const double z = p.normal.dot(p.a - p.b);
    if (z > 0.02) {
      ++apart;
      EXPECT_NEAR(0.5 * (before + after), edot, 1500 * h) << k;
    } else if (z < -0.005 && std::abs(after - before) < 1e-3) {  // no other normal takes over
      ++deep;
      EXPECT_NEAR(after, edot, 2e-3) << k;
    }
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(deep, 200);
}

/// How far closest points and the normal go from one pose of a to a near one, in shares of what the
/// header allows.
double ShareOfBound(const PosedShape& a, const PosedShape& b, const Pose& moved) {
  // The header has the smaller one move.
  if (a.shape.extent > b.shape.extent) return ShareOfBound(b, a, a.pose * moved.inverse() * b.pose);
  const Proximity p = Between(a, b, kSoftening);
  const Proximity q = Between({a.shape, moved}, b, kSoftening);
  const double z = std::min((p.a - p.b).norm(), (q.a - q.b).norm());
  const auto in = [](const Pose& X, const Vector3d& x) {
    return Vector3d(X.rotation.transpose() * (x - X.position));
  };
  const Vector3d of_a = in(a.pose, p.a);
  const double w = (moved.position + moved.rotation * of_a - p.a).norm();
  const double theta = AngleAxisd(a.pose.rotation.transpose() * moved.rotation).angle();
  const double R = a.shape.extent;
  const double slide = R * R / kSoftening * (theta + w / z);
  const double noise = 1e-7;  // the gap that ends the search is 1e-15 m²; θ is as good as √1e-16
  return std::max({(in(moved, q.a) - of_a).norm() / (slide + noise),
                   (q.b - p.b).norm() / (w + slide + noise),
                   (q.normal - p.normal).norm() / ((w + slide + noise) / z)});
}

TEST(CollisionDistance, HasPointsThatSlideNoFasterThanTheBound) {
  RandomBodies draw(13);
  for (int k = 0; k < 5000; ++k) {
    const PosedShape a{draw.Shape(k), draw.Pose(0.3)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.3)};
    if (Between(a, b).distance < 0.01) continue;
    const Pose moved = Moved(a.pose, draw.Vector(1e-4), draw.Vector(1e-5), 1);
    EXPECT_LE(ShareOfBound(a, b, moved), 1) << k;
  }
}

TEST(CollisionDistance, HasPointsThatDoNotJumpWhereFeaturesBecomeParallel) {
  const PosedShape floor = Box({0, 0, -0.5}, {2, 2, 1}, Matrix3d::Identity());
  const PosedShape beam = Capsule({0.02, 0.01, 0}, {0.3, 0, 0}, 0.05);
  struct Case {
    CollisionShape a;
    const PosedShape& b;
    double height;
  };
  const std::vector<Case> cases{
      {CollisionShape::Capsule({-0.1, 0, 0}, {0.1, 0, 0}, 0.04), beam, 0.15},
      {CollisionShape::Capsule({-0.1, 0, 0}, {0.1, 0, 0}, 0.04), floor, 0.1},
      {CollisionShape::Box(Pose(), {0.2, 0.2, 0.2}), floor, 0.12},
      {CollisionShape::Box(Pose(), {0.2, 0.2, 0.2}), beam, 0.2}};
  for (const Case& c : cases) {
    double furthest = 0;
    Vector3d before = Vector3d::Zero();
    const double step = 1e-5;
    for (int i = -4000; i <= 4000; ++i) {
      // Through the parallel pose, also in the second direction.
      const auto pose = [&](double angle) {
        return Pose{{0, 0, c.height},
                    AngleAxisd(angle, Vector3d(0.1, 1, 0.2).normalized()).toRotationMatrix()};
      };
      const PosedShape a{c.a, pose(i * step)};
      EXPECT_LE(ShareOfBound(a, c.b, pose((i + 1) * step)), 1) << i;
      const Vector3d x =
          a.pose.rotation.transpose() * (Between(a, c.b, kSoftening).a - a.pose.position);
      if (i > -4000) furthest = std::max(furthest, (x - before).norm());
      before = x;
    }
    EXPECT_LT(furthest, 1e-3) << "of 0.2 m that the point has to go";
  }
}

TEST(CollisionDistance, TakesNothingFromTheHeap) {
  RandomBodies draw(15);
  for (int k = 0; k < 500; ++k) {
    const PosedShape a{draw.Shape(k), draw.Pose(0.1)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.1)};
    const long before = Allocations();
    const Proximity p = Between(a, b, kSoftening);
    EXPECT_EQ(Allocations(), before);
    EXPECT_TRUE(std::isfinite(p.distance));
  }
}

}  // namespace
}  // namespace pliant
