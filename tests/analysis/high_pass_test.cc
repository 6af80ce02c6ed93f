#include "pliant/analysis/high_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Eigen::Index kRows = 4001;  // of 1 ms

Eigen::MatrixXd Sine(double hz, double phase) {
  return (2 * kPi * hz * 1e-3 * Eigen::ArrayXd::LinSpaced(kRows, 0, kRows - 1) + phase)
      .sin()
      .transpose();
}

/// By which part of a sine its filtered one differs from `gain` times it, in the middle.
double Off(double hz, double cutoff, double gain) {
  const Eigen::MatrixXd u = Sine(hz, 0.3), y = HighPass(u, cutoff, 1ms);
  return (y - gain * u).middleCols(1500, 1000).cwiseAbs().maxCoeff();
}

double Gain(double hz, double cutoff) {
  return 1 / (1 + std::pow(std::tan(kPi * cutoff * 1e-3) / std::tan(kPi * hz * 1e-3), 4));
}

// In phase with what it was: no delay. What the ends stir up has died down to e^{−2π f_c t/√2}.
TEST(HighPass, GivesASineItsGainAndNoPhase) {
  for (const double cutoff : {5.0, 20.0, 100.0})
    for (const double hz : {0.5, 4.0, 20.0, 50.0, 333.0})
      EXPECT_LT(Off(hz, cutoff, Gain(hz, cutoff)), 1e-10) << hz << " Hz above " << cutoff;
  EXPECT_NEAR(Gain(20, 20), 0.5, 1e-15);
}

TEST(HighPass, TakesAwayARamp) {
  Eigen::MatrixXd ramp(2, kRows);
  ramp.row(0) = Eigen::RowVectorXd::LinSpaced(kRows, 3, 7);
  ramp.row(1).setConstant(-5);
  const Eigen::MatrixXd y = HighPass(ramp, 20, 1ms);
  // A second-order zero at 0 Hz; what the beginning stirs up, 0.15 s before the first row, is
  // e^{−2π 3/√2} of what 2 zeros leave of a slope of 1e-3 a row.
  EXPECT_LT(y.row(0).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(y.row(1).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(HighPass, FiltersEachRowByItself) {
  Eigen::MatrixXd both(2, kRows);
  both << Sine(30, 0), Sine(3, 1);
  const Eigen::MatrixXd y = HighPass(both, 20, 1ms);
  EXPECT_EQ(y.row(0), HighPass(Sine(30, 0), 20, 1ms).row(0));
  EXPECT_EQ(y.row(1), HighPass(Sine(3, 1), 20, 1ms).row(0));
}

TEST(HighPass, TakesFewRows) {
  EXPECT_EQ(HighPass(Eigen::MatrixXd(2, 0), 20, 1ms).cols(), 0);
  EXPECT_EQ(HighPass(Eigen::MatrixXd::Constant(1, 1, 3.0), 20, 1ms)(0, 0), 0);
  EXPECT_TRUE(HighPass(Eigen::MatrixXd::Random(1, 3), 20, 1ms).allFinite());
}

TEST(HighPass, RefusesFrequenciesThatRowsCannotShow) {
  const auto error = [](double hz) { return ErrorOf([&] { HighPass(Sine(1, 0), hz, 1ms); }); };
  EXPECT_EQ(error(500),
            "the frequency above which to look must be > 0 and < 500 Hz, half the rate of the "
            "rows, got 500");
  EXPECT_EQ(error(0),
            "the frequency above which to look must be > 0 and < 500 Hz, half the rate of the "
            "rows, got 0");
}

}  // namespace
}  // namespace pliant
