#include "pliant/estimators/kalman_filter.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "pliant/estimators/luenberger_observer.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/random_matrices.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using Filter = KalmanFilter<NumberVector, NumberVector>;
using ScalarFilter = KalmanFilter<double, double>;

MatrixXd One(double x) { return MatrixXd::Constant(1, 1, x); }

// Of a constant that is measured k times with variance v, from P⁻_0 = p: mean of information.
TEST(KalmanFilter, OfAConstantIsTheWeightedMean) {
  const double p = 4, v = 0.5;
  BlockTester<ScalarFilter> t({.model = {One(1), One(0), One(1)},
                               .noise = {One(0), One(v)},
                               .initial = VectorXd::Constant(1, 10),
                               .covariance = One(p),
                               .period = 1ms});
  t.Set(t->u, 0);
  double sum = 10 / p;
  for (int k = 1; k <= 100; ++k) {
    const double y = std::sin(k);
    sum += y / v;
    t.Set(t->y, y);
    t.Tick();
    const double information = 1 / p + k / v;
    EXPECT_NEAR(t.Get(t->x)(0), sum / information, 1e-12);
    EXPECT_NEAR(t.Get(t->covariance)(0, 0) * information, 1, 1e-12);
    const double before = 1 / (1 / p + (k - 1) / v);
    EXPECT_NEAR(t.Get(t->innovation_covariance)(0, 0), before + v, 1e-12);
  }
}

/// A random model that may grow, and the filter of it.
struct Case {
  explicit Case(unsigned seed, Index n = 4, Index p = 2) {
    RandomMatrices random(seed);
    model = {0.5 * random.Normal(n, n), random.Normal(n, 1), random.Normal(p, n)};
    noise = {0.1 * random.Positive(n), 0.1 * random.Positive(p)};
    covariance = random.Positive(n);
  }
  Filter::Options options() const {
    return {.input = Names::Numbered(1, "u"),
            .output = Names::Numbered(model.C.rows(), "y"),
            .model = model,
            .noise = noise,
            .covariance = covariance,
            .period = 1ms};
  }
  LinearModel model;
  NoiseCovariance noise;
  MatrixXd covariance;
};

// The covariance of the textbook, P − P Cᵀ S⁻¹ C P, and the estimate with it.
TEST(KalmanFilter, IsTheTextbooksRecursion) {
  const Case c(9);
  RandomMatrices random(10);
  BlockTester<Filter> t(c.options());
  const auto& [A, B, C, D] = c.model;
  VectorXd x = VectorXd::Zero(4);
  MatrixXd P = c.covariance;
  for (int k = 0; k < 50; ++k) {
    const VectorXd y = random.Normal(2, 1), u = random.Normal(1, 1);
    t.Set(t->u, NumberVector(u));
    t.Set(t->y, NumberVector(y));
    t.Tick();
    const MatrixXd S = C * P * C.transpose() + c.noise.measurement;
    const VectorXd nu = y - C * x;
    x += P * C.transpose() * S.inverse() * nu;
    P -= P * C.transpose() * S.inverse() * C * P;
    EXPECT_TRUE(t.Get(t->x).isApprox(x, 1e-10));
    EXPECT_TRUE(t.Get(t->covariance).isApprox(P, 1e-10));
    EXPECT_TRUE(t.Get(t->innovation).isApprox(nu, 1e-9));
    EXPECT_TRUE(t.Get(t->innovation_covariance).isApprox(S, 1e-10));
    x = A * x + B * u;
    P = A * P * A.transpose() + c.noise.process;
  }
}

TEST(KalmanFilter, ComesToTheSteadyGain) {
  const Case c(11);
  const SteadyKalman steady = SteadyKalmanOf(c.model, c.noise);
  BlockTester<Filter> t(c.options());
  t.Set(t->u, {0.0});
  t.Set(t->y, {0.0, 0.0});
  for (int k = 0; k < 300; ++k) t.Tick();
  EXPECT_TRUE(t.Get(t->covariance).isApprox(steady.corrected, 1e-10));

  // From then on it is an observer with that gain.
  BlockTester<LuenbergerObserver<NumberVector, NumberVector>> o({.input = Names::Numbered(1, "u"),
                                                                 .output = Names::Numbered(2, "y"),
                                                                 .model = c.model,
                                                                 .gain = steady.gain,
                                                                 .period = 1ms});
  RandomMatrices random(12);
  for (int k = 0; k < 100; ++k) {
    const NumberVector y = random.Normal(2, 1);
    t.Set(t->y, y);
    t.Tick();
    o.Set(o->u, {0.0});
    o.Set(o->y, y);
    o.Tick();
    EXPECT_LT((t.Get(t->x) - o.Get(o->x)).norm(), 1e-9 * (1 + y.norm()));
  }
}

