#include "pliant/plants/model_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::HasSubstr;

constexpr int kSeeds = 1000;

RobotModel Gen3Bota() { return RobotModel::FromUrdf(kGen3BotaFile); }

ModelError Everything(double half_width, std::uint64_t seed) {
  return {.mass = half_width,
          .center = half_width,
          .inertia = half_width,
          .friction = half_width,
          .seed = seed};
}

bool SameFigures(const RobotModel& a, const RobotModel& b) {
  return std::ranges::equal(a.links(), b.links(), [](const Link& x, const Link& y) {
    return x.inertial.mass == y.inertial.mass && x.inertial.center == y.inertial.center &&
           x.inertial.inertia == y.inertial.inertia;
  });
}

Matrix3d SecondMoment(const Inertial& i) {
  return 0.5 * i.inertia.trace() * Matrix3d::Identity() - i.inertia;
}

/// Of numbers that should be uniform in (−1, 1).
double UniformError(const VectorXd& x) {
  return DistributionError(x, [](double u) { return 0.5 * (u + 1); });
}

/// A ball that turns, whose E can be read off: Σ' = s σ A².
RobotModel Ball() {
  return RobotModel::FromUrdfText(R"(<robot name="ball">
  <link name="world"/>
  <link name="ball">
    <inertial>
      <origin xyz="0.1 0.2 0.3"/>
      <mass value="2"/>
      <inertia ixx="0.04" ixy="0" ixz="0" iyy="0.04" iyz="0" izz="0.04"/>
    </inertial>
  </link>
  <joint name="spin" type="continuous">
    <parent link="world"/>
    <child link="ball"/>
    <axis xyz="0 0 1"/>
  </joint>
</robot>)");
}

/// ∂τ/∂x of the torques that hold an arm at rest, by the kinematics of the right model: in the
/// relative mass of a link, and in the place of its centre along the link's axes.
struct Leverage {
  JointTorque mass;
  Eigen::Matrix<double, 3, Eigen::Dynamic> center;
};
Leverage LeverageOf(const RobotModel& model, const Link& link, const JointPosition& q) {
  RobotDynamics d(model, {link.name});
  ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
  const FrameDynamics& frame = d.frame[0];
  const Vector3d c = frame.pose.rotation * link.inertial.center;
  const double m = link.inertial.mass;
  Leverage leverage{JointTorque::Zero(model.joints()), MatrixXd::Zero(3, model.size())};
  for (int j = 0; j < model.size(); ++j) {
    const Vector3d omega = frame.J.col(j).head<3>(), v = frame.J.col(j).tail<3>();
    leverage.mass(j) = -m * model.gravity().dot(v + omega.cross(c));
    leverage.center.col(j) = -m * frame.pose.rotation.transpose() * model.gravity().cross(omega);
  }
  return leverage;
}

JointTorque Gravity(const RobotModel& model, const JointPosition& q) {
  RobotDynamics d(model);
  ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
  return d.gravity;
}

class ModelErrorOf : public testing::TestWithParam<RobotModel (*)()> {
 protected:
  const RobotModel right = GetParam()();
};
INSTANTIATE_TEST_SUITE_P(Arms, ModelErrorOf, testing::Values(&Gen3Bota, &Lwr));

TEST_P(ModelErrorOf, KeepsLinksThatCouldBeBuilt) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const RobotModel wrong = Perturbed(right, Everything(0.6, seed));  // nearly all of 2/3
    for (const Link& link : wrong.links()) {
      const Inertial& i = link.inertial;
      const Inertial& was = right.link(right.link_index(link.name)).inertial;
      if (was.mass == 0) {
        EXPECT_EQ(i.mass, 0);
        continue;
      }
      EXPECT_GT(i.mass, 0) << link.name << ", seed " << seed;
      const Vector3d moments = Eigen::SelfAdjointEigenSolver<Matrix3d>(i.inertia).eigenvalues();
      const double rounding = 1e-12 * moments(2);
      EXPECT_LT((i.inertia - i.inertia.transpose()).norm(), rounding) << link.name;
      EXPECT_GT(moments(0), 0) << link.name << ", seed " << seed;
      // A link of the file may be as thin as a plate, where there is equality.
      EXPECT_GE(moments(0) + moments(1), moments(2) - rounding) << link.name << ", seed " << seed;
    }
  }
}

