#include "pliant/plants/pinhole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/tests/plants/collision_scene.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(Pinhole, ProjectsWhatARayMeetsOntoItsPixel) {
  RandomBodies draw(1);
  const Pinhole view;
  for (int k = 0; k < 1000; ++k) {
    const int column = static_cast<int>(draw.random() % 640),
              row = static_cast<int>(draw.random() % 480);
    const Vector3d x = draw.Uniform(0.1, 5) * view.Ray(column, row);
    EXPECT_LT((view.Project(x) - Eigen::Vector2d(column, row)).norm(), 1e-10);
  }
  EXPECT_EQ(view.Ray(0, 0).z(), 1);
  EXPECT_LT(view.Ray(0, 0).x(), 0);  // left
  EXPECT_LT(view.Ray(0, 0).y(), 0);  // top
}

TEST(Pinhole, HasTheFieldOfViewOfAKinect) {
  const Pinhole view;
  const double wide = 2 * std::atan(0.5 * view.width / view.focal) * 180 / std::numbers::pi;
  const double high = 2 * std::atan(0.5 * view.height / view.focal) * 180 / std::numbers::pi;
  // 57° × 43° by the data sheet; the driver's focal length is 1 % off those.
  EXPECT_NEAR(wide, 57, 2);
  EXPECT_NEAR(high, 43, 2.5);
}

TEST(LookingAt, HasTheTargetInTheMiddleAndUpUpwards) {
  RandomBodies draw(2);
  for (int k = 0; k < 100; ++k) {
    const Vector3d from = draw.Vector(2), to = draw.Vector(2);
    Pinhole view;
    view.pose = LookingAt(from, to);
    const Eigen::Matrix3d& R = view.pose.rotation;
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    EXPECT_NEAR(R.determinant(), 1, 1e-13);
    const Eigen::Vector2d middle = view.Project(R.transpose() * (to - from));
    EXPECT_LT((middle - Eigen::Vector2d(319.5, 239.5)).norm(), 1e-9);
    const Vector3d above = R.transpose() * (to + Vector3d(0, 0, 0.01) - from);
    EXPECT_LT(view.Project(above).y(), 239.5);
    EXPECT_NEAR(view.Project(above).x(), 319.5, 1e-9);
  }
}

TEST(LookingAt, RefusesADirectionThatSaysNothing) {
  EXPECT_EQ(ErrorOf([] {
              LookingAt({1, 2, 3}, {1, 2, 3});
            }),
            "a camera looks at a point away from it, got 1 2 3");
  EXPECT_EQ(ErrorOf([] {
              LookingAt({std::numeric_limits<double>::quiet_NaN(), 2, 3}, {0, 0, 0});
            }),
            "the position of a camera must be three finite numbers, got nan 2 3");
  EXPECT_EQ(ErrorOf([] {
              LookingAt({0, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0});
            }),
            "what a camera looks at must be three finite numbers, got 0 inf 0");
}

TEST(LookingAt, StraightDownHasXUpwards) {
  for (const double height : {2.0, -2.0}) {
    Pinhole view;
    view.pose = LookingAt({0, 0, height}, {0, 0, 0});
    const Eigen::Matrix3d& R = view.pose.rotation;
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-13);
    EXPECT_NEAR(R.determinant(), 1, 1e-13);
    const Eigen::Vector2d above = view.Project(R.transpose() * Vector3d(0.01, 0, -height));
    EXPECT_LT(above.y(), 239.5);
    EXPECT_NEAR(above.x(), 319.5, 1e-9);
  }
  // Along another `up`, y: x is most across it.
  EXPECT_NEAR(LookingAt({0, 0, 0}, {0, 1, 0}, {0, 2, 0}).rotation.col(1).x(), -1, 1e-13);
}

}  // namespace
}  // namespace pliant
