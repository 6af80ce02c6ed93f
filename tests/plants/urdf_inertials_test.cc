#include "pliant/plants/urdf_inertials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Inertial kNew{1.25, {0.01, -0.02, 0.03}, Eigen::Vector3d(0.01, 0.02, 0.025).asDiagonal()};

TEST(UrdfInertials, ReplacesThoseOfTheLinksNamedAndNoOthers) {
  const RobotModel before = Tree();
  const RobotModel after =
      RobotModel::FromUrdfText(WithInertials(kTree, {{"left_hand", kNew}, {"right_slide", kNew}}));
  ASSERT_EQ(after.links().size(), before.links().size());
  for (std::size_t i = 0; i < before.links().size(); ++i) {
    const Link& link = after.links()[i];
    EXPECT_EQ(link.name, before.links()[i].name);
    const bool named = link.name == "left_hand" || link.name == "right_slide";
    const Inertial& expected = named ? kNew : before.links()[i].inertial;
    EXPECT_EQ(link.inertial.mass, expected.mass);
    EXPECT_EQ(link.inertial.center, expected.center);
    EXPECT_LT((link.inertial.inertia - expected.inertia).norm(), 1e-15);  // round-off of rotations
    EXPECT_EQ(link.pose.position, before.links()[i].pose.position);
  }
}

TEST(UrdfInertials, AreWrittenToNineDigits) {
  EXPECT_EQ(InertialElement({1.0 / 3, {0, 1, 2}, Eigen::Matrix3d::Identity()}),
            "<inertial>\n"
            "  <origin xyz=\"0 1 2\"/>\n"
            "  <mass value=\"0.333333333\"/>\n"
            "  <inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/>\n"
            "</inertial>");
}

TEST(UrdfInertials, OfLinksThatAreNotThereAreRefused) {
  EXPECT_EQ(ErrorOf([] {
              WithInertials(kTree, {{"tail", kNew}}, "tree.urdf");
            }),
            "tree.urdf: there is no link \"tail\"");
}

}  // namespace
}  // namespace pliant
