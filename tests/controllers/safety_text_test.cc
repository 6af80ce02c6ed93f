#include "pliant/controllers/safety_text.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(SafetyText, SaysWhatWasFoundAndAllowedWithItsUnit) {
  EXPECT_EQ(SafetyText(SafetyCause::TorqueJump, 1, 40, 38),
            "torque_jump at joint 2: 40 N·m, allowed 38 N·m in a tick");
  EXPECT_EQ(SafetyText(SafetyCause::VelocityLimit, 6, -3.000049, 2.9),
            "velocity_limit at joint 7: -3 rad/s, allowed 2.9 rad/s");
  EXPECT_EQ(SafetyText(SafetyCause::StaleFeedback, -1, 5, 5),
            "stale_feedback: 5 ticks, allowed less than 5 ticks without a new measurement");
}

TEST(SafetyText, HasNoNumbersWhereThereAreNone) {
  EXPECT_EQ(SafetyText(SafetyCause::JointFault, 3, 0, 0), "joint_fault at joint 4");
  EXPECT_EQ(SafetyText(SafetyCause::UserStop, -1, 0, 0), "user_stop");
}

TEST(SafetyText, HintsAfterEveryCauseButTheUsers) {
  for (std::size_t i = 0; i < Words(SafetyCause{}).size(); ++i) {
    const auto cause = static_cast<SafetyCause>(i);
    const bool none = cause == SafetyCause::None || cause == SafetyCause::UserStop;
    EXPECT_EQ(SafetyHint(cause).empty(), none) << Words(cause)[i];
  }
}

}  // namespace
}  // namespace pliant
