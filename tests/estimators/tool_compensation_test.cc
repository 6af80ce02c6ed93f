#include "pliant/estimators/tool_compensation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pliant/plants/wrist_sensor.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector10 = Eigen::Matrix<double, 10, 1>;

const Vector3d kGravity{0, 0, -9.80665};
const std::string kFrame = "FT_sensor_wrench";

RobotModel Gen3Bota() { return RobotModel::FromUrdf(kGen3BotaFile); }

ToolParameters Tool() { return {1.2, {0.01, -0.02, 0.08}, {0.05, -0.03, 0.02, 2, -1.5, 2.5}}; }

Vector10 Numbers(const ToolParameters& tool) {
  return (Vector10() << tool.mass, tool.center, tool.bias).finished();
}

/// Evenly spread over all rotations.
Matrix3d RandomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  return turn.normalized().toRotationMatrix();
}

std::vector<ToolSample> Samples(const ToolParameters& tool, int n, std::mt19937& random,
                                const Wrench& noise = {}) {
  std::normal_distribution<double> normal;
  std::vector<ToolSample> samples;
  for (int i = 0; i < n; ++i) {
    const Matrix3d R = RandomRotation(random);
    Wrench W = RestingWrench(tool, R, kGravity);
    for (int j = 0; j < 6; ++j) W(j) += noise(j) * normal(random);
    samples.push_back({R, W});
  }
  return samples;
}

TEST(RestingWrench, IsTheWeightAtTheCenterOfMass) {
  // The sensor hangs upside down over x: gravity is along its +z, the tool's centre on its x axis.
  const Matrix3d R = Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();
  const Wrench W = RestingWrench({2, {0.1, 0, 0}, {1, 2, 3, 4, 5, 6}}, R, {0, 0, -10});
  EXPECT_LT((W - Wrench{1, 2 - 0.1 * 20, 3, 4, 5, 6 + 20}).norm(), 1e-14);
}

TEST(IdentifyTool, FindsTheToolOfExactSamples) {
  std::mt19937 random(91);
  for (int n = 4; n < 40; ++n) {
    const std::vector<ToolSample> samples = Samples(Tool(), n, random);
    const ToolEstimate estimate = IdentifyTool(samples, kGravity);
    // Round-off, grown by the condition.
    const double tolerance = 1e-13 * estimate.condition;
    EXPECT_LT(RelativeError(Numbers(estimate.tool), Numbers(Tool())), std::min(tolerance, 1e-12));
    EXPECT_LT(std::abs(estimate.tool.mass / Tool().mass - 1), 1e-12);
    EXPECT_LT(RelativeError(estimate.tool.center, Tool().center), 1e-12);
    EXPECT_LT(estimate.residual.norm(), 1e-12);
    EXPECT_LT(Numbers(estimate.deviation()).norm(), 1e-12);
    EXPECT_GE(estimate.condition, std::sqrt(1.5) * (1 - 1e-12));
  }
}

TEST(IdentifyTool, NeedsThreeOrientations) {
  // Gravity along x, y and z.
  const Matrix3d about_x =
                     Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()).toRotationMatrix(),
                 about_y =
                     Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).toRotationMatrix();
  std::vector<ToolSample> samples;
  for (const Matrix3d& R : {Matrix3d(Matrix3d::Identity()), about_x, about_y})
    samples.push_back({R, RestingWrench(Tool(), R, kGravity)});
  EXPECT_LT(RelativeError(Numbers(IdentifyTool(samples, kGravity).tool), Numbers(Tool())), 1e-12);
  samples.pop_back();
  EXPECT_EQ(ErrorOf([&] { IdentifyTool(samples, kGravity); }),
            "a tool needs samples of at least 3 orientations, got 2");
}

