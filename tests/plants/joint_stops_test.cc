#include "pliant/plants/joint_stops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/plants/energy_balance.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kMass = 2;

/// A gantry without weight, whose slides stop at −1 m and 1.5 m.
RobotModel Weightless() { return Gantry(kMass).WithGravity({0, 0, 0}); }

/// A plant with stops.
struct Stopped : Scene {
  Stopped(const SimbodyPlant::Options& arm, const JointStops::Options& o)
      : Scene{arm}, stops{b.Add<JointStops>("stops", o)} {
    b.Connect(plant.position, stops.position);
    b.Connect(plant.velocity, stops.velocity);
    b.Connect(stops.torque, plant.loads);
    b.Connect(stops.energy, balance.energy);
    b.Connect(stops.dissipation, balance.dissipation);
  }

  JointStops& stops;
};

TEST(JointStops, PushBackOnlyBeyondTheEnds) {
  const RobotModel m = Gen3();
  BlockTester<JointStops> t(JointStops::Options{
      .model = m, .stiffness = PerJoint::Constant(7, 1000), .damping = PerJoint::Constant(7, 0.5)});
  t.Set(t->position, {9, 2.23, -9, -2.56, 9, 2.08, -9});
  t.Set(t->velocity, {1, 1, 1, 1, 1, 1, 1});
  EXPECT_EQ(t.Get(t->torque), JointTorque::Zero(m.joints())) << "joints 1, 3, 5 and 7 have no ends";
  EXPECT_EQ(t.Get(t->stopped), 0);
  EXPECT_EQ(t.Get(t->energy), 0);
  EXPECT_EQ(t.Get(t->dissipation), 0);
  t.Set(t->position, {9, 2.25, -9, -2.59, 9, 2.08, -9});
  t.Set(t->velocity, {1, 0.4, 1, -0.2, 1, 1, 1});
  JointTorque tau = JointTorque::Zero(m.joints());
  tau(1) = -1000 * 0.01 * (1 + 0.5 * 0.4);
  tau(3) = 1000 * 0.02 * (1 + 0.5 * 0.2);
  EXPECT_LT((t.Get(t->torque) - tau).norm(), 1e-11);
  EXPECT_EQ(t.Get(t->stopped), 2);
  EXPECT_NEAR(t.Get(t->penetration)(1), 0.01, 1e-15);
  EXPECT_NEAR(t.Get(t->penetration)(3), -0.02, 1e-15);
  EXPECT_NEAR(t.Get(t->energy), 500 * (1e-4 + 4e-4), 1e-13);
  EXPECT_NEAR(t.Get(t->dissipation), 1000 * 0.5 * (0.01 * 0.16 + 0.02 * 0.04), 1e-12);
}

TEST(JointStops, NeverPullAJointThatLeavesFast) {
  const RobotModel m = Weightless();
  BlockTester<JointStops> t(JointStops::Options{
      .model = m, .stiffness = PerJoint::Constant(3, 1000), .damping = PerJoint::Constant(3, 2)});
  t.Set(t->position, {1.6, -1.1, 1.6});
  t.Set(t->velocity, {-0.6, 7, -0.25});
  EXPECT_EQ(t.Get(t->torque).head<2>(), Eigen::Vector2d(0, 0));
  EXPECT_NEAR(t.Get(t->torque)(2), -50, 1e-11);
  EXPECT_NEAR(t.Get(t->dissipation), 100 * 0.6 + 100 * 7 + 1000 * 0.1 * 2 * 0.25 * 0.25, 1e-9);
}

TEST(JointStops, GiveWayInProportionToTheTorque) {
  const RobotModel m = Weightless();
  Stopped s({.model = m, .position = {1.4, -0.9, 0}, .damping = PerJoint::Constant(3, 80)},
            {.model = m,
             .lower = {-1, -1, -0.1},
             .upper = {1.5, 1.5, std::numeric_limits<double>::infinity()},
             .stiffness = PerJoint::Constant(3, 2000),
             .damping = PerJoint::Constant(3, 0.1)});
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  sim.Set(s.torque.value, {30, -50, 0});
  sim.AdvanceTo(5);
  // exp(−5 s · 20 s⁻¹) has died out; tolerance 1e-12.
  EXPECT_NEAR(sim.Get(s.plant.position)(0), 1.5 + 30.0 / 2000, 1e-10);
  EXPECT_NEAR(sim.Get(s.plant.position)(1), -1 - 50.0 / 2000, 1e-10);
  EXPECT_EQ(sim.Get(s.stops.stopped), 2);
}

