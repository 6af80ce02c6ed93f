#include "pliant/analysis/friction_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pliant/analysis/friction_report.h"

namespace pliant {
namespace {

using Eigen::Index;
using testing::HasSubstr;

constexpr DriveFigures kDrive{.torque_per_ampere = 10, .reflected_inertia = 0.4};

/// Three levels of the current, 500 samples each, whose velocity settles with 20 ms. Friction is
/// 2 + v; the link takes 0.5 N·m.
Samples Steps() {
  Samples s;
  s.joints = {"elbow"};
  s.begin = {0};
  const Index n = 1500;
  s.time = Eigen::VectorXd::LinSpaced(n, 0, 1.499);
  s.velocity = s.acceleration = s.current = s.torque = Eigen::RowVectorXd::Zero(n);
  double last = 0;
  for (Index k = 0; k < n; ++k) {
    const double level = std::vector<double>{0.2, 0.6, 1.0}[static_cast<std::size_t>(k / 500)];
    if (k % 500 == 0 && k > 0) last = level - 0.4;
    const double decay = std::exp(-0.05 * static_cast<double>(k % 500));
    s.velocity(k) = level + (last - level) * decay;
    s.acceleration(k) = 50 * (level - last) * decay;
    s.torque(k) = 0.5;
    s.current(k) = (0.5 + 2 + level) / 10;
  }
  return s;
}

TEST(FrictionLog, IsTheTorqueThatIsLeft) {
  const Samples s = Steps();
  const FrictionLog log = FrictionOf(s, 0, kDrive);
  // After the transients nothing accelerates: y = κ i − τ = 2 + v, within 2 % of the last change.
  for (Index k = 0; k < log.samples.velocity.size(); ++k)
    EXPECT_NEAR(log.samples.torque(k), 2 + log.samples.velocity(k), 0.02 * 0.4 * (1 + 0.4 * 50));
}

TEST(FrictionLog, LeavesOutWhatHasNotSettled) {
  const FrictionLog log = FrictionOf(Steps(), 0, kDrive);
  EXPECT_EQ(log.steps, 2);
  // exp(−k/20) < 2 % from k = 78 on; means of five reach it 2 samples away from that. The first
  // change is measured from the mean of the first five samples.
  EXPECT_NEAR(static_cast<double>(log.transient), 3 * 78, 12);
  EXPECT_EQ(log.samples.begin.size(), 3u);
  EXPECT_EQ(log.samples.velocity.size(), 1500 - log.transient);
}

TEST(FrictionLog, KeepsAllOfALogWithoutSteps) {
  Samples s = Steps();
  for (Index k = 0; k < s.time.size(); ++k) {
    s.velocity(k) = std::sin(0.002 * static_cast<double>(k));
    s.current(k) = 0.2 * s.velocity(k) + 0.05;
  }
  const FrictionLog log = FrictionOf(s, 0, kDrive);
  EXPECT_EQ(log.steps, 0);
  EXPECT_EQ(log.transient, 0);
  EXPECT_EQ(log.samples.velocity.size(), 1500);
}

/// A sine of 0.2 Hz for 15 s at 1 kHz against friction 2 + v.
Samples Sine(double noise) {
  Samples s;
  s.joints = {"elbow"};
  s.begin = {0};
  const Index n = 15'000;
  s.time = Eigen::VectorXd::LinSpaced(n, 0, 14.999);
  s.velocity = s.acceleration = s.current = s.torque = Eigen::RowVectorXd::Zero(n);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (Index k = 0; k < n; ++k) {
    const double v = std::sin(2 * std::numbers::pi * 0.2 * s.time(k) + 0.3);
    s.current(k) = (std::copysign(2, v) + v) / 10;
    s.velocity(k) = v + noise * normal(random);
  }
  return s;
}

TEST(FrictionLog, AReversalIsNoStepOfTheCurrent) {
  for (const double noise : {0.0, 0.01}) {
    const FrictionLog log = FrictionOf(Sine(noise), 0, kDrive);
    EXPECT_EQ(log.steps, 0) << noise;
    EXPECT_EQ(log.samples.velocity.size(), 15'000) << noise;
  }
}

TEST(FrictionLog, AStepFromRestIsOneInNoise) {
  Samples s = Steps();
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (Index k = 0; k < s.time.size(); ++k) {
    if (k < 500) {
      s.velocity(k) = 0;
      s.current(k) = 0.1;
    }
    s.velocity(k) += 0.01 * normal(random);
  }
  EXPECT_EQ(FrictionOf(s, 0, kDrive).steps, 2);
}

TEST(FrictionLog, TheBorderOfFilesIsNoStepOfTheCurrent) {
  Samples s = Steps();
  s.begin = {0, 700};
  for (Index k = 0; k < s.time.size(); ++k) {
    s.velocity(k) = k < 700 ? 0.2 : 1.0;
    s.current(k) = k < 700 ? 0.27 : 0.35;
  }
  const FrictionLog log = FrictionOf(s, 0, kDrive);
  EXPECT_EQ(log.steps, 0);
  EXPECT_EQ(log.samples.velocity.size(), 1500);
}

TEST(FrictionLog, FindsWhereAJointAtRestBreaksAway) {
  Samples s = Steps();
  for (Index k = 0; k < s.time.size(); ++k) {
    const bool moves = k >= 700;
    s.velocity(k) = moves ? 0.5 : 0;
    s.acceleration(k) = 0;
    s.current(k) = 0.05 + 0.0005 * static_cast<double>(k);  // slowly more, 0.4 A at break-away
  }
  const FrictionLog log = FrictionOf(s, 0, kDrive, 0.01);
  ASSERT_EQ(log.samples.break_away.size(), 1);
  // The mean of the samples 695 to 699.
  EXPECT_NEAR(log.samples.break_away(0), 10 * (0.05 + 0.0005 * 697) - 0.5, 1e-9);
}

TEST(FrictionLog, AsksAboutUnitsThatLookWrong) {
  const auto doubt = [](double velocity, double current, double torque) {
    Samples s = Steps();
    s.velocity *= velocity;
    s.current *= current;
    s.torque *= torque;
    const FrictionLog log = FrictionOf(s, 0, kDrive);
    std::string all;
    for (const std::string& one : log.doubts) all += one + "\n";
    return all;
  };
  EXPECT_EQ(doubt(1, 1, 1), "");
  EXPECT_THAT(doubt(57.3, 1, 1), HasSubstr("is the velocity in deg/s?"));
  EXPECT_THAT(doubt(1e-4, 1, 1), HasSubstr("it hardly moves"));
  EXPECT_THAT(doubt(1, 1000, 1), HasSubstr("is it in mA?"));
  EXPECT_THAT(doubt(1, 1, 5000), HasSubstr("is it in mN·m?"));
  EXPECT_THAT(doubt(1, -1, 1), HasSubstr("has the torque the sign of the current?"));
}

TEST(FrictionReport, ShowsWhatWasIdentifiedAndWhatWasNot) {
  FrictionResult result;
  result.log = FrictionOf(Steps(), 0, kDrive);
  result.fit = FitFriction(result.log.samples, {.offset = true, .folds = 0});
  const std::string text = FrictionText(result);
  EXPECT_THAT(text, HasSubstr("elbow: coulomb_viscous, "));
  EXPECT_THAT(text, HasSubstr("coulomb is not identified: with one direction only, an offset is "
                              "not told from coulomb"));
  const Report report = FrictionReportOf({result}, "a.csv", "1500 rows");
  ASSERT_EQ(report.figures.size(), 1u);
  EXPECT_EQ(report.figures[0].name, "friction_elbow");
  // Without c there is no fit that could leave something.
  EXPECT_EQ(report.figures[0].panels.size(), 1u);
  EXPECT_EQ(report.tables[0].rows.size(), 3u);
}

TEST(FrictionReport, BearsAJointOfWhichNothingIsKnown) {
  FrictionResult result;
  result.log = FrictionOf(Steps(), 0, kDrive);
  result.fit.unidentified = {{"friction", "it stands still"}};
  EXPECT_THAT(FrictionText(result), HasSubstr("friction is not identified: it stands still"));
  EXPECT_THAT(FrictionText(result), testing::Not(HasSubstr("residual")));
  // The samples alone, without a curve.
  const Figure figure = FigureOf(result);
  ASSERT_EQ(figure.panels.size(), 1u);
  EXPECT_EQ(figure.panels[0].curves.size(), 1u);
}

}  // namespace
}  // namespace pliant