TEST_P(ModelErrorOf, KeepsTheJointInertiaPositive) {
  RandomStates random(right);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const RobotModel wrong = Perturbed(right, Everything(1, seed));
    RobotDynamics d(wrong);
    ComputeDynamics(wrong, random.q(), random.v(), d);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(d.M).eigenvalues()(0), 0) << seed;
  }
}

TEST_P(ModelErrorOf, IsUniformAndIndependentBetweenLinks) {
  constexpr double kError = 0.2;
  std::vector<Link> links;
  std::ranges::copy_if(right.links(), std::back_inserter(links),
                       [](const Link& link) { return link.inertial.mass > 0; });
  const auto n = static_cast<Eigen::Index>(links.size());
  MatrixXd mass(kSeeds, n), x(kSeeds, n), z(kSeeds, n);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const RobotModel wrong = Perturbed(right, Everything(kError, static_cast<std::uint64_t>(seed)));
    for (Eigen::Index k = 0; k < n; ++k) {
      const Inertial& was = links[static_cast<std::size_t>(k)].inertial;
      const Inertial& is =
          wrong.link(wrong.link_index(links[static_cast<std::size_t>(k)].name)).inertial;
      const double rho = std::sqrt(SecondMoment(was).trace() / was.mass);
      mass(seed, k) = (is.mass / was.mass - 1) / kError;
      const Vector3d moved = (is.center - was.center) / (kError * rho);
      x(seed, k) = moved.x();
      z(seed, k) = moved.z();
    }
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    for (const MatrixXd* drawn : {&mass, &x, &z}) {
      EXPECT_LT(drawn->col(k).cwiseAbs().maxCoeff(), 1 + 1e-12);
      EXPECT_LT(UniformError(drawn->col(k)), DistributionBound(kSeeds)) << "link " << k;
    }
    EXPECT_LT(std::abs(Correlation(mass.col(k), x.col(k))), MeanBound(kSeeds));
    EXPECT_LT(std::abs(Correlation(x.col(k), z.col(k))), MeanBound(kSeeds));
    for (Eigen::Index other = 0; other < k; ++other)
      EXPECT_LT(std::abs(Correlation(mass.col(k), mass.col(other))), MeanBound(kSeeds))
          << "links " << other << " and " << k;
  }
}

TEST_P(ModelErrorOf, ChangesGravityAsMuchAsItsMassesSay) {
  // g is linear in the masses: its variance is δ²/3 Σ (m ∂g/∂m)² over the links, without remainder.
  constexpr double kError = 0.1;
  const JointPosition q = RandomStates(right, 5).q();
  const JointTorque g = Gravity(right, q);
  JointTorque variance = JointTorque::Zero(right.joints()), most = variance;
  for (const Link& link : right.links()) {
    const Leverage leverage = LeverageOf(right, link, q);
    variance += kError * kError / 3 * leverage.mass.cwiseAbs2();
    most += kError * leverage.mass.cwiseAbs();
  }
  MatrixXd change(kSeeds, right.size());
  for (int seed = 0; seed < kSeeds; ++seed)
    change.row(seed) =
        Gravity(Perturbed(right, {.mass = kError, .seed = static_cast<std::uint64_t>(seed)}), q) -
        g;
  for (int j = 1; j < right.size(); ++j) {  // the first axis is along gravity
    // The tails of a sum of uniform numbers are shorter than those of normal ones.
    EXPECT_LT(std::abs(Variance(change.col(j)) / variance(j) - 1), VarianceBound(kSeeds)) << j;
    EXPECT_LT(std::abs(change.col(j).mean()), MeanBound(kSeeds) * std::sqrt(variance(j))) << j;
    EXPECT_LE(change.col(j).cwiseAbs().maxCoeff(), most(j) + 1e-12) << j;
  }
}

