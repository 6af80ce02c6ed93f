#include "pliant/analysis/accuracy_claims.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

RecordedSignal Poses(const std::string& path, const Eigen::VectorXd& times, const Series& positions,
                     double turned = 0) {
  RecordedSignal signal{{path, "pose", {}, {}}, times, Eigen::MatrixXd::Zero(12, times.size())};
  for (const char* axis : {"x", "y", "z"})
    signal.elements.push_back(std::string(".position[") + axis + "]");
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      signal.elements.push_back(".rotation[" + std::to_string(i) + "," + std::to_string(j) + "]");
  signal.units.assign(12, "m");
  signal.numbers.topRows<3>() = positions;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitX()).matrix();
  signal.numbers.bottomRows<9>().colwise() =
      Eigen::Map<const Eigen::Matrix<double, 9, 1>>(R.data());
  return signal;
}

/// A round of 1 s on a circle of 1 m, in a plane beside the one that is commanded.
RunData Circling(const std::string& name, double beside) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(4001, 0, 4);
  const Eigen::ArrayXd angle = 2 * std::numbers::pi * t.array();
  Series p = Series::Zero(3, t.size());
  p.row(0) = angle.cos();
  p.row(1) = angle.sin();
  RunData run;
  run.name = name;
  const Series target = p;
  p.row(2).setConstant(beside);
  run.log = Recording({Poses("control.target", t, target), Poses("tool.pose", t, p, 0.01)}, {});
  return run;
}

FollowsAsWell Follows(double margin) {
  return {.claim = {.id = "id", .source = "s", .paper = "p"},
          .basis = "basis",
          .run = "torque",
          .to = "position",
          .margin = margin,
          .from_s = 1,
          .period_s = 1,
          .rounds = 3};
}

TEST(FollowsAsWell, ComparesAccuracyAndRepeatabilityOfThePath) {
  const RunData torque = Circling("torque", 0.005), position = Circling("position", 0.002);
  const Runs runs({&torque, &position});
  // A chord of 2π/1000 lies 5e-6 m inside of its arc.
  EXPECT_TRUE(Follows(0.00301).Check(runs).holds);
  EXPECT_FALSE(Follows(0.00299).Check(runs).holds);
  const Claim claim = Follows(0.001).Check(runs);
  EXPECT_THAT(claim.measured, testing::StartsWith("AT 5.00 mm, RT "));
  EXPECT_THAT(claim.measured, testing::HasSubstr("; position AT 2.00 mm, RT "));
  EXPECT_EQ(claim.criterion, "AT and RT at most 1.00 mm above those of position");
}

ComesAsNear Nears(double margin) {
  return {.claim = {.id = "id", .source = "s", .paper = "p"},
          .basis = "basis",
          .run = "torque",
          .to = "position",
          .margin = margin,
          .from_s = 0.5,
          .every_s = 1,
          .visits = 3};
}

TEST(ComesAsNear, ComparesThePosesThatWereReached) {
  const RunData torque = Circling("torque", 0.005), position = Circling("position", 0.002);
  const Runs runs({&torque, &position});
  EXPECT_TRUE(Nears(0.00301).Check(runs).holds);
  EXPECT_FALSE(Nears(0.00299).Check(runs).holds);
  EXPECT_THAT(Nears(1).Check(runs).measured, testing::HasSubstr("(orientation 10.0 mrad, "));
}

TEST(ComesAsNear, RefusesVisitsOfDifferentPoses) {
  const RunData torque = Circling("torque", 0.005), position = Circling("position", 0.002);
  ComesAsNear claim = Nears(1);
  claim.every_s = 0.25;
  EXPECT_EQ(ErrorOf([&] {
              claim.Check(Runs({&torque, &position}));
            }),
            "all visits are to be of one commanded pose; run 'torque' commands another one at "
            "0.75 s than at 0.5 s");
}

TEST(AccuracyClaims, RefuseWhatCannotBeMeasured) {
  Scenario scenario;
  scenario.duration_s = 4;
  FollowsAsWell follows = Follows(1);
  EXPECT_EQ(ErrorOf([&] { follows.RequireFit(scenario); }), "no error");
  follows.rounds = 4;
  EXPECT_EQ(ErrorOf([&] { follows.RequireFit(scenario); }),
            "the end of the last round must lie within duration_s, 4, got 5");
  follows.to = "torque";
  EXPECT_EQ(ErrorOf([&] { follows.RequireFit(scenario); }),
            "a run cannot be compared with itself, 'torque'");
  ComesAsNear nears = Nears(1);
  EXPECT_EQ(ErrorOf([&] { nears.RequireFit(scenario); }), "no error");
  nears.visits = 5;
  EXPECT_EQ(ErrorOf([&] { nears.RequireFit(scenario); }),
            "the last visit must lie within duration_s, 4, got 4.5");
  EXPECT_THAT(ErrorOf([&] { nears.RequireSound(Recording()); }), testing::HasSubstr("tool.pose"));
}

}  // namespace
}  // namespace pliant
