#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/controllers/safety_supervisor.h"
#include "pliant/controllers/safety_text.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/block_tester.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

// shown: begin built
TEST(Failure, OfBuildingSaysWhatWasFound) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] {
              b.Add<LowPass<JointVelocity>>("filter",
                                            {.space = {"elbow"}, .cutoff_hz = -3, .period = 1ms});
            }),
            "filter: cutoff_hz must be > 0, got -3");
}
// shown: end built

// shown: begin running
TEST(Failure, OfAControllerDoesNotReachTheArm) {
  const RobotModel gen3 = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  const JointPosition home{0, 0.26, 3.14, -2.27, 0, 0.96, 1.57};
  BlockTester<SafetySupervisor> t({.model = gen3,
                                   .position = home,
                                   .torque_per_ampere = PerJoint::Constant(7, 10),
                                   .current_limit = MotorCurrent{10, 10, 10, 10, 6, 6, 6}});
  t.Set(t->mode, ControlMode::Torque);
  t.Set(t->status, {.mode = ControlMode::Torque});
  t.Set(t->torque_command, JointTorque::Zero(gen3.joints()));
  t.Set(t->current_command, MotorCurrent::Zero(gen3.joints()));
  t.Set(t->measured_position, home);
  t.Set(t->measured_velocity, JointVelocity::Zero(gen3.joints()));
  t.Set(t->measured_torque, JointTorque::Zero(gen3.joints()));
  for (int k = 0; k < 600; ++k) t.Tick();  // engages, and blends for 0.5 s
  ASSERT_EQ(t.Get(t->report).state, SafetyState::Running);

  JointTorque wrong = JointTorque::Zero(gen3.joints());
  wrong(3) = std::numeric_limits<double>::quiet_NaN();
  t.Set(t->torque_command, wrong);
  t.Tick();
  const SafetyReport& report = t.Get(t->report);
  EXPECT_EQ(report.state, SafetyState::Damped);
  EXPECT_EQ(report.cause, SafetyCause::CommandNotFinite);
  EXPECT_EQ(report.joint, 3);
  EXPECT_TRUE(t.Get(t->arm_torque).allFinite());  // the arm's weight, damped
}
// shown: end running

}  // namespace
}  // namespace pliant
