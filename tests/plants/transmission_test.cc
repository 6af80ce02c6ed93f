#include "pliant/plants/transmission.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "pliant/systems/diagram.h"
#include "pliant/tests/plants/masses.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"large", "small"};

/// B = 0.40 and 0.22 kg·m².
std::vector<ActuatorParameters> Springs(double damping = 0) {
  ActuatorParameters large{.gear_ratio = 100,
                           .torque_constant = 0.11,
                           .rotor_inertia = 0.4e-4,
                           .current_limit = 8,
                           .torque_limit = 100,
                           .stiffness = 25000,
                           .damping = damping,
                           .friction = {.coulomb = 0, .viscous = 0, .stiction = 0}};
  ActuatorParameters small = large;
  small.rotor_inertia = 0.22e-4;
  small.stiffness = 6000;
  return {large, small};
}

const Eigen::Vector2d kRotors{0.40, 0.22}, kLinks{1.2, 0.01};  // [kg·m²]

const Simulator::Options kAccurate{.integrator = {.method = Method::kDormandPrince,
                                                  .relative_tolerance = 1e-9,
                                                  .absolute_tolerance = 1e-12}};

/// Rotors and links of 1.2 and 0.01 kg·m² on springs, twisted and let go.
struct Swinging {
  ElasticTransmission* gear;
  Masses* links;
  Diagram diagram;

  static Swinging Make(double damping) {
    DiagramBuilder b;
    auto& gear = b.Add<ElasticTransmission>("gear", {.joints = kTwo,
                                                     .parameters = Springs(damping),
                                                     .position = JointPosition::Zero(kTwo),
                                                     .load = {10, 2}});
    auto& links = b.Add<Masses>("links", {.joints = kTwo, .inertia = kLinks});
    auto& off =
        b.Add<Constant<JointTorque>>("off", {.space = kTwo, .value = JointTorque::Zero(kTwo)});
    b.Connect(off.y, gear.motor_torque);
    b.Connect(links.position, gear.position);
    b.Connect(links.velocity, gear.velocity);
    b.Connect(gear.joint_torque, links.torque);
    return {&gear, &links, b.Build()};
  }
};

TEST(ElasticTransmission, SwingsAtTheFrequencyOfTwoMassesOnASpring) {
  const Swinging run = Swinging::Make(0);
  Simulator sim(run.diagram, kAccurate);
  const Eigen::Vector2d K{25000, 6000}, load{10, 2};
  EXPECT_EQ(sim.Get(run.gear->joint_torque), load);
  for (const double t : {0.003, 0.05, 0.5}) {
    sim.AdvanceTo(t);
    for (int j = 0; j < 2; ++j) {
      const double omega = std::sqrt(K(j) * (1 / kRotors(j) + 1 / kLinks(j)));
      EXPECT_NEAR(sim.Get(run.gear->joint_torque)(j), load(j) * std::cos(omega * t),
                  1e-5 * load(j));  // 63 turns at a relative tolerance of 1e-9
    }
  }
}

TEST(ElasticTransmission, LosesWhatItsDamperTakes) {
  const Swinging run = Swinging::Make(3);
  Simulator sim(run.diagram, kAccurate);
  const auto energy = [&] {
    const JointVelocity v = sim.Get(run.links->velocity);
    return sim.Get(run.gear->energy) + 0.5 * v.dot(kLinks.cwiseProduct(v));
  };
  double lost = 0, power = sim.Get(run.gear->dissipation);
  const double start = energy();
  const double h = 1e-5;
  for (int k = 1; k <= 20000; ++k) {
    sim.AdvanceTo(h * k);
    const double now = sim.Get(run.gear->dissipation);
    lost += 0.5 * h * (power + now);
    power = now;
    EXPECT_GE(now, 0);
  }
  EXPECT_GT(lost, 0.5 * start);
  // Of the trapezoids: (ω h)²/12 with ω at most 800 rad/s, twice for the square.
  EXPECT_NEAR(start - energy(), lost, 4 * std::pow(800 * h, 2) / 12 * start);
}