TEST(IdentifyTool, IsAsUncertainAsItSays) {
  // Over many trials z = (x̂ − x)/σ̂ has mean 0 and variance 1, and (x̂ − x)ᵀ Σ̂⁻¹ (x̂ − x) is χ² with
  // 10 degrees. As s² is estimated, with 3·30 − 4 and 3·30 − 6 degrees, both are wider by 1/(1 −
  // 2/84).
  const int trials = 2000, n = 30;
  const Wrench noise{0.0037, 0.0037, 0.0013, 0.16, 0.16, 0.16};
  std::mt19937 random(92);
  Eigen::MatrixXd z(trials, 10);
  Eigen::VectorXd distance(trials);
  for (int i = 0; i < trials; ++i) {
    const ToolEstimate estimate =
        IdentifyTool(Samples(Tool(), n, random, noise), kGravity, 7 * noise);
    const Vector10 error = Numbers(estimate.tool) - Numbers(Tool());
    z.row(i) = error.cwiseQuotient(Numbers(estimate.deviation())).transpose();
    distance(i) = error.dot(estimate.covariance.ldlt().solve(error));
  }
  const double wider = 1 / (1 - 2.0 / 84);
  for (int j = 0; j < 10; ++j) {
    EXPECT_LT(std::abs(z.col(j).mean()), MeanBound(trials) * std::sqrt(wider)) << j;
    EXPECT_NEAR(Variance(z.col(j)), 1, VarianceBound(trials) * wider + wider - 1) << j;
    EXPECT_LT(z.col(j).cwiseAbs().maxCoeff(), 5.5) << j;
  }
  // χ² with 10 degrees: mean 10, variance 20.
  EXPECT_NEAR(distance.mean() / 10, 1, MeanBound(trials) * std::sqrt(0.2) + wider - 1);
}

TEST(IdentifyTool, TellsWhatTheToolLeavesUnexplained) {
  const int n = 10'000;
  const Wrench noise{0.0037, 0.0037, 0.0013, 0.16, 0.2, 0.3};
  std::mt19937 random(93);
  const ToolEstimate estimate = IdentifyTool(Samples(Tool(), n, random, noise), kGravity, noise);
  for (int j = 0; j < 6; ++j)
    EXPECT_NEAR(estimate.residual(j) / noise(j), 1, VarianceBound(n) / 2 + 6.0 / n);
}

TEST(IdentifyTool, RefusesOrientationsThatTellTooLittle) {
  const auto error = [](auto rotation) {
    std::vector<ToolSample> samples;
    for (int i = 0; i < 20; ++i) {
      const Matrix3d R = rotation(i).toRotationMatrix();
      samples.push_back({R, RestingWrench(Tool(), R, kGravity)});
    }
    return ErrorOf([&] { IdentifyTool(samples, kGravity); });
  };
  const auto refused =
      testing::HasSubstr("the orientations do not tell mass, centre and bias apart");
  EXPECT_THAT(error([](int) { return Eigen::AngleAxisd(0.3, Vector3d::UnitX()); }), refused);
  EXPECT_THAT(error([](int i) { return Eigen::AngleAxisd(0.3 * i, Vector3d::UnitZ()); }), refused)
      << "turned about gravity";
  EXPECT_THAT(error([](int i) { return Eigen::AngleAxisd(i % 2 ? 0.5 : -0.5, Vector3d::UnitX()); }),
              refused)
      << "two directions of gravity leave the centre free along their difference";
  EXPECT_THAT(error([](int i) { return Eigen::AngleAxisd(0.002 * i, Vector3d::UnitX()); }), refused)
      << "within two degrees";
  EXPECT_EQ(error([](int i) { return Eigen::AngleAxisd(0.2 * i, Vector3d::UnitX()); }), "no error")
      << "a circle of directions is enough";
}