TEST_P(ModelErrorOf, ChangesGravityAsMuchAsItsCentersSay) {
  constexpr double kError = 0.1;
  const JointPosition q = RandomStates(right, 6).q();
  const JointTorque g = Gravity(right, q);
  JointTorque variance = JointTorque::Zero(right.joints());
  for (const Link& link : right.links()) {
    if (link.inertial.mass == 0) continue;
    const double rho = std::sqrt(SecondMoment(link.inertial).trace() / link.inertial.mass);
    variance += std::pow(kError * rho, 2) / 3 *
                LeverageOf(right, link, q).center.colwise().squaredNorm().transpose();
  }
  MatrixXd change(kSeeds, right.size());
  for (int seed = 0; seed < kSeeds; ++seed)
    change.row(seed) =
        Gravity(Perturbed(right, {.center = kError, .seed = static_cast<std::uint64_t>(seed)}), q) -
        g;
  for (int j = 1; j < right.size(); ++j)
    EXPECT_LT(std::abs(Variance(change.col(j)) / variance(j) - 1), VarianceBound(kSeeds)) << j;
}

TEST_P(ModelErrorOf, IsNoneWithoutHalfWidths) {
  EXPECT_TRUE(SameFigures(Perturbed(right, {.seed = 7}), right));
  const RobotModel heavier = Perturbed(right, {.mass = 0.1, .seed = 7});
  for (std::size_t i = 0; i < right.links().size(); ++i) {
    const Inertial &is = heavier.links()[i].inertial, &was = right.links()[i].inertial;
    EXPECT_EQ(is.center, was.center);
    if (was.mass == 0) continue;
    EXPECT_LT(RelativeError(is.inertia / is.mass, was.inertia / was.mass), 1e-15);  // round-off
  }
}

TEST_P(ModelErrorOf, IsAFunctionOfItsSeed) {
  const auto wrong = [&](std::uint64_t seed) { return Perturbed(right, Everything(0.1, seed)); };
  EXPECT_TRUE(SameFigures(wrong(3), wrong(3)));
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (std::uint64_t other = 0; other < seed; ++other)
      EXPECT_FALSE(SameFigures(wrong(seed), wrong(other))) << seed << " and " << other;
}

TEST_P(ModelErrorOf, IsTheSameWithAPayload) {
  const std::string link = right.links().back().name;
  const Inertial payload{1.5, {0.01, 0.02, 0.1}, 0.002 * Matrix3d::Identity()};
  ModelError error = Everything(0.1, 11);
  const RobotModel without = Perturbed(right, error);
  error.payload = {link, payload};
  EXPECT_TRUE(SameFigures(Perturbed(right, error), without.WithPayload(link, payload)));
}

TEST(ModelError, StretchesALinkByAUniformMatrix) {
  constexpr double kError = 0.5;
  const RobotModel right = Ball();
  const double sigma = SecondMoment(right.links()[1].inertial)(0, 0);
  MatrixXd drawn(kSeeds, 6);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const RobotModel wrong = Perturbed(right, Everything(kError, static_cast<std::uint64_t>(seed)));
    const Inertial& i = wrong.links()[1].inertial;
    const Matrix3d A_squared = SecondMoment(i) / (i.mass / 2 * sigma);
    const Matrix3d A = Eigen::SelfAdjointEigenSolver<Matrix3d>(A_squared).operatorSqrt();
    const Matrix3d E = 2 / kError * (A - Matrix3d::Identity());
    drawn.row(seed) << E(0, 0), E(1, 1), E(2, 2), E(0, 1), E(0, 2), E(1, 2);
  }
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT(drawn.col(k).cwiseAbs().maxCoeff(), 1 + 1e-12);
    EXPECT_LT(UniformError(drawn.col(k)), DistributionBound(kSeeds)) << k;
    for (int other = 0; other < k; ++other)
      EXPECT_LT(std::abs(Correlation(drawn.col(k), drawn.col(other))), MeanBound(kSeeds));
  }
}

