#include "pliant/plants/wrist_sensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/plants/joint_sensors.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const std::string kFrame = "FT_sensor_wrench";

RobotModel Gen3Bota() { return RobotModel::FromUrdf(kGen3BotaFile); }

WristSensor::Options Ideal(const RobotModel& m) { return {.model = m, .frame = kFrame}; }

/// A heavy tool, so that its inertia counts.
Inertial Tool() {
  Inertial tool{1.7, {0.03, -0.02, 0.11}, {}};
  tool.inertia << 0.012, 0.001, -0.002, 0.001, 0.015, 0.0005, -0.002, 0.0005, 0.009;
  return tool;
}

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

/// Jᵀ W of a wrench in the axes of a link, at its origin.
VectorXd TorqueOf(const RobotModel& m, const RobotDynamics& d, const std::string& link,
                  const Wrench& W) {
  const FrameDynamics frame = PointDynamics(m, d, m.link_index(link), {0, 0, 0});
  Vector6 in_world;
  in_world << frame.pose.rotation * W.head<3>(), frame.pose.rotation * W.tail<3>();
  return frame.J.transpose() * in_world;
}

void Rest(BlockTester<WristSensor>& t, const RobotModel& m, const JointPosition& q) {
  t.Set(t->motion, At(m, q, JointVelocity::Zero(m.joints())));
  t.Set(t->acceleration, JointAcceleration::Zero(m.joints()));
}

