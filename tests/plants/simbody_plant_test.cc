#include "pliant/plants/simbody_plant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/plants/joint_sensors.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/push.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Engine = SimbodyPlant::Engine;

const Simulator::Options kAccurate{.integrator = {.method = Method::kDormandPrince,
                                                  .relative_tolerance = 1e-11,
                                                  .absolute_tolerance = 1e-12}};

const JointPosition kPosture{0.1, 0.4, 0.2, -1.2, 0.3, 0.8, 0.1};

TEST(ModelDynamics, AddsTheInertiaOfRotors) {
  const RobotModel m = Gen3();
  RandomStates random(m, 71);
  const PerJoint B = PerJoint::LinSpaced(7, 0.1, 0.7);
  BlockTester<ModelDynamics> t({.model = m, .frames = {"tool_frame"}, .rotor_inertia = B});
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    RobotDynamics d(m, {"tool_frame"});
    ComputeDynamics(m, q, v, d);
    t.Set(t->position, q);
    t.Set(t->velocity, v);
    const RobotDynamics& with = t.Get(t->dynamics);
    EXPECT_EQ(with.M, JointMatrix(d.M + JointMatrix(B.asDiagonal())));
    EXPECT_LT((with.p - with.M * v).norm(), 1e-13);
    EXPECT_EQ(with.coriolis, d.coriolis);
    EXPECT_EQ(with.coriolis_transposed, d.coriolis_transposed);
    EXPECT_EQ(with.gravity, d.gravity);
    EXPECT_EQ(with.frame[0].J, d.frame[0].J);
  }
  const auto error = [&](const PerJoint& rotors) {
    return ErrorOf([&] { ModelDynamics block({.model = m, .rotor_inertia = rotors}); });
  };
  EXPECT_EQ(error(PerJoint::Ones(2)),
            "rotor_inertia has an element for each of the 7 joints, got 2");
  EXPECT_EQ(error(PerJoint::Constant(7, -1)), "rotor_inertia[joint_1] must be >= 0 kg·m², got -1");
}

/// A Gen3 with damping and rotors that is pushed while gravity pulls it down.
JointPosition Fall(Engine engine, double seconds) {
  const RobotModel m = Gen3();
  BlockTester<SimbodyPlant> t(SimbodyPlant::Options{.model = m,
                                                    .position = kPosture,
                                                    .damping = PerJoint::Constant(7, 0.5),
                                                    .rotor_inertia = PerJoint::Constant(7, 0.2),
                                                    .engine = engine},
                              kAccurate);
  t.Set(t->torque, {1, -2, 3, -4, 0.5, 0.6, 0.7});
  t.Join(t->contacts, {m.link_index("forearm_link"), {0, 0.05, -0.1}, {5, -10, 20}, {1, 0, 0}});
  t.Join(t->contacts, {m.link_index("tool_frame"), {0, 0, 0}, {-3, 2, 1}, {0, 0, 0.1}});
  t.AdvanceTo(seconds);
  return t.Get(t->position);
}

TEST(SimbodyPlant, MovesAlikeWithBothEngines) {
  const JointPosition simbody = Fall(Engine::Simbody, 1), recursive = Fall(Engine::Recursive, 1);
  EXPECT_GT((simbody - kPosture).norm(), 0.1);
  // Local errors of 10⁻¹¹ over some hundred steps, and what an arm that falls makes of them in 1 s.
  EXPECT_LT((simbody - recursive).norm(), 1e-7);
}

TEST(SimbodyPlant, SlowsDownByViscousFriction) {
  const RobotModel m = Gen3().WithGravity({0, 0, 0});
  const JointVelocity v{0.5, 0, 0, 0, 0, 0, 0};
  // Stretched upwards and turning about joint 1 only, its axis is one of symmetry for C v.
  BlockTester<SimbodyPlant> t(SimbodyPlant::Options{.model = m,
                                                    .position = JointPosition::Zero(m.joints()),
                                                    .velocity = v,
                                                    .damping = PerJoint::Constant(7, 3),
                                                    .rotor_inertia = PerJoint::Constant(7, 1000),
                                                    .engine = Engine::Recursive},
                              kAccurate);
  t.Set(t->torque, JointTorque::Zero(m.joints()));
  t.AdvanceTo(100);
  // With rotors far heavier than links, v = v₀ exp(−d t / B) up to the links' share of the inertia.
  EXPECT_NEAR(t.Get(t->velocity)(0), 0.5 * std::exp(-3 * 100 / 1000.0), 1e-4);
}

/// Energy of the arm and work done on it.
class Ledger final : public Block {
 public:
  explicit Ledger(const RobotModel& m)
      : velocity{this, "velocity", m.joints()},
        driven{this, "driven", m.joints()},
        pushed{this, "pushed", m.joints()},
        work{this, "work"} {
    Derivative(work)
        .From(velocity, driven, pushed)
        .As([](const JointVelocity& v, const JointTorque& tau, const JointTorque& tau_e) {
          return v.dot(tau + tau_e - 0.5 * v);  // 0.5 N·m·s/rad of friction
        });
  }
  Input<JointVelocity> velocity;
  Input<JointTorque> driven, pushed;
  Continuous<double> work;
};

