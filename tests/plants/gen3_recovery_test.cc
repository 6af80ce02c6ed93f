#include "pliant/plants/gen3_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/plants/gen3_wire.h"
#include "pliant/tests/plants/fake_gen3.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using kortex::Function;
using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::StartsWith;
using Asked = FakeGen3::Asked;
using Frames = std::vector<FakeGen3::Bytes>;

TEST(Gen3Recovery, BringsBackAnArmThatWasLeft) {
  FakeGen3 arm;
  {
    const auto link = ConnectGen3(arm.address());
    for (int joint = 0; joint < kGen3Joints; ++joint)
      link->SetMode(joint, joint == 2 ? Gen3Mode::Torque : Gen3Mode::Position);
    link->SetServoing(Gen3Servoing::LowLevel);
  }
  EXPECT_THAT(
      Recover(arm.address(), false),
      ElementsAre("found: ARMSTATE_SERVOING_READY, LOW_LEVEL_SERVOING", "found: faults: none",
                  "actuator 1: in POSITION", "actuator 2: in POSITION",
                  "actuator 3: from TORQUE to POSITION", "actuator 4: in POSITION",
                  "actuator 5: in POSITION", "actuator 6: in POSITION", "actuator 7: in POSITION",
                  "now: ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING"));
  EXPECT_TRUE(arm.asked(Function::ClearFaults).empty());
  EXPECT_EQ(arm.servoing(), Kinova::Api::Base::SINGLE_LEVEL_SERVOING);
}

TEST(Gen3Recovery, TellsFaultsAndClearsThemIfAsked) {
  FakeGen3 arm([](const Asked& asked) -> std::optional<Frames> {
    if (asked.header.function != Function::RefreshFeedback) return {};
    auto feedback = FakeGen3::Healthy();
    feedback.mutable_base()->set_fault_bank_a(16);
    feedback.mutable_actuators(3)->set_fault_bank_a(3);
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(feedback))};
  });
  const std::vector<std::string> told = Recover(arm.address(), true);
  EXPECT_THAT(told, Contains("found: faults of the base: JOINT_FAULT"));
  EXPECT_THAT(told, Contains("found: faults of actuator 4: FOLLOWING_ERROR, MAXIMUM_VELOCITY"));
  EXPECT_THAT(told, Contains("clear faults: done"));
  EXPECT_EQ(arm.asked(Function::ClearFaults).size(), 1U);
}

TEST(Gen3Recovery, GoesOnWhereAnActuatorRefusesAndUdpIsSilent) {
  FakeGen3 arm([](const Asked& asked) -> std::optional<Frames> {
    if (asked.udp) return Frames{};
    if (asked.header.function != Function::GetControlMode || asked.header.device != 5) return {};
    return Frames{FakeGen3::Refusal(asked, Kinova::Api::DEVICE_DISCONNECTED, "")};
  });
  Gen3Address address = arm.address();
  address.connect_limit = 200ms;
  const std::vector<std::string> told = Recover(address, false);
  EXPECT_THAT(told, Contains(StartsWith("found: faults: not known; " + address.text() +
                                        " did not answer CreateSession")));
  EXPECT_THAT(told, Contains("actuator 5: not done: " + address.text() +
                             " refused GetControlMode of actuator 5: ERROR_DEVICE, "
                             "DEVICE_DISCONNECTED"));
  EXPECT_EQ(arm.servoing(), Kinova::Api::Base::SINGLE_LEVEL_SERVOING);
}

TEST(Gen3Recovery, ThrowsIfTheArmStaysAsItWas) {
  FakeGen3 arm([](const Asked& asked) -> std::optional<Frames> {
    if (asked.header.function != Function::GetServoingMode) return {};
    Kinova::Api::Base::ServoingModeInformation mode;
    mode.set_servoing_mode(Kinova::Api::Base::LOW_LEVEL_SERVOING);
    return Frames{FakeGen3::Response(asked, FakeGen3::Of(mode))};
  });
  EXPECT_EQ(ErrorOf([&] { Recover(arm.address(), false); }),
            arm.address().text() +
                " is in LOW_LEVEL_SERVOING, expected SINGLE_LEVEL_SERVOING; does another program "
                "run it? If not, use the arm's emergency stop");
}

}  // namespace
}  // namespace pliant
