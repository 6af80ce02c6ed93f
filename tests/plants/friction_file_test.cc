#include "pliant/plants/friction_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/plants/shared_file.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

const Joints kArm{"shoulder", "elbow"};

FrictionFile Identified() {
  return {.sources = {"a sweep.csv", "b.mcap"},
          .model = "stribeck",
          .loss = "cauchy",
          .directions = "both",
          .joints = {{.joint = "elbow",
                      .coulomb = 1.0 / 3,
                      .viscous = 0.1,
                      .stiction = 0.5,
                      .samples = 12000,
                      .residual_deviation = 0.16,
                      .estimates = {{"coulomb", 1.0 / 3, 0.01, 0.31, 0.35},
                                    {"viscous", 0.1, 0.002, 0.096, 0.104}},
                      .covariance = (Eigen::Matrix2d() << 1e-4, -2e-6, -2e-6, 4e-6).finished()}}};
}

TEST(FrictionFile, IsReadBackAsItWasWritten) {
  const FrictionFile written = Identified();
  const FrictionFile read = ReadFrictionText(written.text(), kArm);
  EXPECT_EQ(read.sources, written.sources);
  EXPECT_EQ(read.model, "stribeck");
  ASSERT_EQ(read.joints.size(), 1u);
  const IdentifiedFriction &a = read.joints[0], &b = written.joints[0];
  EXPECT_EQ(a.joint, "elbow");
  EXPECT_EQ(a.coulomb, b.coulomb);
  EXPECT_EQ(a.stribeck_velocity, std::nullopt);
  EXPECT_EQ(a.samples, 12000);
  EXPECT_EQ(a.estimates, b.estimates);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(read.text(), written.text());
}

TEST(FrictionFile, ChangesOnlyWhatItHas) {
  ArmActuators arm = ArmActuators::Ideal(kArm);
  arm.joint[1].friction = {.coulomb = 1, .viscous = 2, .stiction = 1.5, .stribeck_velocity = 0.05};
  const ArmActuators with = WithFriction(arm, kArm, Identified());
  EXPECT_EQ(with.joint[0], arm.joint[0]);
  FrictionParameters expected = arm.joint[1].friction;
  expected.coulomb = 1.0 / 3;
  expected.viscous = 0.1;
  expected.stiction = 0.5;
  EXPECT_EQ(with.joint[1].friction, expected);
}

TEST(FrictionFile, StictionThatIsNotKnownKeepsItsRatio) {
  ArmActuators arm = ArmActuators::Ideal(kArm);
  arm.joint[1].friction = {.coulomb = 1, .viscous = 2, .stiction = 1.5};
  FrictionFile file = Identified();
  file.joints[0].stiction.reset();
  EXPECT_DOUBLE_EQ(WithFriction(arm, kArm, file).joint[1].friction.stiction, 0.5);
  arm.joint[1].friction.coulomb = 0;
  EXPECT_DOUBLE_EQ(WithFriction(arm, kArm, file).joint[1].friction.stiction, 1.0 / 3);
}

TEST(FrictionFile, NamesTheNearestJoint) {
  FrictionFile file = Identified();
  file.joints[0].joint = "elbo";
  EXPECT_EQ(ErrorOf([&] { ReadFrictionText(file.text(), kArm, "f.yaml"); }),
            "f.yaml:10:12: expected one of shoulder, elbow, got 'elbo'; did you mean 'elbow'?");
}

TEST(FrictionFile, RefusesAJointTwice) {
  FrictionFile file = Identified();
  file.joints.push_back(file.joints[0]);
  EXPECT_THAT(ErrorOf([&] { ReadFrictionText(file.text(), kArm); }),
              HasSubstr("'elbow' is given twice"));
}

TEST(FrictionFile, RefusesLessStictionThanCoulomb) {
  FrictionFile file = Identified();
  file.joints[0].stiction = 0.25;
  EXPECT_THAT(ErrorOf([&] { ReadFrictionText(file.text(), kArm); }),
              HasSubstr("stiction must be ≥ coulomb, 0.3333333333, got 0.25"));
}

TEST(FrictionFile, RefusesACovarianceOfAnotherSize) {
  FrictionFile file = Identified();
  file.joints[0].estimates.pop_back();
  EXPECT_THAT(ErrorOf([&] { ReadFrictionText(file.text(), kArm); }),
              HasSubstr("covariance must have a row and a column for each of the 1 estimates, got "
                        "2 × 2"));
}

}  // namespace
}  // namespace pliant