TEST(ModelError, MakesFrictionWrongByOneUniformFactorPerKind) {
  constexpr double kError = 0.3;
  const ArmActuators right = ArmActuators::Read(kModels + "gen3/actuators.yaml", Gen3().joints());
  MatrixXd dry(kSeeds, 7), viscous(kSeeds, 7);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ArmActuators wrong =
        Perturbed(right, Everything(kError, static_cast<std::uint64_t>(seed)));
    for (std::size_t j = 0; j < 7; ++j) {
      const ActuatorParameters &is = wrong.joint[j], &was = right.joint[j];
      dry(seed, static_cast<int>(j)) = (is.friction.coulomb / was.friction.coulomb - 1) / kError;
      viscous(seed, static_cast<int>(j)) =
          (is.friction.viscous / was.friction.viscous - 1) / kError;
      EXPECT_EQ(is.friction.stiction / is.friction.coulomb,
                was.friction.stiction / was.friction.coulomb);
      ActuatorParameters but_friction = is;
      but_friction.friction = was.friction;
      EXPECT_EQ(but_friction, was);
    }
  }
  for (int j = 0; j < 7; ++j) {
    EXPECT_LT(UniformError(dry.col(j)), DistributionBound(kSeeds)) << j;
    EXPECT_LT(UniformError(viscous.col(j)), DistributionBound(kSeeds)) << j;
    EXPECT_LT(std::abs(Correlation(dry.col(j), viscous.col(j))), MeanBound(kSeeds)) << j;
    for (int other = 0; other < j; ++other)
      EXPECT_LT(std::abs(Correlation(dry.col(j), dry.col(other))), MeanBound(kSeeds));
  }
}

TEST(ModelError, NeverMakesFrictionNegative) {
  const ArmActuators right = ArmActuators::Read(kModels + "lwr/actuators.yaml", Lwr().joints());
  EXPECT_EQ(Perturbed(right, {.seed = 4}).joint, right.joint);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
    for (const ActuatorParameters& p : Perturbed(right, Everything(1, seed)).joint)
      EXPECT_EQ(ErrorOf([&] { RequireInRange("", p); }), "no error");
}

TEST(ModelError, RefusesWhatIsNoHalfWidth) {
  const RobotModel model = Gen3();
  const ArmActuators actuators = ArmActuators::Ideal(model.joints());
  const std::pair<double ModelError::*, std::string> figures[] = {
      {&ModelError::mass, "mass"},
      {&ModelError::center, "center"},
      {&ModelError::inertia, "inertia"},
      {&ModelError::friction, "friction"}};
  for (const auto& [figure, name] : figures)
    for (const auto& [value, text] : {std::pair{-0.1, "-0.1"}, {1.5, "1.5"}, {NAN, "nan"}}) {
      ModelError error;
      error.*figure = value;
      const std::string refusal =
          "model error: " + name + " must be from 0 to 1, got " + std::string(text);
      EXPECT_EQ(ErrorOf([&] { Perturbed(model, error); }), refusal);
      EXPECT_EQ(ErrorOf([&] { Perturbed(actuators, error); }), refusal);
    }
}

TEST(ModelError, RefusesPayloadsThatCannotBe) {
  const auto error = [](const std::string& link, double mass) {
    ModelError e;
    e.payload = {link, {.mass = mass, .inertia = Matrix3d::Identity()}};
    return ErrorOf([&] { Perturbed(Gen3(), e); });
  };
  EXPECT_THAT(error("forearm_lin", 1), HasSubstr("has no link \"forearm_lin\"; did you mean "
                                                 "\"forearm_link\"?"));
  EXPECT_THAT(error("forearm_link", -1),
              HasSubstr("payload on link \"forearm_link\": mass must be > 0, got -1"));
}

}  // namespace
}  // namespace pliant
