#include "pliant/systems/elements.h"

#include <gtest/gtest.h>

#include <type_traits>

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

}  // namespace
}  // namespace pliant
