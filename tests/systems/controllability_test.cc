#include "pliant/systems/controllability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/random_matrices.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const Matrix2d kIntegrators{{0, 1}, {0, 0}};

TEST(Controllability, OfADoubleIntegratorIsThatOfItsEnd) {
  EXPECT_TRUE(IsControllable(kIntegrators, Vector2d(0, 1)));
  EXPECT_FALSE(IsControllable(kIntegrators, Vector2d(1, 0)));
  EXPECT_TRUE(IsObservable(kIntegrators, Vector2d(1, 0).transpose()));
  EXPECT_FALSE(IsObservable(kIntegrators, Vector2d(0, 1).transpose()));
  EXPECT_FALSE(IsControllable(kIntegrators, Vector2d::Zero()));
}

// A chain of n integrators is controllable from one end, also where its eigenvalues, all 0, are
// known to ε^(1/n) only.
TEST(Controllability, OfALongChainIsSeen) {
  for (const Index n : {5, 20, 60}) {
    MatrixXd A = MatrixXd::Zero(n, n);
    A.topRightCorner(n - 1, n - 1).setIdentity();
    EXPECT_TRUE(IsControllable(A, MatrixXd::Identity(n, n).rightCols(1)));
    const Controllability reach = ControllabilityOf(A, MatrixXd::Identity(n, n).col(0));
    EXPECT_EQ(reach.size, 1);
    EXPECT_EQ(reach.uncontrollable_modes.size(), n - 1);
  }
}

TEST(Controllability, OfRandomSystemsIsThatTheyWereMadeWith) {
  RandomMatrices random(2);
  for (int i = 0; i < 50; ++i) {
    const Index n = 8, reached = 1 + i % 7;
    MatrixXd A = random.Normal(n, n), B = random.Normal(n, 2);
    A.bottomLeftCorner(n - reached, reached).setZero();
    B.bottomRows(n - reached).setZero();
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(random.Normal(n, n)).householderQ();
    const Controllability reach = ControllabilityOf(Q * A * Q.transpose(), Q * B);
    ASSERT_EQ(reach.size, reached);
    const MatrixXd a = reach.T.transpose() * Q * A * Q.transpose() * reach.T;
    EXPECT_LT((a.bottomLeftCorner(n - reached, reached).norm()), 1e-12 * A.norm());
    EXPECT_TRUE((reach.T.transpose() * reach.T).isIdentity(1e-13));
    // wᵀ A = λ wᵀ and wᵀ B = 0 for each mode that is not moved.
    for (Index m = 0; m < n - reached; ++m) {
      const Eigen::VectorXcd w = reach.left_eigenvectors.col(m);
      const Eigen::RowVectorXcd wA = w.transpose() * (Q * A * Q.transpose());
      EXPECT_LT((wA - reach.uncontrollable_modes(m) * w.transpose()).norm(), 1e-11 * A.norm());
      EXPECT_LT((w.transpose() * (Q * B)).norm(), 1e-12 * B.norm());
    }
  }
}

TEST(Stabilizability, AsksOnlyForModesThatDoNotDieOut) {
  const MatrixXd A = Eigen::Vector3d(0.5, -0.5, -2).asDiagonal();
  EXPECT_TRUE(IsStabilizable(A, Eigen::Vector3d(1, 0, 0), TimeDomain::Continuous));
  EXPECT_FALSE(IsStabilizable(A, Eigen::Vector3d(0, 1, 1), TimeDomain::Continuous));
  EXPECT_FALSE(IsStabilizable(A, Eigen::Vector3d(1, 0, 0), TimeDomain::Sampled));
  EXPECT_TRUE(IsStabilizable(A, Eigen::Vector3d(0, 0, 1), TimeDomain::Sampled));
  EXPECT_TRUE(IsDetectable(A, Eigen::RowVector3d(1, 0, 0), TimeDomain::Continuous));
  EXPECT_FALSE(IsDetectable(A, Eigen::RowVector3d(0, 1, 0), TimeDomain::Continuous));
}

TEST(Stabilizability, NamesTheModeThatCannotBeMoved) {
  const MatrixXd A = Eigen::Vector3d(0.5, -0.5, -2).asDiagonal();
  const Eigen::Vector3d B(0, 1, 1);
  EXPECT_EQ(ErrorOf([&] { RequireStabilizable(A, B, TimeDomain::Continuous); }),
            "no input moves a mode that does not die out: λ = 0.5, in x1\n"
            "give an input that does, or leave these states out");
  EXPECT_EQ(ErrorOf([&] {
              RequireDetectable(A, B.transpose(), TimeDomain::Continuous, {"tilt", "a", "b"});
            }),
            "nothing shows a mode that does not die out: λ = 0.5, in tilt\n"
            "measure or weigh what does, or leave these states out");
  // A pendulum beside the one that is driven: ±2i, in its angle and its rate.
  MatrixXd two = MatrixXd::Zero(3, 3);
  two.bottomRightCorner(2, 2) << 0, 1, -4, 0;
  two(0, 0) = -1;
  EXPECT_THAT(ErrorOf([&] {
                RequireStabilizable(two, Eigen::Vector3d(1, 0, 0), TimeDomain::Continuous,
                                    {"motor", "angle", "rate"});
              }),
              testing::StartsWith("no input moves a mode that does not die out: λ = 0 ± 2i, in "
                                  "angle, rate\n"));
}

TEST(Controllability, RefusesWhatIsNoModel) {
  EXPECT_EQ(ErrorOf([] { ControllabilityOf(MatrixXd(2, 3), MatrixXd(2, 1)); }),
            "A must be 2×2, square, got 2×3");
  EXPECT_EQ(ErrorOf([] { ControllabilityOf(kIntegrators, MatrixXd::Zero(3, 1)); }),
            "B must be 2×1, a row for each state, got 3×1");
  EXPECT_EQ(ErrorOf([] { ControllabilityOf(kIntegrators, Vector2d(0, 1), 1); }),
            "tolerance must be > 0 and < 1, got 1");
  EXPECT_EQ(ErrorOf([] {
              RequireStabilizable(kIntegrators, Vector2d(1, 0), TimeDomain::Continuous, {"x"});
            }),
            "names must be as many as the states, 2, got 1");
}

}  // namespace
}  // namespace pliant