// Of a plant as it is modelled: ν has covariance S and is white, the error has covariance P. Of N
// samples a correlation of independent numbers is within 4.5/√N but for 1 in 10⁵ seeds; those of
// normalised squares spread √2 as far.
TEST(KalmanFilter, ItsInnovationIsWhite) {
  const Case c(13);
  const SteadyKalman steady = SteadyKalmanOf(c.model, c.noise);
  const Eigen::LLT<MatrixXd> w(c.noise.process), v(c.noise.measurement);
  const Eigen::LLT<MatrixXd> S(c.model.C * steady.predicted * c.model.C.transpose() +
                               c.noise.measurement);
  const Eigen::LLT<MatrixXd> P(steady.corrected);
  RandomMatrices random(14);
  BlockTester<Filter> t(c.options());
  constexpr int kWarmUp = 200, kSamples = 40'000;
  VectorXd x = VectorXd::Zero(4), before;
  MatrixXd square = MatrixXd::Zero(2, 2), lagged = MatrixXd::Zero(2, 2);
  MatrixXd error = MatrixXd::Zero(4, 4);
  for (int k = 0; k < kWarmUp + kSamples; ++k) {
    const VectorXd u = random.Normal(1, 1);
    t.Set(t->u, NumberVector(u));
    t.Set(t->y, NumberVector(c.model.C * x + v.matrixL() * random.Normal(2, 1)));
    t.Tick();
    const VectorXd nu = S.matrixL().solve(VectorXd(t.Get(t->innovation)));
    if (k >= kWarmUp) {
      square += nu * nu.transpose() / kSamples;
      lagged += nu * before.transpose() / kSamples;
      const VectorXd e = P.matrixL().solve(VectorXd(t.Get(t->x) - x));
      error += e * e.transpose() / kSamples;
    }
    before = nu;
    x = c.model.A * x + c.model.B * u + w.matrixL() * random.Normal(4, 1);
  }
  const double bound = 4.5 / std::sqrt(kSamples);
  EXPECT_LT((square - MatrixXd::Identity(2, 2)).cwiseAbs().maxCoeff(), std::sqrt(2) * bound);
  EXPECT_LT(lagged.cwiseAbs().maxCoeff(), bound);
  // Errors of one tick to the next are correlated: fewer samples, by the slowest mode.
  const double slow = steady.modes.cwiseAbs().maxCoeff();
  EXPECT_LT((error - MatrixXd::Identity(4, 4)).cwiseAbs().maxCoeff(),
            std::sqrt(2) * bound * std::sqrt((1 + slow) / (1 - slow)));
}

TEST(KalmanFilter, ATickWithoutAMeasurementOnlyPredicts) {
  const Case c(15);
  BlockTester<Filter> t(c.options());
  t.Set(t->u, {1.0});
  t.Set(t->y, {std::numeric_limits<double>::quiet_NaN(), 0.0});
  t.Set(t->valid, false);
  t.Tick();
  EXPECT_TRUE(t.Get(t->x).isZero(0)) << "not even NaN comes through";
  EXPECT_EQ(t.Get(t->covariance), c.covariance);
  EXPECT_TRUE(t.Get(t->innovation).isZero(0));
  t.Tick();
  EXPECT_TRUE(t.Get(t->x).isApprox(c.model.B.col(0), 1e-15));
  EXPECT_TRUE(
      t.Get(t->covariance)
          .isApprox(c.model.A * c.covariance * c.model.A.transpose() + c.noise.process, 1e-14));
  t.Set(t->valid, true);
  t.Tick();
  EXPECT_TRUE(t.Get(t->x).hasNaN()) << "NaN that is measured stays";
}

// With measurements 10⁸ times as good as what is known, P − P Cᵀ S⁻¹ C P is no covariance in
// round-off.
TEST(KalmanFilter, ItsCovarianceStaysOne) {
  BlockTester<ScalarFilter> t(
      {.model = {Matrix2d{{1, 1e-3}, {0, 1}}, Vector2d(0, 1e-3), Eigen::RowVector2d(1, 0)},
       .noise = {1e-16 * Matrix2d::Identity(), One(1e-16)},
       .covariance = Matrix2d::Identity(),
       .period = 1ms});
  t.Set(t->u, 0);
  t.Set(t->y, 0);
  for (int k = 0; k < 1000; ++k) {
    t.Tick();
    const MatrixXd P = t.Get(t->covariance);
    ASSERT_EQ(P, P.transpose());
    ASSERT_GT(P(0, 0), 0);
    ASSERT_GE(P.determinant(), 0);
  }
}

TEST(KalmanFilter, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<Filter>(Case(16).options()));
  ExpectBlockLaws(BlockTester<Filter>(Case(17, 14, 7).options()));
}

TEST(KalmanFilter, GoesIntoAFileAndBack) {
  const TemporaryDirectory directory;
  const Case c(18);
  const auto run = [](BlockTester<Filter>& t) {
    t.Set(t->u, {1.0});
    t.Set(t->y, {1.0, 2.0});
    for (int k = 0; k < 5; ++k) t.Tick();
  };
  BlockTester<Filter> one(c.options()), other(c.options());
  run(one);
  one.simulator().Save(directory.path() / "filter");
  other.simulator().Restore(directory.path() / "filter");
  run(one);
  run(other);
  EXPECT_EQ(one.Get(one->x), other.Get(other->x));
  EXPECT_EQ(one.Get(one->covariance), other.Get(other->covariance));
}

TEST(KalmanFilter, RefusesACovarianceThatIsNone) {
  const auto error = [](const MatrixXd& P) {
    return ErrorOf([&] {
      BlockTester<ScalarFilter>({.model = {One(1), One(1), One(1)},
                                 .noise = {One(1), One(1)},
                                 .covariance = P,
                                 .period = 1ms});
    });
  };
  EXPECT_EQ(error(Matrix2d::Identity()),
            "block: covariance must be 1×1, a row and a column for each number, got 2×2");
  EXPECT_EQ(error(One(-1)), "block: covariance must be ≥ 0: its least eigenvalue, got -1");
}

}  // namespace
}  // namespace pliant