TEST(SimbodyPlant, GainsTheEnergyThatTorquesAndPushesDo) {
  for (const Engine engine : {Engine::Simbody, Engine::Recursive}) {
    const RobotModel m = Gen3();
    const PerJoint B = PerJoint::Constant(7, 0.2);
    const JointTorque tau{1, -2, 3, -4, 0.5, 0.6, 0.7};
    DiagramBuilder b;
    auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = m.joints(), .value = tau});
    auto& push = b.Add<Push>("push", {.model = m,
                                      .link = "forearm_link",
                                      .point = {0, 0.05, -0.1},
                                      .force = {10, -20, 30},
                                      .start_s = 0.1,
                                      .duration_s = 0.6});
    auto& plant = b.Add<SimbodyPlant>("plant", {.model = m,
                                                .position = kPosture,
                                                .damping = PerJoint::Constant(7, 0.5),
                                                .rotor_inertia = B,
                                                .engine = engine});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = m, .rotor_inertia = B});
    auto& truth = b.Add<ContactTorque>("truth", {.model = m});
    auto& ledger = b.Add<Ledger>("ledger", m);
    b.Connect(torque.y, plant.torque);
    b.Connect(push.force, plant.contacts);
    b.Connect(plant.position, dynamics.position);
    b.Connect(plant.velocity, dynamics.velocity);
    b.Connect(dynamics.dynamics, truth.dynamics);
    b.Connect(push.force, truth.contacts);
    b.Connect(plant.velocity, ledger.velocity);
    b.Connect(torque.y, ledger.driven);
    b.Connect(truth.torque, ledger.pushed);
    const Diagram diagram = b.Build();
    Simulator sim(diagram, kAccurate);
    const auto energy = [&] {
      const RobotDynamics& d = sim.Get(dynamics.dynamics);
      return KineticEnergy(d) + PotentialEnergy(m, d);
    };
    const double before = energy();
    sim.AdvanceTo(1.0);
    EXPECT_GT(std::abs(sim.Get(ledger.work)), 1);
    // Local errors of 10⁻¹¹ in each of a thousand samples.
    EXPECT_NEAR(energy() - before, sim.Get(ledger.work), 1e-7);
  }
}

TEST(SimbodyPlant, TakesNothingFromTheHeapWhileThreeContactsMoveIt) {
  const RobotModel m = Gen3();
  BlockTester<SimbodyPlant> t(
      SimbodyPlant::Options{.model = m, .position = kPosture, .engine = Engine::Recursive});
  t.Set(t->torque, JointTorque::Zero(m.joints()));
  for (int i = 0; i < 3; ++i)
    t.Join(t->contacts, {m.link_index("forearm_link"), {0, 0, 0}, {1, 2, 3}, {0, 0, 0}});
  t.simulator();
  const long before = Allocations();
  t.AdvanceTo(0.1);
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(SimbodyPlant, ShowsTheMotionOfItsFrames) {
  const RobotModel m = Gen3();
  BlockTester<SimbodyPlant> t(SimbodyPlant::Options{.model = m,
                                                    .position = kPosture,
                                                    .frames = {"tool_frame", "forearm_link"},
                                                    .engine = Engine::Recursive});
  t.Set(t->torque, JointTorque::Zero(m.joints()));
  RobotDynamics d(m);
  ComputeDynamics(m, kPosture, JointVelocity::Zero(m.joints()), d);
  const RobotDynamics& shown = t.Get(t->motion);
  ASSERT_EQ(shown.frames, 2);
  EXPECT_EQ(shown.frame[0].pose.position, LinkPose(m, d, m.link_index("tool_frame")).position);
  EXPECT_EQ(shown.frame[1].pose.rotation, LinkPose(m, d, m.link_index("forearm_link")).rotation);
}

TEST(SimbodyPlant, RefusesOptionsThatMakeNoPlant) {
  const auto error = [](auto change) {
    SimbodyPlant::Options o{.model = Gen3(), .position = kPosture, .engine = Engine::Recursive};
    change(o);
    return ErrorOf([&] { SimbodyPlant plant(o); });
  };
  using O = SimbodyPlant::Options;
  EXPECT_EQ(error([](O& o) {
              o.position = {1, 2};
            }),
            "position has an element for each of the 7 joints, got 2");
  EXPECT_EQ(error([](O& o) {
              o.velocity = {1, 2, 3};
            }),
            "velocity has an element for each of the 7 joints, got 3");
  EXPECT_EQ(error([](O& o) { o.position(3) = NAN; }),
            "position[joint_4] must be finite rad, got nan");
  EXPECT_EQ(error([](O& o) { o.damping = PerJoint::Constant(7, -0.5); }),
            "damping[joint_1] must be >= 0 N·m·s/rad, got -0.5");
  EXPECT_EQ(error([](O& o) { o.rotor_inertia = PerJoint::Constant(7, -2); }),
            "rotor_inertia[joint_1] must be >= 0 kg·m², got -2");
  EXPECT_EQ(error([](O& o) { o.frames.assign(9, "tool_frame"); }),
            "dynamics of at most 8 frames are computed, got 9");
  EXPECT_THAT(error([](O& o) { o.frames = {"tol_frame"}; }), testing::HasSubstr("tool_frame"));
}

TEST(JointSensors, HoldWhatTheySampled) {
  const Joints joints = Joints::Numbered(2);
  BlockTester<JointSensors> t({.joints = joints, .period = 1ms});
  t.Set(t->position, {1, 2});
  t.Set(t->velocity, {3, 4});
  t.Set(t->torque, {5, 6});
  t.Tick();
  t.Set(t->position, {-1, -2});
  t.Set(t->velocity, {-3, -4});
  t.Set(t->torque, {-5, -6});
  EXPECT_EQ(t.Get(t->measured_position), JointPosition({1, 2}));
  EXPECT_EQ(t.Get(t->measured_velocity), JointVelocity({3, 4}));
  EXPECT_EQ(t.Get(t->measured_torque), JointTorque({5, 6}));
  t.Tick();
  EXPECT_EQ(t.Get(t->measured_position), JointPosition({-1, -2}));
}

}  // namespace
}  // namespace pliant
