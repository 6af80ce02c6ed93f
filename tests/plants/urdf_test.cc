// What a URDF must say to be a robot, and what is said of one that is none.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "pliant/plants/robot_model.h"
#include "pliant/systems/error.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kArm = R"(<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.2" rpy="0 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <mass value="1"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>
    </inertial>
    <visual name="tube">
      <geometry><cylinder radius="0.05" length="0.3"/></geometry>
      <material name="shell"><color rgba="1 0 0 1"/></material>
    </visual>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 0.4" rpy="0 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="50"/>
  </joint>
  <joint name="elbow" type="prismatic">
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" velocity="1" effort="100"/>
  </joint>
</robot>
)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// What is said when the first `from` of the arm reads `to` instead.
std::string Complaint(const std::string& from, const std::string& to) {
  try {
    RobotModel::FromUrdfText(Replaced(kArm, from, to), "arm.urdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Urdf, ArmOfTheseTestsIsRead) {
  const RobotModel model = RobotModel::FromUrdfText(kArm, "arm.urdf");
  EXPECT_EQ(model.joints(), (Joints{"shoulder", "elbow"}));
}

TEST(Urdf, MissingFileIsNamedInTheMessage) {
  try {
    RobotModel::FromUrdf("models/none.urdf");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(),
                StartsWith("models/none.urdf: cannot read this file; expected a URDF file "
                           "(relative paths start at "));
  }
}

TEST(Urdf, MessagesNameTheFile) {
  const auto file = std::filesystem::temp_directory_path() / "pliant_urdf_test.urdf";
  std::ofstream(file) << Replaced(kArm, "value=\"2\"", "value=\"x\"");
  try {
    RobotModel::FromUrdf(file);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(
        e.what(),
        file.string() + ":7: link \"upper\", <mass>: value: expected a finite number, got \"x\"");
  }
  std::filesystem::remove(file);
}

TEST(Urdf, SyntaxErrorIsFoundInItsLine) {
  EXPECT_THAT(Complaint("</inertial>\n  </link>", "</inertia>\n  </link>"),
              StartsWith("arm.urdf:9: this is not well-formed XML: "));
  EXPECT_THAT(Complaint("<mass value=\"2\"/>", "<mass value=2\"/>"),
              StartsWith("arm.urdf:7: this is not well-formed XML: "));
}

TEST(Urdf, NamesAreToBeReadAlikeByAll) {
  for (const std::string name : {"\"&#955;\"", "\"a\tb\"", "\"a\nb\""}) {
    std::string text = kArm.substr(kArm.find("<robot"));  // which says nothing of an encoding
    for (std::size_t at; (at = text.find("\"fore\"")) != text.npos;) text.replace(at, 6, name);
    EXPECT_THAT(ErrorOf([&] { RobotModel::FromUrdfText(text, "arm.urdf"); }),
                HasSubstr("alike; write it without tabs, line ends and references to characters"))
        << name;
  }
}

TEST(Urdf, EmptyTextIsNoXml) {
  EXPECT_THROW(RobotModel::FromUrdfText(""), Error);
  EXPECT_THROW(RobotModel::FromUrdfText("just words"), Error);
  EXPECT_THROW(RobotModel::FromUrdfText("<?xml version=\"1.0\"?>"), Error);
}

TEST(Urdf, RootElementMustBeARobot) {
  try {
    RobotModel::FromUrdfText("<sdf version=\"1.6\"/>", "world.sdf");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "world.sdf:1: sdf: expected <robot> as the root element, got <sdf>");
  }
  EXPECT_EQ(Complaint("<robot name=\"arm\">", "<robot>"),
            "arm.urdf:2: robot: expected the attribute name, got none");
}

TEST(Urdf, MacrosMustBeExpanded) {
  EXPECT_EQ(
      Complaint("<link name=\"base\"/>", "<link name=\"base\"/><xacro:arm/>"),
      "arm.urdf:3: xacro:arm: expected plain URDF, got the macro <xacro:arm>; run xacro on the "
      "file first");
}

