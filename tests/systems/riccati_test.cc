#include "pliant/systems/riccati.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
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
double Greatest(const MatrixXd& A) { return A.eigenvalues().real().maxCoeff(); }
double Radius(const MatrixXd& A) { return A.eigenvalues().cwiseAbs().maxCoeff(); }

TEST(Lyapunov, EquationsHold) {
  RandomMatrices random(3);
  for (const Index n : {1, 2, 5, 14, 40}) {
    const MatrixXd A = random.Normal(n, n) - 2 * std::sqrt(n) * MatrixXd::Identity(n, n);
    const MatrixXd Q = random.Positive(n);
    const MatrixXd X = SolveLyapunov(A, Q);
    EXPECT_LT((A.transpose() * X + X * A + Q).norm(), 1e-13 * n * Q.norm());
    const MatrixXd F = A / (2 * A.norm());
    const MatrixXd Y = SolveDiscreteLyapunov(F, Q);
    EXPECT_LT((F.transpose() * Y * F - Y + Q).norm(), 1e-13 * n * Q.norm());
  }
}

TEST(Lyapunov, RefusesEigenvaluesWithoutASolution) {
  EXPECT_THAT(ErrorOf([] { SolveLyapunov(Vector2d(1, -1).asDiagonal(), Matrix2d::Identity()); }),
              StartsWith("the Lyapunov equation has no unique solution"));
  EXPECT_THAT(
      ErrorOf([] { SolveDiscreteLyapunov(Vector2d(2, 0.5).asDiagonal(), Matrix2d::Identity()); }),
      StartsWith("the Lyapunov equation has no unique solution"));
}

// 2 a x − b² x²/r + q = 0.
TEST(Riccati, OfOneStateIsAQuadraticEquation) {
  for (const double a : {-2.0, 0.0, 0.7, 30.0})
    for (const double q : {1e-4, 1.0, 50.0}) {
      const double b = 2, r = 3;
      const double x = r * (a + std::sqrt(a * a + b * b * q / r)) / (b * b);
      EXPECT_NEAR(SolveRiccati(One(a), One(b), {One(q), One(r)})(0, 0) / x, 1, 1e-10);
      // x = a² x − a² b² x²/(r + b² x) + q.
      const double f = a * a - 1 + b * b * q / r;
      const double y = r * (f + std::sqrt(f * f + 4 * b * b * q / r)) / (2 * b * b);
      EXPECT_NEAR(SolveDiscreteRiccati(One(a), One(b), {One(q), One(r)})(0, 0) / y, 1, 1e-10);
    }
}

// Known of a double integrator with Q = I, R = 1.
TEST(Riccati, OfADoubleIntegratorIsKnown) {
  const double s = std::sqrt(3);
  const MatrixXd X =
      SolveRiccati(Matrix2d{{0, 1}, {0, 0}}, Vector2d(0, 1), {Matrix2d::Identity(), One(1)});
  EXPECT_TRUE(X.isApprox(Matrix2d{{s, 1}, {1, s}}, 1e-14));
}

TEST(Riccati, SolvesRandomSystems) {
  RandomMatrices random(4);
  for (int i = 0; i < 60; ++i) {
    const Index n = 1 + i % 20, m = (n + 1) / 2;  // one input for many modes needs X without end
    const MatrixXd A = 2 * random.Normal(n, n) / std::sqrt(n), B = random.Normal(n, m);
    const QuadraticCost cost{random.Positive(n), random.Positive(m)};
    const MatrixXd X = SolveRiccati(A, B, cost);
    const MatrixXd K = cost.R.llt().solve(B.transpose() * X);
    EXPECT_LT((A.transpose() * X + X * A - X * B * K + cost.Q).norm(),
              1e-11 * (2 * (A.transpose() * X).norm() + cost.Q.norm()));
    EXPECT_LT(Greatest(A - B * K), 0);
    EXPECT_GT(X.ldlt().vectorD().minCoeff(), 0);

    const MatrixXd Y = SolveDiscreteRiccati(A, B, cost);
    const MatrixXd L = (cost.R + B.transpose() * Y * B).llt().solve(B.transpose() * Y * A);
    EXPECT_LT((A.transpose() * Y * (A - B * L) - Y + cost.Q).norm(),
              1e-10 * ((A.transpose() * Y * A).norm() + Y.norm()));
    EXPECT_LT(Radius(A - B * L), 1);
  }
}

