#include "pliant/controllers/state_feedback.h"

#include <gtest/gtest.h>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};
const Eigen::MatrixXd kGain{{1, 2, 3}, {4, 5, 6}};

TEST(StateFeedback, PullsTowardsItsOperatingPoint) {
  BlockTester<StateFeedback<JointTorque>> t({.states = Names::Numbered(3),
                                             .space = kTwo,
                                             .gain = kGain,
                                             .rest = Eigen::Vector3d(1, 0, 0),
                                             .hold = {10.0, 20.0}});
  t.Set(t->x, {1.0, 0.0, 0.0});
  EXPECT_EQ(t.Get(t->u), (JointTorque{10.0, 20.0}));
  t.Set(t->x, {2.0, 1.0, 0.0});
  EXPECT_EQ(t.Get(t->u), (JointTorque{7.0, 11.0}));
  t.Set(t->x0, {2.0, 1.0, 0.0});
  t.Set(t->u0, {0.0, -1.0});
  EXPECT_EQ(t.Get(t->u), (JointTorque{0.0, -1.0}));
}

TEST(StateFeedback, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<StateFeedback<JointTorque>>(
      {.states = Names::Numbered(3), .space = kTwo, .gain = kGain}));
}

TEST(StateFeedback, RefusesAGainOrARestThatDoesNotFit) {
  EXPECT_EQ(ErrorOf([] {
              BlockTester<StateFeedback<double>>({.states = Names::Numbered(3), .gain = kGain});
            }),
            "block: gain must be 1×3, as u and the states are, got 2×3");
  EXPECT_EQ(ErrorOf([] {
              BlockTester<StateFeedback<JointTorque>>({.states = Names::Numbered(3),
                                                       .space = kTwo,
                                                       .gain = kGain,
                                                       .rest = Eigen::Vector2d::Zero()});
            }),
            "block: rest must have a number for each state, 3, got 2");
}

}  // namespace
}  // namespace pliant