TEST(Urdf, JointsRefuseUnknownLinksAndOfferTheNearest) {
  EXPECT_EQ(
      Complaint("child link=\"fore\"", "child link=\"for\""),
      "arm.urdf:30: joint \"elbow\", <child>: there is no link \"for\"; did you mean \"fore\"?");
  EXPECT_EQ(Complaint("    <parent link=\"upper\"/>\n", ""),
            "arm.urdf:28: joint \"elbow\": expected <parent>, got none");
}

TEST(Urdf, LinkHasOneParent) {
  EXPECT_EQ(Complaint("child link=\"fore\"", "child link=\"upper\""),
            "arm.urdf:28: joint \"elbow\": expected one parent for link \"upper\", got two: joint "
            "\"shoulder\" in line 21 moves it too");
}

TEST(Urdf, TreeHasOneRoot) {
  EXPECT_EQ(
      Complaint("<link name=\"base\"/>", "<link name=\"base\"/><link name=\"table\"/>"),
      "arm.urdf:2: robot \"arm\": expected one link without a parent, got 2: \"base\" (line 3), "
      "\"table\" (line 3); join them by a joint");
}

TEST(Urdf, TreeHasNoCycle) {
  EXPECT_EQ(Complaint("parent link=\"base\"", "parent link=\"fore\""),
            "arm.urdf:21: joint \"shoulder\": expected a tree, got a cycle of links: \"upper\" -> "
            "\"fore\" -> \"upper\"");
  EXPECT_EQ(
      Complaint("parent link=\"upper\"", "parent link=\"fore\""),
      "arm.urdf:28: joint \"elbow\": expected a tree, got a cycle of links: \"fore\" -> \"fore\"");
}

TEST(Urdf, NamesAreUnique) {
  EXPECT_EQ(
      Complaint("link name=\"fore\"", "link name=\"upper\""),
      "arm.urdf:11: link \"upper\": expected a name of its own; the link in line 4 has the same");
  EXPECT_EQ(
      Complaint("joint name=\"elbow\"", "joint name=\"shoulder\""),
      "arm.urdf:28: joint \"shoulder\": expected a name of its own; the joint in line 21 has the "
      "same");
  EXPECT_EQ(Complaint("link name=\"fore\"", "link name=\"\""),
            "arm.urdf:11: link \"\": expected a name, got \"\"");
}

TEST(Urdf, MassIsPositive) {
  EXPECT_EQ(
      Complaint("value=\"2\"", "value=\"0\""),
      "arm.urdf:7: link \"upper\", <mass>: value must be > 0, got 0; leave out <inertial> where a "
      "link is only a frame");
  EXPECT_THAT(Complaint("value=\"2\"", "value=\"-2\""), HasSubstr("value must be > 0, got -2"));
  EXPECT_EQ(Complaint("      <mass value=\"2\"/>\n", ""),
            "arm.urdf:5: link \"upper\", <inertial>: expected <mass>, got none");
}

TEST(Urdf, InertiaIsThatOfABody) {
  EXPECT_EQ(
      Complaint("izz=\"0.01\"", "izz=\"-0.01\""),
      "arm.urdf:8: link \"upper\", <inertia>: no body has this inertia: expected no moment < 0, "
      "got principal moments -0.01, 0.03 and 0.03 kg·m²; check units and signs");
  EXPECT_EQ(
      Complaint("izz=\"0.01\"", "izz=\"0.07\""),
      "arm.urdf:8: link \"upper\", <inertia>: no body has this inertia: expected none above the "
      "sum of the two others, got principal moments 0.03, 0.03 and 0.07 kg·m²; check units and "
      "signs");
  EXPECT_THAT(Complaint("ixy=\"0\"", "ixy=\"0.04\""), HasSubstr("expected no moment < 0"));
  EXPECT_EQ(Complaint(" ixz=\"0\"", ""),
            "arm.urdf:8: link \"upper\", <inertia>: expected the attribute ixz, got none");
}

TEST(Urdf, ThinPlateIsABody) { EXPECT_EQ(Complaint("izz=\"0.01\"", "izz=\"0.06\""), "none"); }

