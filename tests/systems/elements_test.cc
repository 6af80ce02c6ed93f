#include "pliant/systems/elements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

TEST(EachElement, TakesNumbersAndVectorsTogether) {
  const auto add = [](double a, double b, double c) { return a + b + c; };
  EXPECT_EQ(EachElement<JointTorque>(add, JointPosition{1, 2}, PerJoint{{10.0, 20.0}}, 0.5),
            (JointTorque{11.5, 22.5}));
  EXPECT_EQ(EachElement<double>(add, 1.0, 10.0, 0.5), 11.5);
}

TEST(PerElement, IsThePlainTypeOfASignal) {
  static_assert(std::is_same_v<PerElement<JointTorque>, PerJoint>);
  static_assert(std::is_same_v<PerElement<PerJoint>, PerJoint>);
  static_assert(std::is_same_v<PerElement<Wrench>, Eigen::Matrix<double, 6, 1>>);
  static_assert(std::is_same_v<PerElement<double>, double>);
}

TEST(RequireEachInRange, NamesTheElementWithItsUnit) {
  const Joints joints{"shoulder", "elbow"};
  const auto error = [](const auto& x, std::string_view unit, const Space& space) {
    return ErrorOf([&] { RequireEachInRange("x", x, unit, kNotNegative, space); });
  };
  EXPECT_EQ(error(PerJoint{{0.0, 1.0}}, "N·m", joints), "no error");
  EXPECT_EQ(error(PerJoint{{0.0, -1.0}}, "N·m", joints), "x[elbow] must be >= 0 N·m, got -1");
  EXPECT_EQ(error(PerJoint{{NAN, -1.0}}, "", {}), "x[0] must be >= 0, got nan");
  EXPECT_EQ(error(Wrench{0, 0, 0, 0, -2, 0}, "N·m, N", {}), "x[fy] must be >= 0 N, got -2");
  EXPECT_EQ(error(-3.0, "m", {}), "x must be >= 0 m, got -3");
}

TEST(RequireEachInRange, RefusesAnotherNumberOfElementsThanOfJoints) {
  const Joints joints{"shoulder", "elbow"};
  for (const int n : {0, 1, 3})
    EXPECT_EQ(ErrorOf([&] {
                RequireEachInRange("x", PerJoint(PerJoint::Ones(n)), "", kNotNegative, joints);
              }),
              "x has an element for each of the 2 joints, got " + Text(n));
}

TEST(EachInRangeOr0, IsZeroWhereItIsLeftOut) {
  const Joints joints{"shoulder", "elbow"};
  const auto checked = [&](const PerJoint& x) {
    return EachInRangeOr0("x", x, "N·m", kNotNegative, joints);
  };
  EXPECT_EQ(checked(PerJoint{}), (PerJoint{{0.0, 0.0}}));
  EXPECT_EQ(checked(PerJoint{{1.0, 2.0}}), (PerJoint{{1.0, 2.0}}));
  EXPECT_EQ(ErrorOf([&] { checked(PerJoint{{1.0, -2.0}}); }), "x[elbow] must be >= 0 N·m, got -2");
  EXPECT_EQ(ErrorOf([&] { checked(PerJoint::Ones(1)); }),
            "x has an element for each of the 2 joints, got 1");
}

}  // namespace
}  // namespace pliant
