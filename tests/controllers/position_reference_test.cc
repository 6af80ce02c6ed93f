#include "pliant/controllers/position_reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(PositionReference, IntegratesAHeldAccelerationExactly) {
  const Joints joints({"a", "b"});
  const JointPosition start{0.3, -1};
  BlockTester<PositionReference> t({.joints = joints, .start = start, .period = 1ms});
  const JointAcceleration a{2, -0.5};
  t.Set(t->acceleration, a);
  for (int k = 0; k < 1000; ++k) {
    t.Tick();
    const double s = k * 1e-3;  // the reference of tick k, before its own acceleration counts
    const PerJoint q = start + 0.5 * s * s * a;
    ASSERT_LT((t.Get(t->position) - q).cwiseAbs().maxCoeff(), 1e-12) << k;
    ASSERT_LT((t.Get(t->velocity) - s * a).cwiseAbs().maxCoeff(), 1e-12) << k;
  }
}

TEST(PositionReference, StandsStillWhereAnAccelerationIsNoNumber) {
  const Joints joints({"a", "b"});
  BlockTester<PositionReference> t({.joints = joints, .start = {0, 0}, .period = 1ms});
  t.Set(t->acceleration, {1, 1});
  for (int k = 0; k < 100; ++k) t.Tick();
  t.Set(t->acceleration, {1, std::nan("")});
  t.Tick();
  t.Tick();
  const JointPosition stopped = t.Get(t->position);
  EXPECT_EQ(t.Get(t->velocity), JointVelocity::Zero(joints));
  for (int k = 0; k < 10; ++k) t.Tick();
  EXPECT_EQ(t.Get(t->position), stopped);
}

TEST(PositionReference, GoesOnFromTheArmItFollowed) {
  const Joints joints({"a", "b"});
  BlockTester<PositionReference> t({.joints = joints, .start = {0, 0}, .period = 1ms});
  t.Set(t->acceleration, {1, -1});
  t.Set(t->follow, true);
  const JointPosition q{0.5, 0.2};
  const JointVelocity v{0.1, -0.3};
  t.Set(t->measured_position, q);
  t.Set(t->measured_velocity, v);
  for (int k = 0; k < 10; ++k) {
    t.Tick();
    ASSERT_EQ(t.Get(t->position), q);
    ASSERT_EQ(t.Get(t->velocity), v);
  }
  t.Set(t->measured_position, {std::nan(""), 0.2});
  t.Set(t->measured_velocity, {std::nan(""), -0.3});
  t.Tick();
  EXPECT_TRUE(t.Get(t->position).allFinite() && t.Get(t->velocity).allFinite());
  t.Set(t->measured_position, q);
  t.Set(t->measured_velocity, v);
  t.Tick();
  ASSERT_EQ(t.Get(t->position), q);
  t.Set(t->follow, false);
  t.Tick();
  const PerJoint a = t.Get(t->velocity) - PerJoint(v);
  EXPECT_LT((a - PerJoint(Eigen::Vector2d(1e-3, -1e-3))).norm(), 1e-15);
  EXPECT_LT((t.Get(t->position) - PerJoint(q + 1e-3 * v + 0.5e-3 * a)).norm(), 1e-15);
}

TEST(PositionReference, RefusesAStartOfAnotherArm) {
  EXPECT_EQ(ErrorOf([] {
              PositionReference({.joints = Joints({"a", "b"}), .start = {0}, .period = 1ms});
            }),
            "the value of 'position' has a number for each of (a, b), got 1");
}

}  // namespace
}  // namespace pliant
