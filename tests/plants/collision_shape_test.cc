#include "pliant/plants/collision_shape.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/plants/obstacle.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/tests/plants/collision_scene.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

TEST(CollisionShape, OfABoxHasItsCornersFacesAndEdges) {
  const CollisionShape box =
      CollisionShape::Box({{1, 2, 3}, RandomBodies(1).Rotation()}, {2, 4, 6});
  EXPECT_EQ(box.points.size(), 8u);
  EXPECT_EQ(box.faces.size(), 3u);
  EXPECT_EQ(box.edges.size(), 3u);
  EXPECT_LT((box.center - Vector3d(1, 2, 3)).norm(), 1e-14);
  EXPECT_NEAR(box.extent, std::sqrt(1 + 4 + 9), 1e-14);
}

TEST(CollisionShape, OfAHullLeavesOutWhatIsInside) {
  // A tetrahedron: four faces, six edges; a point inside, one on a face, one on an edge, one twice.
  std::vector<Vector3d> points{{0, 0, 0},       {1, 0, 0},     {0, 1, 0},  {0, 0, 1},
                               {0.1, 0.1, 0.1}, {0.2, 0.2, 0}, {0.5, 0, 0}};
  const CollisionShape hull = CollisionShape::Hull(points);
  EXPECT_EQ(hull.points.size(), 4u);
  EXPECT_EQ(hull.faces.size(), 4u);
  EXPECT_EQ(hull.edges.size(), 6u);
}

TEST(CollisionShape, OfACylinderEnclosesItAndLittleMore) {
  const double r = 0.05, half = 0.1;
  const CollisionShape prism = CollisionShape::Of(
      {.name = "", .kind = Shape::Kind::Cylinder, .pose = Pose(), .size = {r, 2 * half, 0}});
  EXPECT_EQ(prism.points.size(), 24u);
  const auto reach = [&](const Vector3d& n) {
    double most = 0;
    for (const Vector3d& p : prism.points) most = std::max(most, n.dot(p));
    return most;
  };
  EXPECT_NEAR(reach(Vector3d::UnitZ()), half, 1e-15) << "ends as they are";
  for (double angle = 0; angle < 7; angle += 0.01) {
    const double out = reach({std::cos(angle), std::sin(angle), 0});
    EXPECT_GE(out, r - 1e-15);
    EXPECT_LE(out, r / std::cos(std::numbers::pi / 12) + 1e-15);
  }
}

TEST(CollisionShape, RefusesPointsThatMakeNoHull) {
  const auto error = [](const std::vector<Vector3d>& points) {
    return ErrorOf([&] { CollisionShape::Hull(points); });
  };
  EXPECT_EQ(error({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "a hull has from 4 to 32 points, got 3");
  EXPECT_EQ(error(std::vector<Vector3d>(33, Vector3d::Zero())),
            "a hull has from 4 to 32 points, got 33");
  EXPECT_EQ(error({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}}),
            "the points of a hull may not lie in a plane");
  EXPECT_EQ(error(std::vector<Vector3d>(5, Vector3d::Ones())),
            "the points of a hull may not lie in a plane");
  EXPECT_EQ(error({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, HUGE_VAL}}),
            "the points of a hull must be finite, got   0   0 inf");
}

struct Obstacles {
  std::vector<Obstacle> obstacles;

  template <class F>
  void Parameters(F&& f) {
    f("obstacles", obstacles);
  }
};

std::vector<Obstacle> Read(const std::string& text) {
  Obstacles all;
  ParameterFile::ReadText(text, "scene.yaml").Fill(all);
  return all.obstacles;
}

TEST(Obstacle, StandsInAFileWithItsKindAsATag) {
  const std::vector<Obstacle> all = Read(R"(
obstacles:
  - !Box {name: table, center: [0.5, 0, -0.02], size: [1, 1, 40 mm], rpy: [0, 0, 90 deg]}
  - !Sphere {name: head, center: [0, 0.8, 0.6], radius: 150 mm, except: [base_link]}
  - !Capsule {name: post, a: [0, 0, 0], b: [0, 0, 1], radius: 0.05}
  - !Hull {name: wedge, points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], radius: 1 cm}
)");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(NameOf(all[0]), "table");
  EXPECT_EQ(ExceptedBy(all[1]), std::vector<std::string>{"base_link"});
  const CollisionShape table = ShapeOf(all[0]);
  EXPECT_EQ(table.points.size(), 8u);
  EXPECT_NEAR(table.extent, std::hypot(0.5, 0.5, 0.02), 1e-15);
  EXPECT_EQ(ShapeOf(all[1]).radius, 0.15);
  EXPECT_EQ(ShapeOf(all[2]).half, Vector3d(0, 0, 0.5));
  EXPECT_EQ(ShapeOf(all[3]).radius, 0.01);
}

TEST(Obstacle, TurnsABoxByRollPitchAndYawAsUrdfDoes) {
  const BoxObstacle box{
      .name = "box", .center = {0, 0, 0}, .size = {2, 1, 1}, .rpy = {0.3, 0.4, 0.5}};
  // Its x axis: yaw after pitch; roll leaves it.
  const Vector3d x{std::cos(0.5) * std::cos(0.4), std::sin(0.5) * std::cos(0.4), -std::sin(0.4)};
  const CollisionShape shape = ShapeOf(box);
  const auto along_x = [&](const Vector3d& n) { return n.cross(x).norm() < 1e-14; };
  EXPECT_TRUE(std::ranges::any_of(shape.faces, along_x));
}

TEST(Obstacle, SaysWhatIsWrongWithIt) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { Read("obstacles:\n  - " + text); });
  };
  EXPECT_EQ(error("!Box {name: table, center: [0, 0, 0]}"), "scene.yaml:2:5: 'size' is missing");
  EXPECT_THAT(error("!Box {name: table, center: [0, 0], size: [1, 1, 1]}"),
              HasSubstr("expected a list of 3, got one of 2"));
  EXPECT_THAT(error("!Box {name: table, center: [0, 0, 0], size: [1, 1, 0]}"),
              HasSubstr("size must be > 0 m, got 0"));
  EXPECT_THAT(error("!Cone {name: table}"), HasSubstr("there is no !Cone here"));
  EXPECT_THAT(error("{name: table}"), HasSubstr("one of !Box, !Sphere, !Capsule, !Hull"));
  EXPECT_THAT(error("!Sphere {center: [0, 0, 0], radius: 1}"), HasSubstr("'name' is missing"));

  const auto refused = [](const Obstacle& obstacle) { return ErrorOf([&] { ShapeOf(obstacle); }); };
  EXPECT_EQ(refused(SphereObstacle{.name = "", .center = {0, 0, 0}, .radius = 1}),
            "an obstacle must have a name");
  EXPECT_EQ(refused(SphereObstacle{.name = "head", .center = {0, 0, 0}, .radius = 0}),
            "head: radius must be > 0 m, got 0");
  EXPECT_EQ(refused(BoxObstacle{.name = "table", .center = {0, 0, 0}, .size = {1, -1, 1}}),
            "table: size[y] must be > 0 m, got -1");
  EXPECT_THAT(refused(CapsuleObstacle{.name = "post"}), HasSubstr("post: a[x] must be"));
  EXPECT_EQ(refused(HullObstacle{.name = "wedge", .points = {}}),
            "wedge: a hull has from 4 to 32 points, got 0");
  EXPECT_EQ(
      refused(HullObstacle{
          .name = "wedge", .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .radius = -1}),
      "wedge: radius must be >= 0 m, got -1");
}

}  // namespace
}  // namespace pliant
