#include "pliant/plants/robot_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/error.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(RobotModel, HasItsJointsInTheOrderOfTheFile) {
  EXPECT_EQ(Tree().joints(), (Joints{"left_wrist", "waist", "left_shoulder", "left_extension",
                                     "right_extension", "right_shoulder"}));
  EXPECT_EQ(Gen3().joints(), Joints::Numbered(7));
  EXPECT_EQ(Tree().link(1).name, "left_hand");
}

TEST(RobotModel, PutsBodiesOfParentsFirst) {
  const RobotModel tree = Tree();
  const std::span<const Body> bodies = tree.bodies();
  ASSERT_EQ(bodies.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_LT(bodies[static_cast<std::size_t>(i)].parent, i);
}

TEST(RobotModel, MergesFixedLinksIntoTheirBody) {
  const RobotModel tree = Tree();
  const int trunk = tree.link_index("trunk"), backpack = tree.link_index("backpack");
  EXPECT_EQ(tree.link(trunk).body, tree.link(backpack).body);
  EXPECT_EQ(tree.link(tree.link_index("camera")).body, -1);
  EXPECT_DOUBLE_EQ(tree.bodies()[static_cast<std::size_t>(tree.link(trunk).body)].mass, 7.5);
  EXPECT_NEAR(tree.mass(), 0.7 + 6 + 1.5 + 2 + 0.9 + 1.2 + 0.4, 1e-14);
}

TEST(RobotModel, HasTheLimitsOfTheFile) {
  const RobotModel gen3 = Gen3();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(gen3.upper_limit(),
            (JointPosition{kInfinity, 2.24, kInfinity, 2.57, kInfinity, 2.09, kInfinity}));
  EXPECT_EQ(gen3.lower_limit(), -gen3.upper_limit());
  EXPECT_EQ(gen3.velocity_limit(),
            (JointVelocity{2.0944, 2.0944, 2.0944, 2.0944, 3.049, 3.049, 3.049}));
  EXPECT_EQ(gen3.effort_limit(), (JointTorque{95, 95, 95, 95, 45, 45, 45}));
  EXPECT_EQ(Tree().velocity_limit()(0), kInfinity);  // a continuous joint without <limit>
}

TEST(RobotModel, HasTheMassesOfThePublishedArms) {
  EXPECT_NEAR(Gen3().mass(), 8.0519 - 1.697, 1e-12);  // without the base
  EXPECT_NEAR(Lwr().mass(), 2.69768 + 3.86094 + 2.48827 + 2.51362 + 1.88271 + 1.46844 + 0.24557,
              1e-12);
}

TEST(RobotModel, OffersTheNearestNameForAnUnknownOne) {
  try {
    Gen3().link_index("tool_frme");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(
        e.what(),
        "robot \"gen3_7dof\" has no link \"tool_frme\"; did you mean \"tool_frame\"?\n"
        "  links: base_link, shoulder_link, half_arm_1_link, half_arm_2_link, forearm_link, "
        "spherical_wrist_1_link, spherical_wrist_2_link, bracelet_link, end_effector_link, "
        "tool_frame");
  }
  try {
    Gen3().joint_index("elbow");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::StartsWith("robot \"gen3_7dof\" has no joint \"elbow\"\n"));
  }
}

TEST(RobotModel, KeepsShapesToDraw) {
  const RobotModel gen3 = Gen3();
  const Link& base = gen3.link(0);
  ASSERT_EQ(base.visuals.size(), 1u);
  EXPECT_EQ(base.visuals[0].kind, Shape::Kind::Cylinder);
  EXPECT_EQ(base.visuals[0].size, Vector3d(0.0462, 0.1708, 0));
  EXPECT_EQ(base.visuals[0].pose.position, Vector3d(0, 0, 0.0854));
  EXPECT_NEAR(base.visuals[0].color[0], 0.80, 1e-7);  // urdfdom reads colours as float
}

