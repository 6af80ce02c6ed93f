#include "pliant/systems/matrix_gain.h"

#include <gtest/gtest.h>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};

TEST(MatrixGain, MultipliesByAMatrix) {
  BlockTester<MatrixGain<JointPosition, JointTorque>> t(
      {.from = kTwo, .to = kTwo, .gain = Eigen::Matrix2d{{1, 2}, {3, 4}}});
  t.Set(t->u, {10.0, 100.0});
  EXPECT_EQ(t.Get(t->y), (JointTorque{210.0, 430.0}));
}

TEST(MatrixGain, TakesAndGivesSingleNumbers) {
  BlockTester<MatrixGain<JointPosition, double>> sum(
      {.from = kTwo, .gain = Eigen::RowVector2d(1, 1)});
  sum.Set(sum->u, {3.0, 4.0});
  EXPECT_EQ(sum.Get(sum->y), 7);
  BlockTester<MatrixGain<double, NumberVector>> spread(
      {.to = Names::Numbered(3), .gain = Eigen::Vector3d(1, 2, 3)});
  spread.Set(spread->u, 2);
  EXPECT_EQ(spread.Get(spread->y), (NumberVector{2.0, 4.0, 6.0}));
  BlockTester<MatrixGain<double>> one({.gain = Eigen::MatrixXd::Constant(1, 1, -2)});
  one.Set(one->u, 4);
  EXPECT_EQ(one.Get(one->y), -8);
}

TEST(MatrixGain, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<MatrixGain<JointPosition, JointTorque>>(
      {.from = kTwo, .to = kTwo, .gain = Eigen::Matrix2d{{1, 2}, {3, 4}}}));
}

TEST(MatrixGain, RefusesAMatrixThatDoesNotFit) {
  const auto error = [](const Eigen::MatrixXd& K) {
    return ErrorOf(
        [&] { BlockTester<MatrixGain<JointPosition, double>>({.from = kTwo, .gain = K}); });
  };
  EXPECT_EQ(error(Eigen::MatrixXd::Ones(2, 1)), "block: gain must be 1×2, as y and u are, got 2×1");
  EXPECT_EQ(error(Eigen::RowVector2d(1, NAN)), "block: gain must be finite");
}

}  // namespace
}  // namespace pliant
