#include "pliant/plants/gen3_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Gen3Faults, HaveTheNamesOfTheProtocol) {
  EXPECT_THAT(ActuatorFaultNames(0), IsEmpty());
  EXPECT_THAT(ActuatorFaultNames(1 | 16 | 0x800000),
              ElementsAre("FOLLOWING_ERROR", "STRAIN_GAUGE_MISMATCH", "WATCHDOG_TRIGGERED"));
  EXPECT_THAT(BaseFaultNames(0), IsEmpty());
  EXPECT_THAT(BaseFaultNames(0x20 | 0x40000000),
              ElementsAre("CYCLIC_DATA_JITTER", "ARM_INTO_ILLEGAL_POSITION"));
}

TEST(Gen3Faults, AreToldByTheirBitWithoutAName) {
  EXPECT_THAT(ActuatorFaultNames(0x80000001), ElementsAre("FOLLOWING_ERROR", "bit 31"));
  EXPECT_THAT(BaseFaultNames(0x80000000), ElementsAre("bit 31"));
}

TEST(Gen3Faults, NameTheStatesOfTheArmToo) {
  EXPECT_EQ(ArmStateName(4), "ARMSTATE_IN_FAULT");
  EXPECT_EQ(ArmStateName(77), "77");
  EXPECT_EQ(Gen3ServoingName(Gen3Servoing::LowLevel), "LOW_LEVEL_SERVOING");
  EXPECT_EQ(Gen3ServoingName(static_cast<Gen3Servoing>(9)), "9");
  EXPECT_EQ(Gen3ModeName(Gen3Mode::TorqueHighVelocity), "TORQUE_HIGH_VELOCITY");
}

}  // namespace
}  // namespace pliant
