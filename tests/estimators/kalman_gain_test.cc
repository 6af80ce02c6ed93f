#include "pliant/estimators/kalman_gain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/random_matrices.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using testing::StartsWith;

MatrixXd One(double x) { return MatrixXd::Constant(1, 1, x); }

// A random walk: P = (w + √(w² + 4 w v))/2, L = P/(P + v).
TEST(SteadyKalman, OfARandomWalkIsKnown) {
  for (const double w : {1e-4, 0.1, 10.0})
    for (const double v : {0.5, 2.0}) {
      const SteadyKalman s = SteadyKalmanOf({One(1), One(1), One(1)}, {One(w), One(v)});
      const double P = (w + std::sqrt(w * w + 4 * w * v)) / 2;
      EXPECT_NEAR(s.predicted(0, 0) / P, 1, 1e-12);
      EXPECT_NEAR(s.gain(0, 0) * (P + v) / P, 1, 1e-12);
      EXPECT_NEAR(s.corrected(0, 0) * (P + v) / (P * v), 1, 1e-12);
      EXPECT_NEAR(s.modes(0).real(), v / (P + v), 1e-12);
    }
}

// Kalata's tracking index of a position that is measured every h, w the variance of a random
// acceleration: Λ = h² √(w/v); α, β of the α-β filter follow.
TEST(SteadyKalman, OfAConstantVelocityIsTheAlphaBetaFilter) {
  const double h = 0.1, v = 1e-4;
  for (const double w : {1e-3, 0.1, 20.0}) {
    const Vector2d g(h * h / 2, h);
    const SteadyKalman s = SteadyKalmanOf({Matrix2d{{1, h}, {0, 1}}, g, Eigen::RowVector2d(1, 0)},
                                          {w * g * g.transpose(), One(v)});
    const double index = h * h * std::sqrt(w / v);
    const double r = (4 + index - std::sqrt(8 * index + index * index)) / 4;
    const double alpha = 1 - r * r, beta = 2 * (2 - alpha) - 4 * std::sqrt(1 - alpha);
    EXPECT_NEAR(s.gain(0) / alpha, 1, 1e-9) << w;
    EXPECT_NEAR(s.gain(1) * h / beta, 1, 1e-9) << w;
  }
}

TEST(SteadyKalman, IsWhereTheCovarianceComesToRest) {
  RandomMatrices random(8);
  for (int i = 0; i < 10; ++i) {
    const Index n = 5;
    const LinearModel m{0.6 * random.Normal(n, n), random.Normal(n, 1), random.Normal(2, n)};
    const NoiseCovariance noise{random.Positive(n), random.Positive(2)};
    const SteadyKalman s = SteadyKalmanOf(m, noise);
    MatrixXd P = MatrixXd::Identity(n, n);
    for (int k = 0; k < 5000; ++k) {
      const MatrixXd S = m.C * P * m.C.transpose() + noise.measurement;
      P = m.A * (P - P * m.C.transpose() * S.inverse() * m.C * P) * m.A.transpose() + noise.process;
    }
    EXPECT_TRUE(s.predicted.isApprox(P, 1e-9));
    EXPECT_LT(s.modes.cwiseAbs().maxCoeff(), 1);
  }
}

TEST(SteadyKalman, NamesWhatNoOutputTellsAndNoNoiseReaches) {
  const MatrixXd A = Vector2d(1, 0.5).asDiagonal();
  EXPECT_THAT(ErrorOf([&] {
                SteadyKalmanOf({A, Vector2d(1, 1), Eigen::RowVector2d(0, 1)},
                               {Matrix2d::Identity(), One(1)}, {"bias", "speed"});
              }),
              StartsWith("nothing shows a mode that does not die out: λ = 1, in bias\n"));
  EXPECT_THAT(ErrorOf([&] {
                SteadyKalmanOf({A, Vector2d(1, 1), Eigen::RowVector2d(1, 1)},
                               {Vector2d(0, 1).asDiagonal(), One(1)}, {"bias", "speed"});
              }),
              StartsWith("no noise reaches a mode that does not die out: λ = 1, in bias\n"));
}

TEST(SteadyKalman, RefusesNoiseThatIsNone) {
  const auto error = [](const MatrixXd& W, const MatrixXd& V, const MatrixXd& D = {}) {
    return ErrorOf([&] { SteadyKalmanOf({One(1), One(1), One(1), D}, {W, V}); });
  };
  EXPECT_EQ(error(Matrix2d::Identity(), One(1)),
            "process must be 1×1, a row and a column for each number, got 2×2");
  EXPECT_EQ(error(One(-1), One(1)), "process must be ≥ 0: its least eigenvalue, got -1");
  EXPECT_EQ(error(One(1), One(0)), "measurement must be > 0: its least eigenvalue, got 0");
  EXPECT_EQ(error(One(1), One(1), One(1)), "D must be zero: a filter measures the states");
  EXPECT_EQ(ErrorOf([] {
              RequireNoise({Matrix2d::Identity(), Vector2d(1, 1), Eigen::RowVector2d(1, 1)},
                           {Matrix2d{{1, 1}, {0, 1}}, One(1)});
            }),
            "process must be symmetric; its largest difference from the transpose, got 1");
}

}  // namespace
}  // namespace pliant
