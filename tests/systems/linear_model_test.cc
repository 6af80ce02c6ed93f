#include "pliant/systems/linear_model.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/random_matrices.h"

namespace pliant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;

/// A double integrator.
const LinearModel kCart{Matrix2d{{0, 1}, {0, 0}}, Eigen::Vector2d(0, 1), Eigen::RowVector2d(1, 0)};

TEST(Sampled, IsExactForADoubleIntegrator) {
  const double h = 0.3;
  const LinearModel s = Sampled(kCart, h);
  EXPECT_TRUE(s.A.isApprox(Matrix2d{{1, h}, {0, 1}}, 1e-15));
  EXPECT_TRUE(s.B.isApprox(Eigen::Vector2d(h * h / 2, h), 1e-15));
  EXPECT_EQ(s.C, kCart.C);
  EXPECT_TRUE(s.feedthrough().isZero(0));
}

TEST(Sampled, IsExactForALag) {
  const double a = 3, h = 0.2;
  const LinearModel s =
      Sampled({MatrixXd::Constant(1, 1, -a), MatrixXd::Constant(1, 1, a), MatrixXd::Ones(1, 1)}, h);
  EXPECT_NEAR(s.A(0, 0), std::exp(-a * h), 1e-15);
  EXPECT_NEAR(s.B(0, 0), 1 - std::exp(-a * h), 1e-15);
}

// A half step twice is a whole one: e^{A(s+t)} = e^{As} e^{At}.
TEST(Sampled, TwoHalfStepsAreOne) {
  RandomMatrices random(1);
  for (int i = 0; i < 20; ++i) {
    const LinearModel m{random.Normal(5, 5), random.Normal(5, 2), random.Normal(1, 5)};
    const LinearModel whole = Sampled(m, 0.2), half = Sampled(m, 0.1);
    EXPECT_TRUE(whole.A.isApprox(half.A * half.A, 1e-13));
    EXPECT_TRUE(whole.B.isApprox(half.A * half.B + half.B, 1e-13));
    const MatrixXd W = random.Positive(5);
    const MatrixXd noise = SampledNoise(m.A, W, 0.1);
    EXPECT_TRUE(
        SampledNoise(m.A, W, 0.2).isApprox(half.A * noise * half.A.transpose() + noise, 1e-12));
  }
}

// White noise of density 1 on the acceleration: known of constant-velocity models.
TEST(SampledNoise, IsExactForADoubleIntegrator) {
  const double h = 0.5;
  const Matrix2d W = Eigen::Vector2d(0, 1).asDiagonal();
  EXPECT_TRUE(SampledNoise(kCart.A, W, h)
                  .isApprox(Matrix2d{{h * h * h / 3, h * h / 2}, {h * h / 2, h}}, 1e-14));
}

TEST(TransferFunction, HasItsResponse) {
  const std::vector<double> b{2, -1, 3}, a{0.5, 2, 4, 1};
  for (const std::size_t zeros : {std::size_t{0}, std::size_t{1}}) {
    std::vector<double> top = b;
    top.insert(top.begin(), zeros, 1.5);
    const LinearModel m = TransferFunction(top, a);
    for (const std::complex<double> s : {std::complex<double>(0, 0), {0, 2}, {-1, 0.3}}) {
      const auto poly = [&](const std::vector<double>& c) {
        std::complex<double> sum = 0;
        for (const double x : c) sum = sum * s + x;
        return sum;
      };
      const Eigen::MatrixXcd sI = s * Eigen::MatrixXcd::Identity(3, 3);
      const Eigen::MatrixXcd inverse = (sI - m.A).inverse();
      const std::complex<double> G =
          (m.C * inverse * m.B)(0, 0) + std::complex<double>(m.feedthrough()(0, 0));
      EXPECT_LT(std::abs(G - poly(top) / poly(a)), 1e-12) << "round-off";
    }
  }
}

TEST(TransferFunction, RefusesWhatIsNone) {
  EXPECT_EQ(ErrorOf([] { TransferFunction({1}, {1}); }),
            "a must have at least two coefficients, for a state, got 1");
  EXPECT_EQ(ErrorOf([] { TransferFunction({1}, {0, 1}); }), "a₀ must not be 0, got 0");
  EXPECT_EQ(ErrorOf([] {
              TransferFunction({1, 2, 3}, {1, 1});
            }),
            "b must have from one coefficient to as many as a, 2, got 3");
}

TEST(LinearModel, NamesTheMatrixThatDoesNotFit) {
  const auto error = [](const LinearModel& m) { return ErrorOf([&] { RequireModel(m); }); };
  EXPECT_EQ(error(kCart), "no error");
  EXPECT_EQ(error({}), "A must have a row, the model a state");
  LinearModel m = kCart;
  m.A = MatrixXd::Zero(2, 3);
  EXPECT_EQ(error(m), "A must be 2×2, square, got 2×3");
  m = kCart;
  m.B = MatrixXd::Zero(3, 1);
  EXPECT_EQ(error(m), "B must be 2×1, a row for each state, got 3×1");
  m = kCart;
  m.B = MatrixXd::Zero(2, 0);
  EXPECT_EQ(error(m), "B must have a column, the model an input");
  m = kCart;
  m.C = MatrixXd::Zero(1, 3);
  EXPECT_EQ(error(m), "C must be 1×2, a column for each state, got 1×3");
  m.C = MatrixXd::Zero(0, 2);
  EXPECT_EQ(error(m), "C must have a row, the model an output");
  m = kCart;
  m.D = MatrixXd::Zero(2, 1);
  EXPECT_EQ(error(m), "D must be 1×1, as C and B are, got 2×1");
  m = kCart;
  m.A(0, 0) = NAN;
  EXPECT_EQ(error(m), "A must be finite");
  EXPECT_EQ(ErrorOf([] { Sampled(kCart, 0); }), "h must be > 0 s, got 0");
  EXPECT_EQ(ErrorOf([] { SampledNoise(kCart.A, MatrixXd::Ones(1, 1), 1); }),
            "W must be 2×2, as A is, got 1×1");
}

}  // namespace
}  // namespace pliant
