#include "pliant/systems/white_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSamples = 100'000;
const Joints kJoints{"shoulder", "elbow"};

WhiteNoise<JointTorque>::Options Options() {
  return {.space = kJoints, .deviation = PerJoint{{0.5, 2.0}}, .period = 1ms, .seed = 7};
}

/// The first n values, a row each.
MatrixXd Drawn(const WhiteNoise<JointTorque>::Options& o, int n) {
  BlockTester<WhiteNoise<JointTorque>> t(o);
  MatrixXd drawn(n, 2);
  for (int k = 0; k < n; ++k) {
    t.Tick();
    drawn.row(k) = t.Get(t->y).transpose();
  }
  return drawn;
}

TEST(WhiteNoise, IsNormalWithTheDeviationOfEachElement) {
  const MatrixXd drawn = Drawn(Options(), kSamples);
  for (int i = 0; i < 2; ++i) {
    const double sigma = Options().deviation(i);
    const VectorXd x = drawn.col(i) / sigma;
    EXPECT_LT(std::abs(x.mean()), MeanBound(kSamples));
    EXPECT_LT(std::abs(Variance(x) - 1), VarianceBound(kSamples));
    // Over n normal numbers the mean of x³ has the variance 15/n, the kurtosis 24/n.
    EXPECT_LT(std::abs(x.array().pow(3).mean()), kDeviations * std::sqrt(15.0 / kSamples));
    EXPECT_LT(std::abs(x.array().pow(4).mean() / std::pow(Variance(x), 2) - 3),
              kDeviations * std::sqrt(24.0 / kSamples));
  }
}

TEST(WhiteNoise, IsUncorrelatedOverTimeAndBetweenElements) {
  const MatrixXd drawn = Drawn(Options(), kSamples);
  for (const int lag : {1, 2, 3, 10, 100, 1000})
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        EXPECT_LT(std::abs(Correlation(drawn.col(i), drawn.col(j), lag)), MeanBound(kSamples - lag))
            << "lag " << lag;
  EXPECT_LT(std::abs(Correlation(drawn.col(0), drawn.col(1))), MeanBound(kSamples));
}

TEST(WhiteNoise, IsAFunctionOfItsSeed) {
  WhiteNoise<JointTorque>::Options o = Options();
  const MatrixXd drawn = Drawn(o, 20'000);
  EXPECT_EQ(Drawn(o, 20'000), drawn);
  o.seed = 8;
  const MatrixXd other = Drawn(o, 20'000);
  for (int i = 0; i < 2; ++i)
    EXPECT_LT(std::abs(Correlation(drawn.col(i), other.col(i))), MeanBound(20'000));
}

TEST(WhiteNoise, IsHeldBetweenItsTicks) {
  BlockTester<WhiteNoise<double>> t({.deviation = 3, .period = 10ms, .seed = 1});
  t.Tick();
  const double held = t.Get(t->y);
  EXPECT_NE(held, 0);
  t.AdvanceTo(0.0099);
  EXPECT_EQ(t.Get(t->y), held);
  t.Tick();
  EXPECT_NE(t.Get(t->y), held);
}

TEST(WhiteNoise, FollowsADeviationSetWhileRunning) {
  BlockTester<WhiteNoise<double>> quiet({.deviation = 0, .period = 1ms, .seed = 5});
  BlockTester<WhiteNoise<double>> loud({.deviation = 3, .period = 1ms, .seed = 5});
  quiet.Tick();
  EXPECT_EQ(quiet.Get(quiet->y), 0);
  loud.Tick();
  quiet.Set(quiet->deviation, 3);
  quiet.Tick();
  loud.Tick();
  EXPECT_EQ(quiet.Get(quiet->y), loud.Get(loud->y));
}

TEST(WhiteNoise, DrawsVectorsInAFrame) {
  BlockTester<WhiteNoise<Wrench>> t(
      {.space = "tool", .deviation = Wrench{0, 0, 0, 1, 1, 1}, .period = 1ms, .seed = 3});
  t.Tick();
  EXPECT_EQ(t.Get(t->y).head<3>(), Eigen::Vector3d(Eigen::Vector3d::Zero()));
  EXPECT_TRUE((t.Get(t->y).tail<3>().array() != 0).all());
}

TEST(WhiteNoise, RefusesDeviationsThatAreNone) {
  const auto error = [](const PerJoint& deviation) {
    WhiteNoise<JointTorque>::Options o = Options();
    o.deviation = deviation;
    return ErrorOf([&] { BlockTester<WhiteNoise<JointTorque>> t(o); });
  };
  EXPECT_EQ(error(PerJoint{{1.0, -2.0}}), "block: deviation[elbow] must be >= 0 N·m, got -2");
  EXPECT_EQ(error(PerJoint{{std::nan(""), 1.0}}),
            "block: deviation[shoulder] must be >= 0 N·m, got nan");
  EXPECT_EQ(error(PerJoint::Ones(3)),
            "block: the value of 'deviation' has a number for each of (shoulder, elbow), got 3");
  EXPECT_EQ(
      ErrorOf([] { BlockTester<WhiteNoise<double>>({.deviation = -1, .period = 1ms, .seed = 1}); }),
      "block: deviation must be >= 0, got -1");
}

TEST(WhiteNoise, HoldsTheLaws) { ExpectBlockLaws(BlockTester<WhiteNoise<JointTorque>>(Options())); }

}  // namespace
}  // namespace pliant