// An independent way: the differential equation −Ẋ = Aᵀ X + X A − X B R⁻¹ Bᵀ X + Q from X = 0, by
// Runge–Kutta steps until it stands, and the difference equation.
TEST(Riccati, IsWhereItsRecursionsComeToRest) {
  RandomMatrices random(5);
  for (int i = 0; i < 10; ++i) {
    const Index n = 4;
    const MatrixXd A = random.Normal(n, n), B = random.Normal(n, 2);
    const QuadraticCost cost{random.Positive(n), random.Positive(2)};
    const MatrixXd G = B * cost.R.inverse() * B.transpose();
    const auto rate = [&](const MatrixXd& X) -> MatrixXd {
      return A.transpose() * X + X * A - X * G * X + cost.Q;
    };
    const MatrixXd found = SolveRiccati(A, B, cost);
    const double h = 0.2 / (A.norm() + (G * found).norm());
    MatrixXd X = MatrixXd::Zero(n, n);
    for (int k = 0; k < 20'000 && rate(X).norm() > 1e-12 * cost.Q.norm(); ++k) {
      const MatrixXd k1 = rate(X), k2 = rate(X + h / 2 * k1);
      const MatrixXd k3 = rate(X + h / 2 * k2), k4 = rate(X + h * k3);
      X += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    EXPECT_TRUE(found.isApprox(X, 1e-9));

    MatrixXd Y = cost.Q, before;
    for (int k = 0; k < 10'000; ++k) {
      before = Y;
      const MatrixXd S = cost.R + B.transpose() * Y * B;
      const MatrixXd L = S.llt().solve(B.transpose() * Y * A);
      Y = A.transpose() * Y * (A - B * L) + cost.Q;
      Y = (Y + Y.transpose()).eval() / 2;  // what is not symmetric would grow
      if ((Y - before).norm() <= 1e-14 * Y.norm()) break;
    }
    EXPECT_TRUE(SolveDiscreteRiccati(A, B, cost).isApprox(Y, 1e-9));
  }
}

// Where the cost sees no growing mode, the least input that makes all die out mirrors it: λ → −λ.
TEST(Riccati, WithoutAWeightMirrorsAGrowingMode) {
  const MatrixXd X = SolveRiccati(One(2), One(1), {One(0), One(1)});
  EXPECT_NEAR(2 - X(0, 0), -2, 1e-13);
}

TEST(Riccati, NamesTheModeThatStandsInTheWay) {
  const MatrixXd A = Vector2d(1, -1).asDiagonal();
  const QuadraticCost cost{Matrix2d::Identity(), One(1)};
  for (const bool sampled : {false, true})
    EXPECT_EQ(ErrorOf([&] {
                if (sampled)
                  SolveDiscreteRiccati(A, Vector2d(0, 1), cost, {"tilt", "speed"});
                else
                  SolveRiccati(A, Vector2d(0, 1), cost, {"tilt", "speed"});
              }),
              "no input moves a mode that does not die out: λ = 1, in tilt\n"
              "give an input that does, or leave these states out");
  EXPECT_EQ(ErrorOf([&] {
              SolveRiccati(Matrix2d{{0, 1}, {0, 0}}, Vector2d(0, 1),
                           {Vector2d(0, 1).asDiagonal(), One(1)}, {"angle", "speed"});
            }),
            "Q does not see a mode that neither grows nor dies out: λ = 0, in angle\n"
            "weigh it, or leave these states out");
  EXPECT_THAT(ErrorOf([&] {
                SolveDiscreteRiccati(One(2), One(1), {One(0), One(1)}, {"angle"});
              }),
              StartsWith("nothing shows a mode that does not die out: λ = 2, in angle\n"));
}

TEST(Riccati, RefusesACostThatIsNone) {
  const auto error = [](const MatrixXd& Q, const MatrixXd& R) {
    return ErrorOf([&] { SolveRiccati(Matrix2d{{0, 1}, {0, 0}}, Vector2d(0, 1), {Q, R}); });
  };
  const Matrix2d I = Matrix2d::Identity();
  EXPECT_EQ(error(One(1), One(1)), "Q must be 2×2, as A is, got 1×1");
  EXPECT_EQ(error(I, I), "R must be 1×1, as many as the columns of B, got 2×2");
  EXPECT_EQ(error(Matrix2d{{1, 1}, {0, 1}}, One(1)),
            "Q must be symmetric; its largest difference from the transpose, got 1");
  EXPECT_EQ(error(Vector2d(1, -2).asDiagonal(), One(1)),
            "Q must be ≥ 0: its least eigenvalue, got -2");
  EXPECT_EQ(error(I, One(0)), "R must be > 0: its least eigenvalue, got 0");
}

}  // namespace
}  // namespace pliant