TEST(IdentifyTool, RefusesSamplesThatAreNone) {
  using Samplings = std::vector<ToolSample>;
  const auto error = [](auto change) {
    std::mt19937 random(94);
    Samplings samples = Samples(Tool(), 8, random);
    Vector3d gravity = kGravity;
    Wrench noise{1, 1, 1, 1, 1, 1};
    change(samples, gravity, noise);
    return ErrorOf([&] { IdentifyTool(samples, gravity, noise); });
  };
  EXPECT_THAT(error([](Samplings& s, Vector3d&, Wrench&) { s[2].rotation(0, 0) += 1e-3; }),
              testing::StartsWith("sample 2: R_WS must be a rotation"));
  EXPECT_EQ(error([](Samplings& s, Vector3d&, Wrench&) { s[3].wrench(4) = NAN; }),
            "sample 3: wrench[fy] must be finite N, got nan");
  EXPECT_EQ(error([](Samplings&, Vector3d& g, Wrench&) { g.setZero(); }),
            "the norm of gravity must be > 0 m/s², got 0");
  EXPECT_EQ(error([](Samplings&, Vector3d&, Wrench& noise) { noise(2) = 0; }),
            "noise[mz] must be > 0 N·m, got 0");
  EXPECT_EQ(error([](Samplings& s, Vector3d&, Wrench&) {
              for (ToolSample& sample : s) sample.wrench = -sample.wrench;
            }),
            "the mass that the samples show must be > 0 kg, got -1.2");
}

RobotDynamics Resting(const RobotModel& m, const JointPosition& q) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  return d;
}

TEST(ToolCompensation, LeavesWhatTouchesTheTool) {
  const RobotModel m = Gen3Bota();
  RandomStates random(m, 95);
  BlockTester<ToolCompensation> t(
      ToolCompensation::Options{.model = m, .frame = kFrame, .tool = Tool()});
  for (int k = 0; k < 100; ++k) {
    const RobotDynamics d = Resting(m, random.q());
    const Wrench resting =
        RestingWrench(Tool(), LinkPose(m, d, m.link_index(kFrame)).rotation, m.gravity());
    const Wrench touch = random.Uniform(20).head<6>();
    t.Set(t->dynamics, d);
    t.Set(t->measured, resting);
    EXPECT_LT(t.Get(t->contact).norm(), 1e-14);
    t.Set(t->measured, resting + touch);
    EXPECT_LT((t.Get(t->contact) - touch).norm(), 1e-13);  // round-off of some 50 N
  }
  t.Set(t->tool, {});
  EXPECT_EQ(t.Get(t->contact), t.simulator().Get(t->measured)) << "no tool, nothing to remove";
}

/// A Gen3 at rest with a SensONE and a compensation, and what touches the sensor.
struct Rig {
  RobotModel model = Gen3Bota().WithPayload(
      kFrame, {0.9, {0.01, 0.02, 0.07}, Vector3d(0.002, 0.003, 0.001).asDiagonal()});
  DiagramBuilder builder;
  Constant<RobotDynamics>& motion = builder.Add<Constant<RobotDynamics>>(
      "motion", {.space = model.joints(), .value = RobotDynamics(model)});
  Constant<JointAcceleration>& acceleration = builder.Add<Constant<JointAcceleration>>(
      "acceleration", {.space = model.joints(), .value = JointAcceleration::Zero(model.joints())});
  Constant<ContactForce>& push = builder.Add<Constant<ContactForce>>("push", {.value = {}});
  WristSensor& sensor = builder.Add<WristSensor>("sensor", SensOne(model, 96));
  ToolCompensation& compensation =
      builder.Add<ToolCompensation>("compensation", {.model = model, .frame = kFrame});
  Diagram diagram = Wire();
  Simulator sim{diagram};

  Diagram Wire() {
    builder.Connect(motion.y, sensor.motion);
    builder.Connect(acceleration.y, sensor.acceleration);
    builder.Connect(push.y, sensor.contacts);
    builder.Connect(sensor.wrench, compensation.measured);
    builder.Connect(motion.y, compensation.dynamics);
    return builder.Build();
  }

  /// The mean of n readings, once the delay has passed.
  Wrench Mean(const Output<Wrench>& wrench, int n) {
    for (int k = 0; k < 2; ++k) sim.AdvanceThroughTick();
    Wrench sum;
    for (int k = 0; k < n; ++k) {
      sim.AdvanceThroughTick();
      sum += sim.Get(wrench);
    }
    return sum / n;
  }
};