TEST(JointStops, ThrowAJointBackByTheLawOfHuntAndCrossley) {
  const RobotModel m = Weightless();
  for (const double c : {0.01, 0.5, 3.0}) {
    const double v1 = 0.8;
    Stopped s({.model = m, .position = {1.4, 0, 0}, .velocity = {v1, -v1, 0}},
              {.model = m,
               .stiffness = PerJoint::Constant(3, 5000),
               .damping = PerJoint::Constant(3, c)});
    const Diagram diagram = s.b.Build();
    Simulator sim(diagram, kAccurately);
    const double total = sim.Get(s.balance.total);
    sim.AdvanceTo(1.4);
    ASSERT_EQ(sim.Get(s.stops.stopped), 0);
    EXPECT_NEAR(sim.Get(s.balance.total), total, 1e-8);  // tolerance 1e-11, 3000 steps
    for (const double v2 : {-sim.Get(s.plant.velocity)(0), sim.Get(s.plant.velocity)(1)}) {
      EXPECT_LT(v2, v1);
      EXPECT_NEAR(std::log1p(-c * v2) + c * v2, std::log1p(c * v1) - c * v1, 1e-8 * c) << c;
      if (c * v1 < 0.01) {
        EXPECT_NEAR(v2 / v1, 1 - 2 * c * v1 / 3, c * v1 * c * v1);
      }
    }
  }
}

TEST(JointStops, CatchAnArmThatFallsOnThem) {
  const RobotModel m = Gen3();
  const JointStops::Options o{
      .model = m, .stiffness = PerJoint::Constant(7, 2000), .damping = PerJoint::Constant(7, 0.3)};
  Stopped s({.model = m,
             .position = {0, 1.6, 0, 2.45, 0, 2.0, 0},
             .velocity = {0, 0, 0, 2, 0, 2, 0},
             .damping = PerJoint::Constant(7, 0.4),
             .rotor_inertia = PerJoint::Constant(7, 0.2)},
            o);
  const Diagram diagram = s.b.Build();
  Simulator sim(diagram, kAccurately);
  const double total = sim.Get(s.balance.total);
  double deepest = 0, last = sim.Get(s.balance.stored);
  Eigen::ArrayXd met = Eigen::ArrayXd::Zero(7);
  for (double t = 0.01; t < 4; t += 0.01) {
    sim.AdvanceTo(t);
    const JointPosition& p = sim.Get(s.stops.penetration);
    met = met.max(p.array().abs());
    deepest = std::max(deepest, p.cwiseAbs().maxCoeff());
    EXPECT_GE(sim.Get(s.stops.dissipation), 0);
    EXPECT_LE(sim.Get(s.balance.stored), last + 1e-7);
    last = sim.Get(s.balance.stored);
  }
  EXPECT_GT(met(1), 0);
  EXPECT_GT(met(3), 0);
  EXPECT_GT(met(5), 0);
  // ½ k p² is at most the energy of the fall, about 100 J.
  EXPECT_LT(deepest, std::sqrt(2 * 100.0 / 2000));
  EXPECT_NEAR(sim.Get(s.balance.total), total, 1e-6);  // 1e-11 of 100 J, 8000 steps
}

TEST(JointStops, KeepTheLaws) {
  BlockTester<JointStops> t(JointStops::Options{.model = Gen3(),
                                                .stiffness = PerJoint::Constant(7, 1000),
                                                .damping = PerJoint::Constant(7, 0.5)});
  ExpectBlockLaws(std::move(t));
}

TEST(JointStops, RefuseWhatIsNoStop) {
  const auto error = [](auto change) {
    JointStops::Options o{.model = Gen3(), .stiffness = PerJoint::Constant(7, 1000)};
    change(o);
    return ErrorOf([&] { JointStops stops(o); });
  };
  using O = JointStops::Options;
  EXPECT_EQ(error([](O& o) { o.stiffness(1) = 0; }),
            "stiffness[joint_2] must be > 0 N·m/rad, got 0");
  EXPECT_EQ(error([](O& o) { o.damping = PerJoint::Constant(7, -1); }),
            "damping[joint_1] must be >= 0 s/rad, got -1");
  EXPECT_EQ(error([](O& o) { o.lower = JointPosition(PerJoint::Constant(7, 2.3)); }),
            "lower[joint_2] must be < upper = 2.24, got 2.3");
  EXPECT_EQ(error([](O& o) {
              o.upper = {1, 2};
            }),
            "upper has an element for each of the 7 joints, got 2");
  EXPECT_EQ(error([](O& o) { o.stiffness.resize(0); }),
            "stiffness has an element for each of the 7 joints, got 0");
  EXPECT_EQ(ErrorOf([] {
              JointStops stops({.model = Gantry(1), .stiffness = PerJoint::Constant(3, -1)});
            }),
            "stiffness[x] must be > 0 N/m, got -1");
}

}  // namespace
}  // namespace pliant
