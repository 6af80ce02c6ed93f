#include "pliant/analysis/iso_9283.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(PoseAccuracy, IsOfTheMeanAndOfTheScatterAboutIt) {
  // Two metres apart about (1, 0, 0), so l = (1, 1) and S_l = 0; commanded 3 m beside the mean.
  const std::vector<Pose> attained{{.position = {0, 0, 0}}, {.position = {2, 0, 0}}};
  const PoseAccuracy two = PoseAccuracyOf(attained, {.position = {1, 3, 0}});
  EXPECT_DOUBLE_EQ(two.position, 3);
  EXPECT_DOUBLE_EQ(two.position_repeatability, 1);
  // l = (1, 1, 0) about the mean 0: l̄ = 2/3, S_l² = (2/9 + 4/9)/2 = 1/3.
  const PoseAccuracy three = PoseAccuracyOf(
      {{.position = {-1, 0, 0}}, {.position = {1, 0, 0}}, {.position = {0, 0, 0}}}, Pose{});
  EXPECT_DOUBLE_EQ(three.position, 0);
  EXPECT_NEAR(three.position_repeatability, 2.0 / 3 + std::sqrt(3.0), 1e-15);
}

TEST(PoseAccuracy, TakesTurnsFromTheCommandedOrientationAxisByAxis) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(2, Vector3d(1, 2, 3).normalized()).matrix();
  const auto turned = [&](double angle) {
    return Pose{.rotation = Eigen::AngleAxisd(angle, Vector3d::UnitY()) * R};
  };
  const PoseAccuracy of = PoseAccuracyOf({turned(0.01), turned(0.03)}, {.rotation = R});
  // 1e-8: AngleAxis of a rotation this small, from the vector part of a quaternion.
  EXPECT_NEAR((of.rotation - Vector3d(0, 0.02, 0)).norm(), 0, 1e-8);
  EXPECT_NEAR((of.rotation_repeatability - Vector3d(0, 3 * std::sqrt(0.0002), 0)).norm(), 0, 1e-8);
}

TEST(PoseAccuracy, WantsTwoVisits) {
  EXPECT_EQ(ErrorOf([] { PoseAccuracyOf({Pose{}}, Pose{}); }),
            "the accuracy of a pose is of at least 2 visits, got 1");
}

/// Rounds of 1 s on a circle of radius 1 m, 1 ms apart, with another radius in each round, later
/// than commanded.
struct Circles {
  explicit Circles(const std::vector<double>& radii, double late_s = 0.03)
      : times{Eigen::VectorXd::LinSpaced(1000 * std::ssize(radii) + 501, -0.25,
                                         static_cast<double>(radii.size()) + 0.25)},
        commanded(3, times.size()),
        attained(3, times.size()) {
    for (Eigen::Index k = 0; k < times.size(); ++k) {
      const double t = times(k), late = t - late_s;
      commanded.col(k) = Of(1, t);
      const auto round = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(std::floor(late)),
                                                    0, std::ssize(radii) - 1);
      attained.col(k) = Of(radii[static_cast<std::size_t>(round)], late);
    }
  }
  static Vector3d Of(double radius, double t) {
    const double angle = 2 * std::numbers::pi * t;
    return {radius * std::cos(angle), radius * std::sin(angle), 0.5};
  }

  Eigen::VectorXd times;
  Series commanded, attained;
};

// A chord of 2π/1000 lies at most r (2π/1000)²/8 = 5e-6 m inside of its arc.
constexpr double kChord = 5e-6;

TEST(PathAccuracy, IsAcrossThePathWhateverTheDelay) {
  const std::vector<double> radii{1.02, 1.00, 1.04};
  const Circles circles(radii);
  const PathAccuracy of = PathAccuracyOf(circles.times, circles.commanded, circles.attained,
                                         {.from_s = 0, .period_s = 1, .count = 3});
  EXPECT_EQ(of.points, 200);
  EXPECT_NEAR(of.accuracy, 0.02, kChord);
  // l = (0, 0.02, 0.02), S_l² = (0.04²/9 + 2 · 0.02²/9)/2
  EXPECT_NEAR(of.repeatability, 0.04 / 3 + 3 * std::sqrt((0.0016 + 0.0008) / 18), 4 * kChord);
}

TEST(PathAccuracy, LeavesOutWhereThePathTurnsBack) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(4001, 0, 4);
  Series commanded = Series::Zero(3, t.size());
  commanded.row(0) = (1 - (2 * std::numbers::pi * t.array()).cos()) / 2;
  Series attained = 0.95 * commanded;  // never comes to the far end
  attained.row(1).setConstant(0.003);
  const PathAccuracy of =
      PathAccuracyOf(t, commanded, attained, {.from_s = 0, .period_s = 1, .count = 4});
  // |sin 2πt| ≥ ½ in two thirds of a round.
  EXPECT_NEAR(of.points, 200 * 2.0 / 3, 2);
  EXPECT_NEAR(of.accuracy, 0.003, 1e-12);
  EXPECT_NEAR(of.repeatability, 0, 1e-12);
}

TEST(PathAccuracy, IsInfiniteOfAPathThatIsNotFollowed) {
  Circles circles({1, 1});
  circles.attained.setZero();
  const PathAccuracy of = PathAccuracyOf(circles.times, circles.commanded, circles.attained,
                                         {.from_s = 0, .period_s = 1, .count = 2});
  EXPECT_EQ(of.accuracy, std::numeric_limits<double>::infinity());
  EXPECT_EQ(of.repeatability, std::numeric_limits<double>::infinity());
}

TEST(PathAccuracy, IsInfiniteOfAToolThatIsNowhereForARow) {
  Circles circles({1, 1});
  circles.attained.col(900).setConstant(std::numeric_limits<double>::quiet_NaN());
  const PathAccuracy of = PathAccuracyOf(circles.times, circles.commanded, circles.attained,
                                         {.from_s = 0, .period_s = 1, .count = 2});
  EXPECT_EQ(of.accuracy, std::numeric_limits<double>::infinity());
  EXPECT_EQ(of.repeatability, std::numeric_limits<double>::infinity());
}

TEST(PathAccuracy, NamesRoundsThatCannotBe) {
  const Circles circles({1, 1});
  const auto with = [&](const Rounds& rounds) {
    return ErrorOf(
        [&] { PathAccuracyOf(circles.times, circles.commanded, circles.attained, rounds); });
  };
  EXPECT_EQ(with({.from_s = 0, .period_s = 1, .count = 1}),
            "the accuracy of a path is of at least 2 rounds, got 1");
  EXPECT_EQ(with({.from_s = 0, .period_s = 0, .count = 2}),
            "the period of a round must be > 0, got 0");
  EXPECT_EQ(with({.from_s = 1, .period_s = 1, .count = 2}),
            "the rounds, from 1 s to 3 s, must lie within the times that there are, got -0.25 s to "
            "2.25 s");
  EXPECT_EQ(ErrorOf([&] {
              PathAccuracyOf(circles.times, Series::Zero(3, circles.times.size()), circles.attained,
                             {.from_s = 0, .period_s = 1, .count = 2});
            }),
            "the accuracy of a path is of one along which something is to move");
}

}  // namespace
}  // namespace pliant