TEST(ToolCompensation, IsZeroWhileTheReadingIsNotValid) {
  const RobotModel m = Gen3Bota();
  RandomStates random(m, 96);
  BlockTester<ToolCompensation> t(
      ToolCompensation::Options{.model = m, .frame = kFrame, .tool = Tool()});
  t.Set(t->dynamics, Resting(m, random.q()));
  t.Set(t->measured, Wrench{NAN, 1, 1, 1, 1, 1});
  t.Set(t->measured_valid, false);
  EXPECT_EQ(t.Get(t->contact), Wrench());
}

TEST(ToolCompensation, ShowsAPushOnceAGen3HasIdentifiedItsTool) {
  Rig rig;
  const RobotModel& m = rig.model;
  const int postures = 12, readings = 200;
  const Wrench noise = SensOne(m, 96).noise;
  const int frame = m.link_index(kFrame);
  RandomStates random(m, 97);
  std::vector<ToolSample> samples;
  for (int i = 0; i < postures; ++i) {
    const RobotDynamics d = Resting(m, random.q());
    rig.sim.Set(rig.motion.value, d);
    samples.push_back({LinkPose(m, d, frame).rotation, rig.Mean(rig.sensor.wrench, readings)});
  }
  const ToolEstimate estimate = IdentifyTool(samples, m.gravity(), noise);

  const Inertial& beyond = m.link(frame).inertial;
  const ToolParameters truth{beyond.mass, beyond.center, SensOne(m, 96).bias};
  const Vector10 z =
      (Numbers(estimate.tool) - Numbers(truth)).cwiseQuotient(Numbers(estimate.deviation()));
  EXPECT_LT(z.cwiseAbs().maxCoeff(), kDeviations) << z.transpose();

  rig.sim.Set(rig.compensation.tool, estimate.tool);
  for (int i = 0; i < 10; ++i) {
    const RobotDynamics d = Resting(m, random.q());
    const Matrix3d R = LinkPose(m, d, frame).rotation;
    const Vector3d force = random.Uniform(20).head<3>(), point{0.02, -0.01, 0.1};
    rig.sim.Set(rig.motion.value, d);
    rig.sim.Set(rig.push.value, {frame, point, R * force, {0, 0, 0}});
    Wrench expected;
    expected << point.cross(force), force;
    const Wrench gap = rig.Mean(rig.compensation.contact, readings) - expected;
    // Noise of the readings, and as much of the estimate: at twelve postures each of its parts
    // weighs less than one posture's mean.
    for (int j = 0; j < 6; ++j)
      EXPECT_LT(std::abs(gap(j)), kDeviations * noise(j) * std::sqrt(2.0 / readings)) << i;
  }
}

TEST(ToolCompensation, RefusesWhatIsNoTool) {
  const auto error = [](auto change) {
    ToolCompensation::Options o{.model = Gen3Bota(), .frame = kFrame, .tool = Tool()};
    change(o);
    return ErrorOf([&] { BlockTester<ToolCompensation> t(o); });
  };
  using O = ToolCompensation::Options;
  EXPECT_EQ(error([](O& o) { o.tool.mass = -1; }), "block: mass must be >= 0 kg, got -1");
  EXPECT_EQ(error([](O& o) { o.tool.center(1) = NAN; }),
            "block: center[y] must be finite m, got nan");
  EXPECT_EQ(error([](O& o) { o.tool.bias(1) = NAN; }),
            "block: bias[my] must be finite N·m, got nan");
  EXPECT_THAT(error([](O& o) { o.frame = "FT_sensor_wrenc"; }),
              testing::HasSubstr("did you mean \"FT_sensor_wrench\"?"));
}

TEST(ToolCompensation, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<ToolCompensation>(
      ToolCompensation::Options{.model = Gen3Bota(), .frame = kFrame, .tool = Tool()}));
}

}  // namespace
}  // namespace pliant
