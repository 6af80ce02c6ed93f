#include <gtest/gtest.h>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

// shown: begin own
/// How warm the motors are.
struct MotorWarmth : Signal<MotorWarmth, Joints, Eigen::Dynamic, kMaxJoints> {
  using Signal::Signal;
  static constexpr Quantity quantity{"motor warmth", "°C"};
};
// shown: end own

TEST(Signals, OfOnesOwnHaveANameAndAUnit) {
  const Joints joints{"shoulder", "elbow"};
  DiagramBuilder b;
  b.Add<Constant<MotorWarmth>>("warmth", {.space = joints, .value = {40, 35}});
  const Diagram diagram = b.Build();
  const std::vector<ValueInfo> values = diagram.Values();
  const auto y = std::ranges::find(values, "warmth.y", &ValueInfo::path);
  ASSERT_NE(y, values.end());
  EXPECT_EQ(y->type, "motor warmth");
  EXPECT_EQ(y->unit, "°C");
  EXPECT_EQ(y->space, "(shoulder, elbow)");
}

// shown: begin space
TEST(Signals, OfOtherJointsDoNotConnect) {
  DiagramBuilder b;
  auto& measured =
      b.Add<Constant<JointVelocity>>("measured", {.space = {"elbow", "shoulder"}, .value = {0, 0}});
  auto& damper = b.Add<Gain<JointVelocity, JointTorque>>(
      "damper", {.space = {"shoulder", "elbow"}, .gain = -5});
  EXPECT_EQ(ErrorOf([&] { b.Connect(measured.y, damper.u); }),
            "cannot connect: the ports are about different joints\n"
            "  from  measured.y : joint velocity [rad/s] (elbow, shoulder)\n"
            "  to    damper.u : joint velocity [rad/s] (shoulder, elbow)");
}
// shown: end space

}  // namespace
}  // namespace pliant