TEST(Urdf, NumbersAreFiniteNumbers) {
  EXPECT_EQ(
      Complaint("xyz=\"0 0 0.2\"", "xyz=\"0 0 nan\""),
      "arm.urdf:6: link \"upper\", <origin>: xyz: expected 3 finite numbers, got \"0 0 nan\"");
  EXPECT_EQ(Complaint("ixx=\"0.03\"", "ixx=\"inf\""),
            "arm.urdf:8: link \"upper\", <inertia>: ixx: expected a finite number, got \"inf\"");
  EXPECT_EQ(Complaint("izz=\"0.01\"", "izz=\"x\""),
            "arm.urdf:8: link \"upper\", <inertia>: izz: expected a finite number, got \"x\"");
  EXPECT_EQ(
      Complaint("xyz=\"0 0 0.4\"", "xyz=\"0 0.4\""),
      "arm.urdf:24: joint \"shoulder\", <origin>: xyz: expected 3 finite numbers, got \"0 0.4\"");
  EXPECT_EQ(
      Complaint("rpy=\"0 0 0\"/>\n    <axis", "rpy=\"0 0 0 0\"/>\n    <axis"),
      "arm.urdf:24: joint \"shoulder\", <origin>: rpy: expected 3 finite numbers, got \"0 0 0 0\"");
  EXPECT_EQ(
      Complaint("xyz=\"0 0 1\"", "xyz=\"0 0 1,0\""),
      "arm.urdf:31: joint \"elbow\", <axis>: xyz: expected 3 finite numbers, got \"0 0 1,0\"");
  EXPECT_THAT(Complaint("effort=\"50\"", "effort=\"1e999\""),
              HasSubstr("effort: expected a finite number, got \"1e999\""));
  EXPECT_THAT(Complaint("rgba=\"1 0 0 1\"", "rgba=\"1 0 0 255\""),
              HasSubstr("arm.urdf:18: link \"fore\", <color>: rgba: expected numbers in [0, 1]"));
}

TEST(Urdf, NumbersMayStandInAnyOrderOfBlanks) {
  EXPECT_EQ(Complaint("xyz=\"0 0 0.4\"", "xyz=\"\t+0\n 0   4e-1 \""), "none");
}

TEST(Urdf, MovableJointsNeedAnAxis) {
  EXPECT_EQ(
      Complaint("    <axis xyz=\"0 1 0\"/>\n", ""),
      "arm.urdf:21: joint \"shoulder\": expected <axis>, got none; write <axis xyz=\"1 0 0\"/> if "
      "the default of URDF is meant");
  EXPECT_EQ(Complaint("xyz=\"0 1 0\"", "xyz=\"0 0 0\""),
            "arm.urdf:25: joint \"shoulder\", <axis>: xyz: expected a direction, got \"0 0 0\"");
}

TEST(Urdf, LimitedJointsNeedLimits) {
  EXPECT_EQ(Complaint("    <limit lower=\"-1\" upper=\"1\" velocity=\"2\" effort=\"50\"/>\n", ""),
            "arm.urdf:21: joint \"shoulder\": a revolute joint needs <limit lower upper velocity "
            "effort>, got none; a joint that turns without end is continuous");
  EXPECT_EQ(Complaint("    <limit lower=\"0\" upper=\"0.5\" velocity=\"1\" effort=\"100\"/>\n", ""),
            "arm.urdf:28: joint \"elbow\": a prismatic joint needs <limit lower upper velocity "
            "effort>, got none");
  EXPECT_EQ(
      Complaint("lower=\"-1\"", "lower=\"1\""),
      "arm.urdf:26: joint \"shoulder\", <limit>: lower must be < upper, got lower 1 and upper 1");
  EXPECT_EQ(Complaint("velocity=\"2\"", "velocity=\"0\""),
            "arm.urdf:26: joint \"shoulder\", <limit>: velocity must be > 0, got 0");
  EXPECT_EQ(Complaint(" effort=\"50\"", ""),
            "arm.urdf:26: joint \"shoulder\", <limit>: expected the attribute effort, got none");
}

TEST(Urdf, OnlyTreesOfIndependentJointsOnAFixedBaseAreRead) {
  EXPECT_EQ(
      Complaint("type=\"revolute\"", "type=\"floating\""),
      "arm.urdf:21: joint \"shoulder\": expected type revolute, continuous, prismatic or fixed, "
      "got \"floating\"");
  EXPECT_THAT(Complaint("type=\"revolute\"", "type=\"planar\""), HasSubstr("got \"planar\""));
  EXPECT_EQ(
      Complaint("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/>\n<mimic joint=\"shoulder\"/>"),
      "arm.urdf:32: joint \"elbow\", <mimic>: expected independent joints, got one that mimics "
      "another; make it fixed, or leave out <mimic> and drive it by itself");
}

