#include "pliant/analysis/ros_schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant::internal {
namespace {

using ::testing::ElementsAre;

TEST(FieldNames, AreThoseOfRos) {
  EXPECT_THAT(
      FieldNames(
          {"[joint_1]", ".force[x]", "[0,1]", "", "[Elbow-Left]", "[3]", "[µ]", ".a[0].b[__c__]"}),
      ElementsAre("joint_1", "force_x", "e_0_1", "data", "elbow_left", "e_3", "data_2", "a_0_b_c"));
}

TEST(FieldNames, DifferWhereElementsDo) {
  EXPECT_THAT(FieldNames({"[a-b]", "[a_b]", "[A_B]", "[a_b_2]"}),
              ElementsAre("a_b", "a_b_2", "a_b_3", "a_b_2_2"));
}

TEST(SchemaOf, NamesTheTypeTheElementsAndTheirUnits) {
  EXPECT_EQ(SchemaOf({"arm.velocity", "joint velocity", {"[shoulder]", "[elbow]"}, {"rad/s", ""}}),
            (RosSchema{"pliant/msg/JointVelocity",
                       "# joint velocity\nfloat64 shoulder  # rad/s\nfloat64 elbow\n"}));
  EXPECT_EQ(SchemaOf({"x", "std::array<double, 2>", {"[0]"}, {""}}).name,
            "pliant/msg/StdArrayDouble2");
  EXPECT_EQ(SchemaOf({"x", "6-vector", {"[0]"}, {""}}).name, "pliant/msg/Value6Vector");
}

TEST(TopicOf, IsATopicOfRos) {
  EXPECT_EQ(TopicOf("arm.measured_velocity"), "/arm/measured_velocity");
  EXPECT_EQ(TopicOf("arm-2.7dof.q"), "/arm_2/_7dof/q");
}

}  // namespace
}  // namespace pliant::internal
