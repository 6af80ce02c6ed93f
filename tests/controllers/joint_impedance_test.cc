#include "pliant/controllers/joint_impedance.h"

#include <gtest/gtest.h>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};
const JointImpedance::Options kOptions{
    .joints = kTwo, .stiffness = PerJoint{{100, 50}}, .damping = PerJoint{{4, 2}}};

TEST(JointImpedance, IsASpringAndADamper) {
  BlockTester<JointImpedance> t(kOptions);
  t.Set(t->position, {0.1, -0.2});
  t.Set(t->velocity, {1.0, -1.0});
  t.Set(t->rest, {0.2, 0.0});
  EXPECT_TRUE(t.Get(t->torque).isApprox(JointTorque{6.0, 12.0}, 1e-15));  // 10 − 4, 10 + 2
  t.Set(t->rest_velocity, {1.0, -1.0});
  t.Set(t->feedforward, {0.5, 0.0});
  EXPECT_TRUE(t.Get(t->torque).isApprox(JointTorque{10.5, 10.0}, 1e-15));
  t.Set(t->stiffness, PerJoint{{0, 0}});
  EXPECT_TRUE(t.Get(t->torque).isApprox(JointTorque{0.5, 0.0}, 1e-15));
}

TEST(JointImpedance, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<JointImpedance>(kOptions));
}

TEST(JointImpedance, RefusesGainsThatPushAway) {
  JointImpedance::Options o = kOptions;
  o.stiffness(1) = -1;
  EXPECT_EQ(ErrorOf([&] { BlockTester<JointImpedance>{o}; }),
            "block: stiffness[elbow] must be >= 0 N·m/rad, got -1");
  o = kOptions;
  o.damping = PerJoint::Ones(3);
  EXPECT_EQ(ErrorOf([&] { BlockTester<JointImpedance>{o}; }),
            "block: damping has an element for each of the 2 joints, got 3");
}

}  // namespace
}  // namespace pliant
