#include "pliant/systems/joint_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};

JointTrajectory Read(const std::string& contents) {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "way.csv";
  std::ofstream(file) << contents;
  return ReadJointTrajectory(file, kTwo);
}

/// The message behind the name of the file.
std::string Fault(const std::string& contents) {
  const std::string message = ErrorOf([&] { Read(contents); });
  const std::size_t at = message.find("way.csv");
  return at == std::string::npos ? message : message.substr(at + 7);
}

TEST(ReadJointTrajectory, FindsJointsByNameAndMindsUnits) {
  const JointTrajectory t = Read(
      "t [ms], elbow (deg), shoulder [rad]\n"
      "0, 90, 1\n"
      "500, -180, 2\n");
  EXPECT_EQ(t.times, (std::vector<double>{0, 0.5}));
  ASSERT_EQ(t.positions.size(), 2u);
  EXPECT_TRUE(t.positions[0].isApprox(JointPosition{1.0, std::numbers::pi / 2}, 1e-15));
  EXPECT_TRUE(t.positions[1].isApprox(JointPosition{2.0, -std::numbers::pi}, 1e-15));
  EXPECT_EQ(t.joints, kTwo);
}

TEST(ReadJointTrajectory, TakesRadiansAndSecondsWithoutUnits) {
  for (const std::string head :
       {"time,shoulder,elbow\n", "", "t(s), \"shoulder[rad]\", elbow [rad]\n"}) {
    const JointTrajectory t = Read(head + "1,2,3\n");
    EXPECT_EQ(t.times, std::vector<double>{1});
    EXPECT_EQ(t.positions[0], (JointPosition{2.0, 3.0}));
  }
}

TEST(ReadJointTrajectory, SaysWhereAFileIsWrong) {
  EXPECT_EQ(Fault("\nt,shoulder,elbo\n0,1,2\n"),
            ":2:3: 'elbo' is none of the joints (shoulder, elbow); did you mean 'elbow'?");
  EXPECT_EQ(Fault("t,shoulder\n0,1\n"),
            ":1:1: expected a column for each of the joints (shoulder, elbow), there is none for "
            "'elbow'");
  EXPECT_EQ(Fault("t,elbow,shoulder,elbow\n0,1,2,3\n"), ":1:4: joint 'elbow' has two columns");
  EXPECT_EQ(Fault("t,elbow [m],shoulder\n0,1,2\n"),
            ":1:2: expected an angle in rad or deg, got 'm'");
  EXPECT_EQ(Fault("t [min],elbow,shoulder\n0,1,2\n"),
            ":1:1: expected a time in s or ms, got 'min'");
  EXPECT_EQ(Fault("0,1\n"),
            ": expected a column for the time and one for each of the joints (shoulder, elbow), 3 "
            "in all, got 2");
  EXPECT_EQ(Fault("t,elbow,shoulder\n0,1,2\n1,x,2\n"), ":3:2: expected a number, got 'x'");
}

TEST(JointTrajectory, RefusesRowsThatAreNone) {
  const auto error = [](const JointTrajectory& t) {
    return ErrorOf([&] { RequireTrajectory(t); });
  };
  EXPECT_EQ(error({kTwo, {}, {}}), "a trajectory must have a row");
  EXPECT_EQ(error({kTwo, {0, 1}, {{1.0, 2.0}}}),
            "a trajectory has a position at each of its 2 times, got 1");
  EXPECT_EQ(error({kTwo, {1, 1}, {{1.0, 2.0}, {1.0, 2.0}}}),
            "row 2 of the trajectory: times must increase, got 1");
  EXPECT_EQ(error({kTwo, {NAN}, {{1.0, 2.0}}}),
            "row 1 of the trajectory: the time must be finite, got nan");
  EXPECT_EQ(
      error({kTwo, {0}, {{1.0}}}),
      "row 1 of the trajectory: it has a number for each of the joints (shoulder, elbow), got "
      "1");
  EXPECT_EQ(error({kTwo, {0}, {{1.0, NAN}}}), "row 1 of the trajectory: positions must be finite");
}

}  // namespace
}  // namespace pliant
