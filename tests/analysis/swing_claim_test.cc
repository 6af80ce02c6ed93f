#include "pliant/analysis/swing_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// x = x_∞ + a e^{s t} of the root s of s² + 2 ζ ω s + ω², its real part.
Eigen::VectorXd Free(const Eigen::VectorXd& t, double omega, double zeta, double rest) {
  const std::complex<double> s = omega * (-zeta + std::sqrt(std::complex<double>(zeta * zeta - 1)));
  return t.unaryExpr([&](double time) {
    return rest + 0.04 * (std::complex<double>(1, 0.3) * std::exp(s * time)).real() +
           (zeta > 1 ? 0.02 * std::exp(omega * (-zeta - std::sqrt(zeta * zeta - 1)) * time) : 0.0);
  });
}

RunData Recorded(double omega, double zeta) {
  RunData run;
  run.name = "free";
  RecordedSignal signal{{"a.error", "position", {"[x]", "[y]"}, {"m", "m"}}, {}, {}};
  signal.times = Eigen::VectorXd::LinSpaced(401, 0, 2);
  signal.numbers.resize(2, 401);
  signal.numbers << Free(signal.times, omega, zeta, 0.003).transpose(),
      Eigen::RowVectorXd::Zero(401);
  run.log = Recording({signal}, {});
  return run;
}

SwingClaim Of(double frequency, double damping) {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .basis = "basis",
          .run = "free",
          .signal = "a.error",
          .element = "x",
          .from_s = 0.2,
          .to_s = 1.5,
          .frequency = frequency,
          .damping = damping,
          .within = 0.05};
}

TEST(FitSwing, FindsFrequencyAndDampingAlsoWhereItDoesNotOvershoot) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(401, 0, 2);
  for (const double omega : {5.0, 7.07, 12.9})
    for (const double zeta : {0.1, 0.4, 0.6, 1.1}) {
      const Swing swing = FitSwing(t.array() + 1, Free(t, omega, zeta, -0.01));
      // Trapezoids of 5 ms: (λ h)²/12 of either, λ the faster rate, at most 20 1/s.
      EXPECT_NEAR(swing.frequency, omega, 2e-3 * omega) << omega << " " << zeta;
      EXPECT_NEAR(swing.damping, zeta, 3e-3 * std::max(1.0, zeta)) << omega << " " << zeta;
    }
}

TEST(FitSwing, RefusesTooFewRows) {
  EXPECT_EQ(ErrorOf([] { FitSwing(Eigen::VectorXd::Zero(9), Eigen::VectorXd::Zero(9)); }),
            "a swing is fitted to at least 10 rows, got 9");
}

TEST(SwingClaim, HoldsWithinItsPartOfBoth) {
  const RunData run = Recorded(5, 0.4);
  EXPECT_TRUE(Of(5, 0.4).Check(Runs({&run})).holds);
  EXPECT_TRUE(Of(5.2, 0.41).Check(Runs({&run})).holds);
  EXPECT_FALSE(Of(5.4, 0.4).Check(Runs({&run})).holds);
  EXPECT_FALSE(Of(5, 0.43).Check(Runs({&run})).holds);
}

TEST(SwingClaim, SaysWhatItFound) {
  const RunData run = Recorded(5, 0.4);
  const Claim claim = Of(5, 0.4).Check(Runs({&run}));
  EXPECT_EQ(claim.measured, "a.error[x] swings with 5.00 rad/s and a damping ratio of 0.400");
  EXPECT_EQ(claim.criterion, "5.00 rad/s and 0.400, each to 5 %");
}

TEST(SwingClaim, DoesNotHoldOfWhatDoesNotSwing) {
  RunData run = Recorded(5, 0.4);
  std::vector<RecordedSignal> signals = run.log.signals();
  signals[0].numbers.row(0).setZero();
  run.log = Recording(signals, {});
  EXPECT_FALSE(Of(5, 0.4).Check(Runs({&run})).holds);
}

TEST(SwingClaim, RefusesTimesOutsideOfTheRunAndElementsThatAreNone) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  SwingClaim claim = Of(5, 0.4);
  claim.from_s = 2;
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }), "from_s must be <= to_s, got 2 and 1.5");
  claim.element = "q";
  const RunData run = Recorded(5, 0.4);
  EXPECT_THAT(ErrorOf([&] { claim.RequireSound(run.log); }), testing::HasSubstr("q"));
}

}  // namespace
}  // namespace pliant