TEST(RobotModel, MakesCapsulesOfCylindersWithTwoSpheres) {
  const RobotModel gen3 = Gen3();
  const Link& link = gen3.link(gen3.link_index("half_arm_1_link"));
  ASSERT_EQ(link.collisions.size(), 1u);
  const Shape& capsule = link.collisions[0];
  EXPECT_EQ(capsule.kind, Shape::Kind::Capsule);
  EXPECT_EQ(capsule.name, "half_arm_1_link_capsule");
  const Vector3d half = 0.5 * capsule.size[1] * capsule.pose.rotation.col(2);
  EXPECT_NEAR((capsule.pose.position - half - Vector3d(0, -0.213, -0.0065)).norm(), 0, 1e-15);
  EXPECT_NEAR((capsule.pose.position + half - Vector3d(0, 0.004, -0.019)).norm(), 0, 1e-15);
  EXPECT_EQ(capsule.size[0], 0.0477);
  EXPECT_EQ(gen3.link(gen3.link_index("bracelet_link")).collisions[0].kind, Shape::Kind::Sphere);
}

TEST(RobotModel, IgnoresMeshes) {
  std::string urdf = kTree;
  urdf.insert(
      urdf.find("<link name=\"camera\"/>"),
      "<link name=\"lens\"><visual><geometry><mesh filename=\"package://a/b.stl\"/></geometry>"
      "</visual></link><joint name=\"l\" type=\"fixed\"><parent link=\"camera\"/>"
      "<child link=\"lens\"/></joint>");
  const RobotModel model = RobotModel::FromUrdfText(urdf);
  EXPECT_TRUE(model.link(model.link_index("lens")).visuals.empty());
}

TEST(RobotModel, PayloadAddsItsWeightAtItsPlace) {
  const RobotModel gen3 = Gen3();
  Inertial weight;
  weight.mass = 1.25;
  weight.center = {0.01, -0.02, 0.03};
  weight.inertia = 1e-3 * Eigen::Matrix3d::Identity();
  const RobotModel loaded = gen3.WithPayload("tool_frame", weight);
  EXPECT_NEAR(loaded.mass() - gen3.mass(), 1.25, 1e-14);

  RandomStates random(gen3);
  RobotDynamics d(gen3, {"tool_frame"}), e(loaded, {"tool_frame"});
  for (int k = 0; k < 20; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    ComputeDynamics(gen3, q, v, d);
    ComputeDynamics(loaded, q, v, e);
    const FrameDynamics point =
        PointDynamics(gen3, d, gen3.link_index("tool_frame"), weight.center);
    Vector6 scale;  // the weight as a body of its own: Jᵀ diag(I, m) J
    scale << 1e-3, 1e-3, 1e-3, 1.25, 1.25, 1.25;
    const JointMatrix M = d.M + point.J.transpose() * scale.asDiagonal() * point.J;
    EXPECT_LT(RelativeError(e.M, M), 1e-14);
    const JointTorque g = d.gravity + 1.25 * 9.80665 * point.J.row(5).transpose();
    EXPECT_LT(RelativeError(e.gravity, g), 1e-14);
  }
}

TEST(RobotModel, ModifiedCopiesLeaveTheOriginalAlone) {
  const RobotModel gen3 = Gen3();
  const RobotModel moon = gen3.WithGravity({0, 0, -1.62});
  EXPECT_EQ(gen3.gravity(), Vector3d(0, 0, -9.80665));
  EXPECT_EQ(moon.gravity(), Vector3d(0, 0, -1.62));
  Inertial heavy = gen3.link(2).inertial;
  heavy.mass *= 2;
  EXPECT_NEAR(gen3.WithInertial("half_arm_1_link", heavy).mass() - gen3.mass(), 1.1636, 1e-14);
  EXPECT_FALSE(moon == gen3);
  EXPECT_TRUE(Gen3().joints() == gen3.joints());
}

TEST(RobotModel, RefusesPayloadsThatAreNoBodies) {
  Inertial bad;
  bad.mass = -1;
  EXPECT_THROW(Gen3().WithPayload("tool_frame", bad), Error);
  bad.mass = 1;
  bad.inertia.diagonal() << 1, 1, 3;
  try {
    Gen3().WithPayload("tool_frame", bad);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(
        e.what(),
        "payload on link \"tool_frame\": no body has this inertia: expected none above the sum "
        "of the two others, got principal moments 1, 1 and 3 kg·m²; check units and signs");
  }
  EXPECT_THROW(Gen3().WithPayload("tool", Inertial{.mass = 1}), Error);
}

}  // namespace
}  // namespace pliant