TEST(Urdf, MassMustMoveWithEveryLastJoint) {
  const std::string fore = R"(    <inertial>
      <mass value="1"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/>
    </inertial>
)";
  EXPECT_EQ(
      Complaint(fore, ""),
      "arm.urdf:24: joint \"elbow\" moves link \"fore\", whose mass is 0: the joint inertia matrix "
      "would be singular; expected an <inertial> on this link or on one fixed to it");
  const std::string spinning = Replaced(Replaced(kArm, fore, ""), "prismatic", "revolute");
  try {
    RobotModel::FromUrdfText(spinning, "arm.urdf");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(),
                StartsWith("arm.urdf:24: joint \"elbow\" moves link \"fore\", whose inertia "
                           "about the joint's axis is 0"));
  }
}

TEST(Urdf, ElementsStandOnce) {
  EXPECT_EQ(
      Complaint("<mass value=\"2\"/>", "<mass value=\"2\"/>\n<mass value=\"3\"/>"),
      "arm.urdf:8: link \"upper\", <mass>: expected one <mass>, got a second; the first is in "
      "line 7");
}

TEST(Urdf, ShapesAreChecked) {
  EXPECT_EQ(Complaint("radius=\"0.05\"", "radius=\"-0.05\""),
            "arm.urdf:17: link \"fore\", <cylinder>: radius must be > 0, got -0.05");
  EXPECT_EQ(
      Complaint("<cylinder radius=\"0.05\" length=\"0.3\"/>", "<cone/>"),
      "arm.urdf:17: link \"fore\", <geometry>: expected <box>, <sphere>, <cylinder> or <mesh>, got "
      "<cone>");
  EXPECT_EQ(Complaint("<cylinder radius=\"0.05\" length=\"0.3\"/>", "<box size=\"1 0 1\"/>"),
            "arm.urdf:17: link \"fore\", <box>: size: expected three numbers > 0, got \"1 0 1\"");
  EXPECT_EQ(Complaint("<color rgba=\"1 0 0 1\"/>", ""),
            "arm.urdf:18: link \"fore\", <material>: there is no material \"shell\"");
}

TEST(Urdf, WhatOnlyUrdfdomRefusesIsToldInItsWords) {
  EXPECT_THAT(
      Complaint("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\"/><calibration rising=\"x\"/>"),
      StartsWith("arm.urdf: urdfdom cannot read this file:\n  "));
}

TEST(Urdf, RobotHasAMovableJoint) {
  EXPECT_EQ(Complaint(kArm.substr(kArm.find("  <link name=\"upper\">"),
                                  kArm.find("</robot>") - kArm.find("  <link name=\"upper\">")),
                      ""),
            "arm.urdf: robot \"arm\" has no movable joint");
}

TEST(Urdf, JointsBeyondTheBoundAreRefused) {
  std::string urdf = "<robot name=\"snake\">\n<link name=\"l0\"/>\n";
  for (int i = 1; i <= kMaxJoints + 1; ++i) {
    const std::string n = std::to_string(i), last = std::to_string(i - 1);
    urdf += "<link name=\"l" + n +
            "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" "
            "ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link><joint name=\"j" +
            n + "\" type=\"continuous\"><parent link=\"l" + last + "\"/><child link=\"l" + n +
            "\"/><axis xyz=\"0 0 1\"/></joint>\n";
  }
  urdf += "</robot>";
  try {
    RobotModel::FromUrdfText(urdf, "snake.urdf");
    FAIL();
  } catch (const Error& e) {
    const std::string n = std::to_string(kMaxJoints + 1);
    EXPECT_EQ(e.what(), "snake.urdf:" + std::to_string(kMaxJoints + 3) + ": joint \"j" + n +
                            "\" is movable joint number " + n + ", expected at most " +
                            std::to_string(kMaxJoints) +
                            "; make some of them fixed, or configure with -DPLIANT_MAX_JOINTS=…");
  }
}

}  // namespace
}  // namespace pliant
