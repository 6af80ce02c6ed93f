#include "pliant/controllers/lqr.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "pliant/controllers/state_feedback.h"
#include "pliant/systems/linear_system.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/random_matrices.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

const MatrixXd kOne = MatrixXd::Ones(1, 1);
const Matrix2d kIntegrators{{0, 1}, {0, 0}};

// With Q = diag(1, 0) and R = r the gain of a double integrator is (r^−½, √2 r^−¼): damping 1/√2.
TEST(ContinuousLqr, OfADoubleIntegratorIsDampedByOneOverRootTwo) {
  for (const double r : {0.01, 1.0, 100.0}) {
    const Lqr lqr =
        ContinuousLqr(kIntegrators, Vector2d(0, 1), {Vector2d(1, 0).asDiagonal(), r * kOne});
    EXPECT_NEAR(lqr.K(0, 0) * std::sqrt(r), 1, 1e-12);
    EXPECT_NEAR(lqr.K(0, 1) * std::pow(r, 0.25), std::sqrt(2), 1e-12);
    EXPECT_NEAR(-lqr.modes(0).real() / std::abs(lqr.modes(0)), std::sqrt(0.5), 1e-12);
  }
}

// Kalman's inequality: |1 + K (iω − A)⁻¹ B| ≥ 1, whatever the frequency.
TEST(ContinuousLqr, OfOneInputKeepsItsMargins) {
  RandomMatrices random(6);
  for (int i = 0; i < 20; ++i) {
    const Index n = 4;
    const MatrixXd A = random.Normal(n, n), B = random.Normal(n, 1);
    const Lqr lqr = ContinuousLqr(A, B, {random.Positive(n), kOne});
    for (double w = 1e-2; w < 1e3; w *= 1.3) {
      const std::complex<double> iw(0, w);
      const Eigen::MatrixXcd left = iw * Eigen::MatrixXcd::Identity(n, n) - A;
      const std::complex<double> loop =
          (lqr.K.cast<std::complex<double>>() *
           left.partialPivLu().solve(B.cast<std::complex<double>>()))(0, 0);
      EXPECT_GE(std::abs(1.0 + loop), 1 - 1e-9);
    }
  }
}

/// Σ of the cost along x⁺ = (A − B K) x.
double CostOf(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost, const MatrixXd& K,
              Eigen::VectorXd x) {
  double sum = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Eigen::VectorXd u = -K * x;
    sum += x.dot(cost.Q * x) + u.dot(cost.R * u);
    x = A * x + B * u;
  }
  return sum;
}

TEST(DiscreteLqr, CostsWhatItSaysAndNoOtherGainCostsLess) {
  RandomMatrices random(7);
  for (int i = 0; i < 10; ++i) {
    const Index n = 3;
    const MatrixXd A = 0.6 * random.Normal(n, n), B = random.Normal(n, 1);
    const QuadraticCost cost{random.Positive(n), kOne};
    const Lqr lqr = DiscreteLqr(A, B, cost);
    const Eigen::VectorXd x = random.Normal(n, 1);
    const double least = CostOf(A, B, cost, lqr.K, x);
    EXPECT_NEAR(least / x.dot(lqr.S * x), 1, 1e-10);
    for (int j = 0; j < 5; ++j) {
      const MatrixXd other = lqr.K + 1e-3 * random.Normal(1, n);
      EXPECT_GE(CostOf(A, B, cost, other, x), least * (1 - 1e-12));
    }
  }
}

// For short samples the sampled regulator of h Q and h R is the continuous one.
TEST(DiscreteLqr, TendsToTheContinuousOne) {
  const QuadraticCost cost{Matrix2d::Identity(), kOne};
  const Lqr c = ContinuousLqr(kIntegrators, Vector2d(0, 1), cost);
  double before = 1;
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const LinearModel m = Sampled({kIntegrators, Vector2d(0, 1), Matrix2d::Identity()}, h);
    const double error =
        (DiscreteLqr(m.A, m.B, {h * cost.Q, h * cost.R}).K - c.K).norm() / c.K.norm();
    EXPECT_LT(error, 0.2 * before) << "first order in h";
    before = error;
  }
}

TEST(ContinuousLqr, BringsAPlantToItsOperatingPoint) {
  const Vector2d rest(0.5, 0);
  const Lqr lqr = ContinuousLqr(kIntegrators, Vector2d(0, 1), {Matrix2d::Identity(), kOne});
  DiagramBuilder b;
  auto& plant = b.Add<LinearSystem<double, NumberVector>>(
      "plant", {.output = Names::Numbered(2),
                .model = {kIntegrators, Vector2d(0, 1), Matrix2d::Identity()},
                .initial = Vector2d(-1, 2)});
  auto& law = b.Add<StateFeedback<double>>(
      "law", {.states = Names::Numbered(2), .gain = lqr.K, .rest = rest});
  b.Connect(plant.y, law.x);
  b.Connect(law.u, plant.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const double start = (Vector2d(-1, 2) - rest).norm();
  sim.AdvanceTo(20);  // the slower mode is −0.87 ± 0.5i: e^−17
  EXPECT_LT((sim.Get(plant.x) - rest).norm(), 1e-5 * start);
}

}  // namespace
}  // namespace pliant