/// A sensor at rest without gravity, to which `force` along z is applied at tick k.
struct Loaded {
  explicit Loaded(WristSensor::Options o) : tester{(o.model = o.model.WithGravity({0, 0, 0}), o)} {
    const RobotModel& m = o.model;
    Rest(tester, m, JointPosition::Zero(m.joints()));
    R_WS = LinkPose(m, At(m, JointPosition::Zero(m.joints()), JointVelocity::Zero(m.joints())),
                    m.link_index(kFrame))
               .rotation;
    contact =
        &tester.Join(tester->contacts, {m.link_index(kFrame), {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    link = m.link_index(kFrame);
  }

  /// In the sensor's axes, at its origin.
  Wrench Tick(const Wrench& W) {
    tester.Set(*contact, {link, {0, 0, 0}, R_WS * W.tail<3>(), R_WS * W.head<3>()});
    tester.Tick();
    return tester.Get(tester->wrench);
  }
  Wrench Tick(double fz) { return Tick(Wrench{0, 0, 0, 0, 0, fz}); }

  BlockTester<WristSensor> tester;
  Matrix3d R_WS;
  const Input<ContactForce>* contact;
  int link;
};

TEST(WristSensor, ShowsTheWeightOfAToolAtRest) {
  const RobotModel m = Gen3Bota().WithInertial(kFrame, Tool());
  RandomStates random(m, 81);
  BlockTester<WristSensor> t(Ideal(m));
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    Rest(t, m, q);
    t.Tick();
    const RobotDynamics d = At(m, q, JointVelocity::Zero(m.joints()));
    const Vector3d weight =
        LinkPose(m, d, m.link_index(kFrame)).rotation.transpose() * Vector3d(0, 0, -9.80665 * 1.7);
    Vector6 expected;
    expected << Tool().center.cross(weight), weight;
    EXPECT_LT(RelativeError(t.Get(t->wrench), expected), 1e-14);
    EXPECT_EQ(t.Get(t->wrench), t.Get(t->true_wrench));
  }
}

TEST(WristSensor, ShowsWhatALinkBeyondAddsToTheTorques) {
  // Mass as good as none, so that the model without the link is the same arm.
  const RobotModel without = Gen3Bota().WithInertial(kFrame, {.mass = 1e-30});
  const RobotModel with = Gen3Bota().WithInertial(kFrame, Tool());
  RandomStates random(with, 82);
  BlockTester<WristSensor> t(Ideal(with));
  for (int k = 0; k < 1000; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const RobotDynamics d = At(with, q, v);
    t.Set(t->motion, d);
    t.Set(t->acceleration, a);
    const VectorXd tau_with = InverseDynamics(d, a);
    const VectorXd gap = tau_with - InverseDynamics(At(without, q, v), a) +
                         TorqueOf(with, d, kFrame, t.Get(t->true_wrench));
    EXPECT_LT(gap.norm() / tau_with.norm(), 1e-12);
  }
}

TEST(WristSensor, ShowsAllThatABranchBeyondItAddsToTheTorques) {
  // Two more bodies beyond the plane, a prismatic joint among them. Everything there is doubled.
  const std::vector<std::string> beyond{"left_arm", "left_slide", "left_hand"};
  const RobotModel once = Tree();
  RobotModel twice = once;
  for (const std::string& name : beyond) {
    const Inertial& own = once.link(once.link_index(name)).inertial;
    twice = twice.WithInertial(name, {2 * own.mass, own.center, 2 * own.inertia});
  }
  RandomStates random(once, 83);
  BlockTester<WristSensor> t(
      WristSensor::Options{.model = once, .frame = "left_arm", .beyond = beyond});
  for (int k = 0; k < 1000; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const RobotDynamics d = At(once, q, v);
    t.Set(t->motion, d);
    t.Set(t->acceleration, a);
    const VectorXd tau_twice = InverseDynamics(At(twice, q, v), a);
    const VectorXd gap =
        tau_twice - InverseDynamics(d, a) + TorqueOf(once, d, "left_arm", t.Get(t->true_wrench));
    for (const char* carrier : {"waist", "left_shoulder"})
      EXPECT_LT(std::abs(gap(once.joint_index(carrier))), 1e-12 * tau_twice.norm());
  }
}

TEST(WristSensor, FeelsContactsBeyondItAndNoOthers) {
  const RobotModel m = Gen3Bota().WithGravity({0, 0, 0});
  RandomStates random(m, 84);
  const int sensor = m.link_index(kFrame), forearm = m.link_index("forearm_link");
  BlockTester<WristSensor> t(Ideal(m));
  const auto& beyond = t.Join(t->contacts, {sensor, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  t.Join(t->contacts, {forearm, {0.1, 0, 0}, {10, 20, 30}, {4, 5, 6}});
  t.Join(t->contacts, {-1, {0, 0, 0}, {10, 20, 30}, {4, 5, 6}});
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    Rest(t, m, q);
    const Vector3d point = Vector3d::Random() * 0.1, force = 20 * Vector3d::Random(),
                   moment = Vector3d::Random();
    t.Set(beyond, {sensor, point, force, moment});
    t.Tick();
    const Matrix3d R =
        LinkPose(m, At(m, q, JointVelocity::Zero(m.joints())), sensor).rotation.transpose();
    Vector6 expected;
    expected << R * moment + point.cross(R * force), R * force;
    EXPECT_LT(RelativeError(t.Get(t->wrench), expected), 1e-14);
    t.Set(beyond, {-1, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    t.Tick();
    EXPECT_EQ(t.Get(t->wrench), Wrench::Zero({})) << "nothing of the forearm's contact";
  }
}

/// A mass of 2 kg on a rail along z.
RobotModel Lift() {
  return RobotModel::FromUrdfText(R"(<robot name="lift"><link name="base"/>
    <link name="car"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"
      iyz="0"/></inertial></link>
    <joint name="rail" type="prismatic"><parent link="base"/><child link="car"/><axis xyz="0 0 1"/>
      <limit lower="-9" upper="9" velocity="99" effort="99"/></joint></robot>)");
}

TEST(WristSensor, ShowsNothingWhileItFallsFreely) {
  const RobotModel m = Lift();
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = m.joints(), .value = {0}});
  auto& plant = b.Add<SimbodyPlant>("plant", {.model = m, .position = {0}});
  auto& sensor = b.Add<WristSensor>("sensor", {.model = m, .frame = "car"});
  b.Connect(torque.y, plant.torque);
  b.Connect(plant.motion, sensor.motion);
  b.Connect(plant.acceleration, sensor.acceleration);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);
  EXPECT_LT(sim.Get(sensor.wrench).norm(), 1e-12) << "weightless";
  sim.Set(torque.value, {2 * 9.80665 + 3.0});
  EXPECT_NEAR(sim.Get(sensor.true_wrench)(5), -2 * 9.80665 - 3, 1e-12) << "pushed from below";
}

/// τ = −W of a rail along z.
class Yield final : public Block {
 public:
  explicit Yield(const Joints& joints)
      : wrench{this, "wrench", "car"}, torque{this, "torque", joints} {
    Compute(torque).From(wrench).As([](const Wrench& W) { return JointTorque{-W(5)}; });
  }
  Input<Wrench> wrench;
  Output<JointTorque> torque;
};

TEST(WristSensor, BreaksALoopThroughTheAccelerationIfItHasADelay) {
  const auto build = [](Duration delay) {
    const RobotModel m = Lift();
    DiagramBuilder b;
    auto& plant = b.Add<SimbodyPlant>("plant", {.model = m, .position = {0}});
    auto& sensor = b.Add<WristSensor>("sensor", {.model = m, .frame = "car", .delay = delay});
    auto& law = b.Add<Yield>("law", m.joints());
    b.Connect(plant.motion, sensor.motion);
    b.Connect(plant.acceleration, sensor.acceleration);
    b.Connect(sensor.wrench, law.wrench);
    b.Connect(law.torque, plant.torque);
    return ErrorOf([&] { b.Build(); });
  };
  EXPECT_EQ(build(1ms), "no error");
  EXPECT_THAT(build(0ms), testing::HasSubstr("algebraic loop"));
}

TEST(WristSensor, IsLateByTheDelayToTheTick) {
  for (const int n : {0, 1, 2, 5}) {
    WristSensor::Options o = Ideal(Gen3Bota());
    o.delay = Duration::Nanoseconds(1'000'000 * n);
    Loaded sensor(o);
    for (int k = 0; k < 20; ++k) {
      const double expected = 100 + std::max(k - n, 0);
      EXPECT_NEAR(sensor.Tick(100 + k)(5), expected, 1e-12) << "delay " << n << ", tick " << k;
    }
  }
}

TEST(WristSensor, HasItsOwnRate) {
  WristSensor::Options o = Ideal(Gen3Bota());
  o.period = Hertz(300);
  o.delay = Hertz(150);
  Loaded sensor(o);
  for (int k = 0; k < 30; ++k) {
    EXPECT_NEAR(sensor.Tick(1 + k)(5), 1 + std::max(k - 2, 0), 1e-12);
    EXPECT_NEAR(sensor.tester.time(), std::floor(k * 1e9 / 300) * 1e-9, 1e-12);
    sensor.tester.AdvanceTo(sensor.tester.time() + 0.003);
    EXPECT_NEAR(sensor.tester.Get(sensor.tester->wrench)(5), 1 + std::max(k - 2, 0), 1e-12);
  }
}

TEST(WristSensor, FiltersAsAFirstOrderLag) {
  WristSensor::Options o = Ideal(Gen3Bota());
  o.cutoff_hz = 20;
  o.delay = 3ms;
  Loaded sensor(o);
  sensor.Tick(1.0);
  for (int k = 1; k < 100; ++k) {
    const double reached = k < 3 ? 0 : 1 - std::exp(-2 * std::numbers::pi * 20 * (k - 3) * 1e-3);
    EXPECT_NEAR(sensor.Tick(2.0)(5), 1 + reached, 1e-12) << k;
  }
}

TEST(WristSensor, SaturatesAtItsRange) {
  WristSensor::Options o = Ideal(Gen3Bota());
  o.bias = {0, 0, 0, 0, 0, 2};
  o.range = {1, 2, 3, 40, 50, 60};
  Loaded sensor(o);
  EXPECT_EQ(sensor.Tick(Wrench{9, 9, 9, 99, 99, 99}), o.range);
  EXPECT_EQ(sensor.Tick(Wrench{-9, -9, -9, -99, -99, -99}), Wrench(-o.range));
  EXPECT_NEAR(sensor.Tick(57.0)(5), 59, 1e-12);
  EXPECT_EQ(sensor.Tick(59.0)(5), 60) << "the bias counts";
  o.range = {0, 0, 0, 0, 0, 0};
  EXPECT_NEAR(Loaded(o).Tick(1e6)(5), 1e6 + 2, 1e-9) << "no range";
}

TEST(WristSensor, HasWhiteNoiseAboutItsBias) {
  const int n = 50'000;
  WristSensor::Options o = SensOne(Gen3Bota(), 17);
  Loaded sensor(o);
  MatrixXd readings(n, 6);
  for (int k = 0; k < n; ++k) readings.row(k) = sensor.Tick(0.0).transpose();
  for (int i = 0; i < 6; ++i) {
    const VectorXd x = (readings.col(i).array() - o.bias(i)) / o.noise(i);
    EXPECT_LT(std::abs(x.mean()), MeanBound(n));
    EXPECT_LT(std::abs(Variance(x) - 1), VarianceBound(n));
    for (int j = 0; j < 6; ++j)
      for (int lag = i == j; lag < 3; ++lag)
        EXPECT_LT(std::abs(Correlation(x, readings.col(j), lag)), MeanBound(n - lag));
  }
}

TEST(WristSensor, MayHaveTheSeedOfTheJointSensors) {
  const int n = 20'000;
  const RobotModel m = Gen3Bota();
  JointSensors::Options joints = Gen3JointSensors(m.joints(), 1ms, 17);
  joints.current_noise = PerJoint::Ones(7);
  BlockTester<JointSensors> t(joints);
  t.Set(t->position, JointPosition::Zero(m.joints()));
  t.Set(t->velocity, JointVelocity::Zero(m.joints()));
  t.Set(t->torque, JointTorque::Zero(m.joints()));
  Loaded sensor(SensOne(m, 17));
  MatrixXd wrist(n, 6), arm(n, 21);
  for (int k = 0; k < n; ++k) {
    wrist.row(k) = sensor.Tick(0.0).transpose();
    t.Tick();
    arm.row(k) << t.Get(t->measured_position).transpose(), t.Get(t->measured_torque).transpose(),
        t.Get(t->measured_current).transpose();
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 21; ++j)
      EXPECT_LT(std::abs(Correlation(wrist.col(i), arm.col(j))), MeanBound(n)) << i << " and " << j;
}

TEST(WristSensor, OfTheSensOneHasItsFigures) {
  const RobotModel m = Gen3Bota();
  const WristSensor::Options o = SensOne(m, 3);
  EXPECT_LE(o.bias.tail<3>().cwiseAbs().maxCoeff(), 3);
  EXPECT_LE(o.bias.head<3>().cwiseAbs().maxCoeff(), 0.1);
  EXPECT_EQ(o.bias, SensOne(m, 3).bias);
  EXPECT_TRUE((o.bias.array() != SensOne(m, 4).bias.array()).all());
  // Noise-free resolution of 0.3 N and 0.007 N·m, 0.0025 N·m at 100 Hz, six deviations wide.
  const Wrench resolution{0.007, 0.007, 0.0025, 0.3, 0.3, 0.3};
  EXPECT_LT((o.noise - resolution / 6 * std::sqrt(10)).cwiseAbs().maxCoeff(), 0.002);
  EXPECT_NO_THROW(WristSensor sensor(o));
}

TEST(WristSensor, ShowsTheSameNumbersWhenResumedFromASnapshot) {
  WristSensor::Options o = SensOne(Gen3Bota(), 5);
  o.cutoff_hz = 50;
  Loaded sensor(o);
  for (int k = 0; k < 20; ++k) sensor.Tick(1.0 * k);
  const Context snapshot = sensor.tester.simulator().Snapshot();
  MatrixXd first(20, 6);
  for (int k = 0; k < 20; ++k) first.row(k) = sensor.Tick(3.0 - k).transpose();
  sensor.tester.simulator().Restore(snapshot);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(sensor.Tick(3.0 - k), first.row(k).transpose());
}

TEST(WristSensor, RefusesWhatIsNoSensor) {
  using O = WristSensor::Options;
  const RobotModel m = Gen3Bota();
  const auto error = [&m](auto change) {
    O o = Ideal(m);
    change(o);
    return ErrorOf([&] { BlockTester<WristSensor> t(o); });
  };
  EXPECT_THAT(error([](O& o) { o.frame = "FT_sensor_wrnch"; }),
              testing::HasSubstr("did you mean \"FT_sensor_wrench\"?"));
  EXPECT_THAT(error([](O& o) { o.beyond = {"FT_sensor_wrenc"}; }),
              testing::HasSubstr("did you mean \"FT_sensor_wrench\"?"));
  EXPECT_EQ(
      error([](O& o) { o.beyond = {"forearm_link"}; }),
      "block: every link beyond the sensing plane must be carried by \"FT_sensor_wrench\", got "
      "\"forearm_link\"");
  EXPECT_EQ(error([](O& o) {
              o.beyond = {"FT_sensor_wrench", "FT_sensor_wrench"};
            }),
            "block: every link beyond is named once, got \"FT_sensor_wrench\" again");
  EXPECT_EQ(error([](O& o) { o.delay = 1500us; }),
            "block: delay must be 0 to 1000 whole periods of 1 ms, got 1500 us");
  EXPECT_EQ(error([](O& o) { o.delay = 1001ms; }),
            "block: delay must be 0 to 1000 whole periods of 1 ms, got 1001 ms");
  EXPECT_EQ(error([](O& o) { o.delay = -1ms; }),
            "block: delay must be 0 to 1000 whole periods of 1 ms, got -1 ms");
  EXPECT_EQ(error([](O& o) { o.period = 0ms; }), "block: a period must be > 0, got 0 s");
  EXPECT_EQ(error([](O& o) { o.noise(1) = -1; }), "block: noise[my] must be >= 0 N·m, got -1");
  EXPECT_EQ(error([](O& o) { o.bias(3) = NAN; }), "block: bias[fx] must be finite N, got nan");
  EXPECT_EQ(error([](O& o) { o.range(5) = -60; }), "block: range[fz] must be >= 0 N, got -60");
  EXPECT_EQ(error([](O& o) { o.cutoff_hz = -5; }), "block: cutoff_hz must be >= 0 Hz, got -5");
}

TEST(WristSensor, HoldsTheLaws) {
  WristSensor::Options o = SensOne(Gen3Bota(), 4);
  o.cutoff_hz = 100;
  o.range = {};
  Loaded sensor(o);
  ExpectBlockLaws(std::move(sensor.tester));
}

}  // namespace
}  // namespace pliant
