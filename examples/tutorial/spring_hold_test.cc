#include "spring_hold.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"

using namespace pliant;

namespace {

// shown: begin tests
const RobotModel kArm = RobotModel::FromUrdf(MY_ARM);
const JointPosition kPosture{0.3, -1.2};
const SpringHold::Options kOptions{.model = kArm,
                                   .posture = kPosture,
                                   .stiffness = JointTorque{50, 20},
                                   .damping = JointTorque{5, 2}};

/// What the block makes of the arm at (q, v), and the weight there.
struct Held {
  JointTorque torque, weight;
};

Held At(const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(kArm);
  ComputeDynamics(kArm, q, v, d);
  BlockTester<SpringHold> block(kOptions);
  block.Set(block->dynamics, d);
  block.Tick();
  return {block.Get(block->torque), d.gravity};
}

TEST(SpringHold, CarriesTheWeightInItsPosture) {
  const Held held = At(kPosture, {0, 0});
  EXPECT_GT(held.weight.norm(), 1);  // an arm without weight would prove nothing
  EXPECT_EQ(held.torque, held.weight);
}

TEST(SpringHold, IsASpringAndADamper) {
  const Held held = At(kPosture + JointPosition{0.1, -0.2}, {0.5, 1});
  const JointTorque law = held.torque - held.weight;
  EXPECT_NEAR(law(0), -50 * 0.1 - 5 * 0.5, 1e-13);  // round-off of 10 N·m
  EXPECT_NEAR(law(1), 20 * 0.2 - 2 * 1, 1e-13);
}

TEST(SpringHold, RefusesASpringThatPushesAway) {
  SpringHold::Options o = kOptions;
  o.stiffness(1) = -20;
  EXPECT_THROW(SpringHold{o}, Error);
}
// shown: end tests

}  // namespace