TEST(ElasticTransmission, FrictionTakesFromItsMotor) {
  BlockTester<ElasticTransmission> t(
      {.joints = kTwo, .parameters = Springs(), .position = JointPosition::Zero(kTwo)});
  t.Set(t->motor_torque, {5, -3});
  t.Set(t->friction, {1, -1});
  t.Set(t->position, JointPosition::Zero(kTwo));
  t.Set(t->velocity, JointVelocity::Zero(kTwo));
  t.simulator().AdvanceTo(0.001);
  const Eigen::Vector2d K{25000, 6000}, left{4, -2};
  for (int j = 0; j < 2; ++j) {  // the link is held: B ω̇ = τ_m − τ_f − K θ
    const double w = std::sqrt(K(j) / kRotors(j));
    const double rate = left(j) / kRotors(j) / w * std::sin(w * 0.001);
    EXPECT_NEAR(t.Get(t->motor_velocity)(j), rate,
                1e-4 * std::abs(rate));  // relative tolerance 1e-6
  }
}

TEST(RigidTransmission, MeasuresBehindTheRotor) {
  BlockTester<RigidTransmission> t({.joints = kTwo, .parameters = Springs()});
  t.Set(t->motor_torque, {5, -3});
  t.Set(t->friction, {1, -1});
  t.Set(t->acceleration, {2, 10});
  EXPECT_EQ(t.Get(t->torque), Eigen::Vector2d(4, -2));
  EXPECT_LT((t.Get(t->joint_torque) - Eigen::Vector2d(4 - 0.4 * 2, -2 - 0.22 * 10)).norm(), 1e-14);
}

TEST(Transmissions, AreAlikeAsTheSpringStiffens) {
  // One joint: a constant torque on rotor and link. The spring measures the rigid gear's torque
  // M τ/(B + M) plus its own swing of the same size; the mean over the swing is compared.
  for (const double stiffness : {1e5, 1e6}) {
    std::vector<ActuatorParameters> p = Springs(50);
    for (ActuatorParameters& joint : p) joint.stiffness = stiffness;
    DiagramBuilder b;
    auto& gear = b.Add<ElasticTransmission>(
        "gear", {.joints = kTwo, .parameters = p, .position = JointPosition::Zero(kTwo)});
    auto& links = b.Add<Masses>("links", {.joints = kTwo, .inertia = kLinks});
    auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kTwo, .value = {5, 2}});
    b.Connect(torque.y, gear.motor_torque);
    b.Connect(links.position, gear.position);
    b.Connect(links.velocity, gear.velocity);
    b.Connect(gear.joint_torque, links.torque);
    const Diagram diagram = b.Build();
    Simulator sim(diagram, kAccurate);
    sim.AdvanceTo(0.5);
    const Eigen::Vector2d tau{5, 2}, inertia = kRotors + kLinks;
    const Eigen::Vector2d q = 0.5 * 0.25 * tau.cwiseQuotient(inertia);
    // The spring gives by τ M/((B + M) K), shared between rotor and link.
    EXPECT_LT((sim.Get(links.position) - q).cwiseAbs().maxCoeff(), 5 / stiffness);
    EXPECT_LT((sim.Get(gear.joint_torque) - tau.cwiseProduct(kLinks).cwiseQuotient(inertia)).norm(),
              1e-4);
  }
}

TEST(Transmissions, KeepTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<RigidTransmission>({.joints = kTwo, .parameters = Springs()}));
  ExpectBlockLaws(BlockTester<ElasticTransmission>(
      {.joints = kTwo, .parameters = Springs(5), .position = JointPosition::Zero(kTwo)}));
}

TEST(Transmissions, RefuseWhatIsNoGear) {
  const auto error = [](auto change) {
    std::vector<ActuatorParameters> p = Springs();
    change(p[1]);
    return ErrorOf([&] {
      ElasticTransmission gear(
          {.joints = kTwo, .parameters = p, .position = JointPosition::Zero(kTwo)});
    });
  };
  using P = ActuatorParameters;
  EXPECT_EQ(error([](P& p) { p.stiffness = 0; }), "small: stiffness must be > 0 N·m/rad, got 0");
  EXPECT_EQ(error([](P& p) { p.stiffness = kUnbounded; }),
            "stiffness of a spring[small] must be > 0 N·m/rad, got inf");
  EXPECT_EQ(error([](P& p) { p.rotor_inertia = -1e-5; }),
            "small: rotor_inertia must be >= 0 kg·m², got -1e-05");
  EXPECT_EQ(error([](P& p) { p.rotor_inertia = 0; }),
            "rotor_inertia behind a spring[small] must be > 0 kg·m², got 0");
  EXPECT_EQ(error([](P& p) { p.damping = -1; }), "small: damping must be >= 0 N·m·s/rad, got -1");
}

}  // namespace
}  // namespace pliant
