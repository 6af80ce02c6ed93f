#include "pliant/apps/arm_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/plants/fake_gen3.h"

namespace pliant {
namespace {

using kortex::Function;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Asked = FakeGen3::Asked;
using Frames = std::vector<FakeGen3::Bytes>;

TEST(ArmCheck, TriesEachStepAndCommandsNothing) {
  std::atomic<int> times = 0;
  FakeGen3 arm([&](const Asked& asked) -> std::optional<Frames> {
    if (asked.header.function != Function::RefreshFeedback) return {};
    auto feedback = FakeGen3::Healthy();
    const auto noise = static_cast<float>(++times);
    for (const int joint : {0, 1, 2, 3, 5, 6}) feedback.mutable_actuators(joint)->set_torque(noise);
    feedback.mutable_base()->set_fault_bank_a(16);
    feedback.mutable_actuators(6)->set_fault_bank_a(1);
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(feedback))};
  });
  const ArmFacts facts = TryArm(arm.address());
  EXPECT_EQ(facts.address, arm.address().text());
  EXPECT_EQ(facts.fault, "");
  EXPECT_EQ(facts.session_fault, "");
  EXPECT_EQ(facts.state, "ARMSTATE_SERVOING_READY");
  EXPECT_EQ(facts.servoing, "SINGLE_LEVEL_SERVOING");
  EXPECT_FALSE(facts.left_low_level);
  EXPECT_THAT(facts.faults, ElementsAre("JOINT_FAULT"));
  ASSERT_THAT(facts.joints, SizeIs(7));
  EXPECT_EQ(facts.joints[0].torques, kFeedbacks);
  EXPECT_EQ(facts.joints[4].torques, 1);
  EXPECT_EQ(facts.joints[4].motor_temperature, 30);
  EXPECT_EQ(facts.joints[4].core_temperature, 35);
  EXPECT_THAT(facts.joints[4].faults, IsEmpty());
  EXPECT_THAT(facts.joints[6].faults, ElementsAre("FOLLOWING_ERROR"));
  for (const Function function : {Function::Refresh, Function::SetServoingMode,
                                  Function::SetControlMode, Function::ClearFaults})
    EXPECT_THAT(arm.asked(function), IsEmpty());
}

TEST(ArmCheck, SaysHowFarItCame) {
  FakeGen3 arm([](const Asked& asked) -> std::optional<Frames> {
    if (asked.header.function != Function::CreateSession) return {};
    return Frames{FakeGen3::Refusal(asked, Kinova::Api::INVALID_PASSWORD, "")};
  });
  const ArmFacts facts = TryArm(arm.address());
  EXPECT_EQ(facts.fault, "");
  EXPECT_THAT(facts.session_fault, HasSubstr("INVALID_PASSWORD"));
  EXPECT_THAT(facts.joints, IsEmpty());
}

TEST(ArmCheck, SaysWhyNobodyAnswers) {
  const Gen3Address gone = FakeGen3().address();
  EXPECT_EQ(TryArm(gone).fault, "Connection refused");
  Gen3Address nowhere;
  nowhere.host = "no.such.arm.invalid";
  EXPECT_NE(TryArm(nowhere).fault, "");  // its words are the resolver's
}

}  // namespace
}  // namespace pliant
