#include "pliant/analysis/damper_claim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// Joint 4 of a Gen3, ±2.57 rad and 2.0944 rad/s, whose damper keeps 1 % of the range free.
RunData Falling(double position, double velocity) {
  RunData run;
  run.name = run.title = "falling";
  run.arm.model = Gen3();
  RecordedSignal q{{"arm.position", "position", {"[joint_4]"}, {"rad"}}, {}, {}};
  q.times = Eigen::Vector3d(0, 0.5, 1);
  q.numbers = Eigen::RowVector3d(-2.56, -1, position);
  RecordedSignal v{{"arm.velocity", "velocity", {"[joint_4]"}, {"rad/s"}}, q.times, {}};
  v.numbers = Eigen::RowVector3d(-3, 0, velocity);
  // whose rows are those of the log
  RecordedSignal rows{{"arm.measured_position", "position", {"[joint_4]"}, {"rad"}}, q.times, {}};
  rows.numbers = q.numbers;
  run.log = Recording({q, v, rows}, {});
  return run;
}

DamperClaim Of(DamperBound bound, bool crossed) {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .runs = {"falling"},
          .joint = "joint_4",
          .bound = bound,
          .crossed = crossed,
          .from_s = 0.5};
}

bool Holds(DamperBound bound, bool crossed, double position, double velocity) {
  const RunData run = Falling(position, velocity);
  return Of(bound, crossed).Check(Runs({&run})).holds;
}

TEST(DamperClaim, HoldsWhereTheBoundsThatAreMeantAreKept) {
  using enum DamperBound;
  const double line = -2.57 + 0.01 * 5.14;
  EXPECT_TRUE(Holds(Both, false, line + 1e-6, -2.0943));
  EXPECT_FALSE(Holds(Both, false, line - 1e-6, -2.0943));
  EXPECT_FALSE(Holds(Both, false, line + 1e-6, 2.0945));
  EXPECT_TRUE(Holds(Position, false, line + 1e-6, 2.0945));
  EXPECT_TRUE(Holds(Speed, false, line - 1e-6, -2.0943));
  EXPECT_FALSE(Holds(Position, false, -line + 1e-6, 0)) << "the upper limit too";
}

TEST(DamperClaim, HoldsWhereAllBoundsThatAreMeantAreCrossed) {
  using enum DamperBound;
  EXPECT_TRUE(Holds(Both, true, -2.56, -3));
  EXPECT_FALSE(Holds(Both, true, -2.56, -2));
  EXPECT_FALSE(Holds(Both, true, -2.5, -3));
  EXPECT_TRUE(Holds(Speed, true, -2.5, -3));
}

TEST(DamperClaim, NeverHoldsOfWhatIsNoNumber) {
  const double nan = std::nan("");
  for (const bool crossed : {false, true}) {
    EXPECT_FALSE(Holds(DamperBound::Position, crossed, nan, 0));
    EXPECT_FALSE(Holds(DamperBound::Speed, crossed, -2, nan));
  }
}

TEST(DamperClaim, SaysHowFarOfABoundEachRunIs) {
  const RunData run = Falling(-2.5, -2.1);
  const Claim claim = Of(DamperBound::Both, false).Check(Runs({&run}));
  EXPECT_EQ(claim.measured, "falling: 5.60 mrad/s beyond q̇⁺, 18.6 mrad before the d_s line");
  EXPECT_EQ(claim.criterion, "none of the runs passes q̇⁺ or the d_s line");
}

TEST(DamperClaim, RefusesAJointOrATimeThatIsNotThere) {
  DamperClaim claim = Of(DamperBound::Both, false);
  claim.joint = "joint_5";
  EXPECT_NE(ErrorOf([&] { claim.RequireSound(Falling(0, 0).log); }).find("joint_4"),
            std::string::npos);
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  claim.from_s = 2;
  claim.joint = "joint_4";
  EXPECT_NE(ErrorOf([&] { claim.RequireFit(scenario); }), "");
  claim.from_s = 0;
  claim.bound = DamperBound::Position;
  claim.joint = "joint_3";
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }),
            "bound position: 'joint_3' is continuous and has no position limit");
}

}  // namespace
}  // namespace pliant
