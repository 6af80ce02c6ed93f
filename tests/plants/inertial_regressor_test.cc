#include "pliant/plants/inertial_regressor.h"

#include <gtest/gtest.h>

#include <numeric>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {
namespace {

constexpr int kStates = 200;
constexpr double kTolerance = 1e-12;  // some 10³ operations, each rounded to 1e-16

std::vector<int> AllLinks(const RobotModel& model) {
  std::vector<int> links(model.links().size());
  std::iota(links.begin(), links.end(), 0);
  return links;
}

Eigen::VectorXd AllParameters(const RobotModel& model, const std::vector<int>& links) {
  Eigen::VectorXd pi(10 * static_cast<Eigen::Index>(links.size()));
  for (std::size_t k = 0; k < links.size(); ++k)
    pi.segment<10>(10 * static_cast<Eigen::Index>(k)) = ParametersOf(model.link(links[k]).inertial);
  return pi;
}

class InertialRegressorLaws : public ::testing::TestWithParam<RobotModel (*)()> {
 protected:
  RobotModel model = GetParam()().WithGravity({1, -2, -9});
  RandomStates random{model};
  std::vector<int> links = AllLinks(model);
  Eigen::MatrixXd Y{model.size(), 10 * static_cast<Eigen::Index>(links.size())};
};

TEST_P(InertialRegressorLaws, TimesTheParametersIsTheInverseDynamics) {
  const Eigen::VectorXd pi = AllParameters(model, links);
  RobotDynamics d(model);
  for (int k = 0; k < kStates; ++k) {
    const JointAcceleration a = random.a();
    ComputeDynamics(model, random.q(), random.v(), d);
    ComputeInertialRegressor(model, d, a, links, Y);
    EXPECT_LT(RelativeError(Y * pi, InverseDynamics(d, a)), kTolerance);
  }
}

TEST_P(InertialRegressorLaws, IsTheSameForOtherMasses) {
  const Inertial other{3, {0.1, -0.2, 0.3}, Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal()};
  const RobotModel heavy = model.WithPayload(model.links().back().name, other);
  RobotDynamics d(model), e(heavy);
  const JointPosition q = random.q();
  const JointVelocity v = random.v();
  const JointAcceleration a = random.a();
  ComputeDynamics(model, q, v, d);
  ComputeInertialRegressor(model, d, a, links, Y);
  Eigen::MatrixXd of_heavy = Y;
  ComputeDynamics(heavy, q, v, e);
  ComputeInertialRegressor(heavy, e, a, links, of_heavy);
  EXPECT_EQ(Y, of_heavy);
  EXPECT_LT(RelativeError(Y * AllParameters(heavy, links), InverseDynamics(e, a)), kTolerance);
}

TEST_P(InertialRegressorLaws, TakesNothingFromTheHeap) {
  RobotDynamics d(model);
  const JointAcceleration a = random.a();
  const long before = Allocations();
  ComputeInertialRegressor(model, d, a, links, Y);
  EXPECT_EQ(Allocations(), before);
}

INSTANTIATE_TEST_SUITE_P(Arms, InertialRegressorLaws, ::testing::Values(Gen3, Lwr, Tree));

TEST(InertialRegressor, OfAWeightOnAHorizontalAxisIsItsLever) {
  // One joint about y; a link whose origin is 0.5 m out along x: g at q = 0 is −9.80665 (0.5 m +
  // m c_x) against +y, and the inertia about the axis is I_yy + 2·0.5 m c_x + 0.25 m.
  const RobotModel model = RobotModel::FromUrdfText(R"(<robot name="rod">
    <link name="base"/>
    <link name="arm"/>
    <link name="end"><inertial><mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>
      <axis xyz="0 1 0"/></joint>
    <joint name="weld" type="fixed"><parent link="arm"/><child link="end"/>
      <origin xyz="0.5 0 0"/></joint></robot>)");
  RobotDynamics d(model);
  Eigen::MatrixXd Y(1, 10);
  const std::vector<int> links{model.link_index("end")};
  ComputeInertialRegressor(model, d, JointAcceleration{2.0}, links, Y);
  Eigen::MatrixXd expected(1, 10);
  const double g = 9.80665;
  expected << 2 * 0.25 - g * 0.5, 2 * 1.0 - g, 0, 0, 0, 0, 0, 2, 0, 0;
  EXPECT_LT((Y - expected).norm(), 1e-14);  // round-off
}

TEST(InertialParameters, AreThoseOfTheBodyTheyCameFrom) {
  for (const RobotModel& model : {Gen3(), Lwr(), Tree()})
    for (const Link& link : model.links()) {
      if (!(link.inertial.mass > 0)) continue;
      const InertialParameters pi = ParametersOf(link.inertial);
      const Inertial back = InertialOf(pi);
      EXPECT_EQ(back.mass, link.inertial.mass);
      EXPECT_LT((back.center - link.inertial.center).norm(), 1e-15);
      EXPECT_LT((back.inertia - link.inertial.inertia).norm(), 1e-15 * (1 + pi.norm()));
      EXPECT_LT((ParametersOf(PseudoInertiaOf(pi)) - pi).norm(), 1e-15 * (1 + pi.norm()));
    }
}

TEST(InertialParameters, OfPointMassesMakeThePseudoInertiaTheSumOfTheirSquares) {
  const Eigen::Vector3d points[] = {{1, 2, 3}, {-1, 0.5, 2}, {0, 1, -1}};
  InertialParameters pi = InertialParameters::Zero();
  PseudoInertia P = PseudoInertia::Zero();
  double m = 1;
  for (const Eigen::Vector3d& x : points) {
    pi += ParametersOf(Inertial{m, x, Eigen::Matrix3d::Zero()});
    P += m * x.homogeneous() * x.homogeneous().transpose();
    m += 0.5;
  }
  EXPECT_LT((PseudoInertiaOf(pi) - P).norm(), 1e-13);  // round-off of numbers up to 30
}

}  // namespace
}  // namespace pliant
