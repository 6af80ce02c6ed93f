#include "pliant/estimators/momentum_observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "pliant/diagrams/stations.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/push.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPeriod = 1e-3;

/// Dynamics that only an observer could tell from an arm's: p, Cᵀ q̇ and g as chosen.
RobotDynamics Made(const PerJoint& p, const PerJoint& coriolis_transposed,
                   const PerJoint& gravity) {
  static const RobotModel m = Gen3();
  RobotDynamics d(m);
  d.p = p;
  d.coriolis_transposed = coriolis_transposed;
  d.gravity = gravity;
  return d;
}

TEST(MomentumObserver, RespondsToAConstantTorqueAsAFirstOrderLag) {
  const RobotModel m = Gen3();
  RandomStates random(m, 51);
  const PerJoint gain = PerJoint::LinSpaced(7, 10, 70);
  const JointTorque tau_e = random.tau(), tau = random.tau();
  const PerJoint gravity = random.tau(), coriolis = random.tau(), p0 = random.tau();
  for (const double slope : {0.0, 3.0}) {  // of Cᵀ q̇ − g: an arm at rest, and in motion
    BlockTester<MomentumObserver> t({.joints = m.joints(), .gain = gain, .period = 1ms});
    for (int k = 0; k <= 500; ++k) {
      const double s = k * kPeriod;
      // ṗ = τ + Cᵀ q̇ − g + τ_e with Cᵀ q̇ = (1 + slope t) coriolis
      const PerJoint p = p0 + s * (tau - gravity + tau_e) + (s + 0.5 * slope * s * s) * coriolis;
      t.Set(t->dynamics, Made(p, (1 + slope * s) * coriolis, gravity));
      t.Set(t->torque, tau);
      t.Tick();
      for (int i = 0; i < 7; ++i) {
        const double expected = tau_e(i) * (1 - std::exp(-gain(i) * s));
        // round-off of p over h: ε 30 N·m·s / 1 ms, let through by 1 − e^{−K h} at a time
        ASSERT_NEAR(t.Get(t->residual)(i), expected, 1e-11) << k;
      }
    }
  }
}

TEST(MomentumObserver, TakesRotorsOffTheMomentum) {
  const RobotModel m = Gen3();
  RandomStates random(m, 53);
  const PerJoint B = random.Uniform(1).cwiseAbs();
  BlockTester<ModelDynamics> links({.model = m}), all({.model = m, .rotor_inertia = B});
  MomentumObserver::Options o{
      .joints = m.joints(), .gain = PerJoint::Constant(7, 50), .period = 1ms};
  BlockTester<MomentumObserver> of_links(o);
  o.rotor_inertia = B;
  BlockTester<MomentumObserver> of_all(o);
  const auto tick = [](auto& observer, const RobotDynamics& d, const JointTorque& tau) {
    observer.Set(observer->dynamics, d);
    observer.Set(observer->torque, tau);
    observer.Tick();
    return observer.Get(observer->residual);
  };
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointTorque tau = random.tau();
    for (auto* model : {&links, &all}) {
      model->Set((*model)->position, q);
      model->Set((*model)->velocity, v);
    }
    const PerJoint expected = tick(of_links, links.Get(links->dynamics), tau);
    const PerJoint found = tick(of_all, all.Get(all->dynamics), tau);
    // round-off of p, ε 10 N·m·s, over h, let through by K h
    ASSERT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12) << k;
  }
}

TEST(MomentumObserver, DoesNotDrift) {
  // With ṗ = τ + Cᵀ q̇ − g, errors of single samples in p cancel: their sum telescopes.
  const RobotModel m = Gen3();
  BlockTester<MomentumObserver> t(
      {.joints = m.joints(), .gain = PerJoint::Constant(7, 50), .period = 1ms});
  double largest = 0;
  RandomStates random(m, 52);
  const double noise = 1e-3;  // N·m·s
  for (int k = 0; k < 20'000; ++k) {
    t.Set(t->dynamics, Made(random.Uniform(noise), PerJoint::Zero(7), PerJoint::Zero(7)));
    t.Set(t->torque, JointTorque::Zero(m.joints()));
    t.Tick();
    largest = std::max(largest, t.Get(t->residual).cwiseAbs().maxCoeff());
  }
  // r = K (p − p_0 − lag of it), each at most the noise; (1 − e^{−K h})/h ≤ K
  EXPECT_LE(largest, 50 * 3 * noise);
}

/// The Gen3, driven by sines, as its sensors and an observer see it.
struct Watched {
  Watched(double gain, double damping, double amplitude, std::vector<Push::Options> pushes,
          bool with_rotors = false)
      : model{pushes.empty() ? Gen3() : pushes.front().model} {
    const Joints& joints = model.joints();
    const JointPosition start{0.1, 0.3, 0.2, -1.2, 0.3, 0.8, 0.1};
    SimulatedArm::Options station{
        .model = model, .position = start, .engine = SimbodyPlant::Engine::Recursive};
    if (with_rotors) {
      station = SimulatedGen3(
          model, {.position = start, .ideal = true, .engine = SimbodyPlant::Engine::Recursive});
      rotors = station.actuators.reflected_inertia();
    }
    const PerJoint gains = PerJoint::Constant(7, gain);
    DiagramBuilder b;
    arm = &b.Add<SimulatedArm>("arm", station);
    dynamics = &b.Add<ModelDynamics>("dynamics", {.model = model, .rotor_inertia = rotors});
    drive = &b.Add<Drive>("drive", damping, amplitude, joints);
    observer = &b.Add<MomentumObserver>(
        "observer", {.joints = joints, .gain = gains, .period = 1ms, .rotor_inertia = rotors});
    unaware = &b.Add<MomentumObserver>("unaware", {.joints = joints, .gain = gains, .period = 1ms});
    truth = &b.Add<ContactTorque>("truth", {.model = model});
    int i = 0;
    for (const Push::Options& o : pushes) {
      auto& push = b.Add<Push>("push_" + std::to_string(++i), o);
      b.Connect(push.force, arm->contacts);
      b.Connect(push.force, truth->contacts);
    }
    b.Connect(arm->measured_position, dynamics->position);
    b.Connect(arm->measured_velocity, dynamics->velocity);
    b.Connect(dynamics->dynamics, drive->dynamics);
    b.Connect(dynamics->dynamics, observer->dynamics);
    b.Connect(dynamics->dynamics, truth->dynamics);
    b.Connect(arm->measured_torque, observer->torque);
    b.Connect(dynamics->dynamics, unaware->dynamics);
    b.Connect(arm->measured_torque, unaware->torque);
    b.Connect(drive->torque, arm->torque_command);
    diagram.emplace(b.Build());
    IntegratorOptions accurate{.relative_tolerance = 1e-9, .absolute_tolerance = 1e-11};
    sim.emplace(*diagram, Simulator::Options{.integrator = accurate});
  }

  struct Drive final : Block {
    Drive(double damping, double a, const Joints& joints)
        : dynamics{this, "dynamics", joints},
          torque{this, "torque", joints},
          damping_{damping},
          amplitude_{a} {
      Every(1ms).Compute(torque).From(clock, dynamics).As(&Drive::At);
    }
    Input<RobotDynamics> dynamics;
    Output<JointTorque> torque;

   private:
    JointTorque At(double t, const RobotDynamics& d) const {
      const PerJoint phase = PerJoint::LinSpaced(d.v.size(), 0, 3);
      const PerJoint wave = amplitude_ * (phase.array() + 5 * t).sin();
      return d.gravity + d.M.diagonal().cwiseProduct(wave - damping_ * d.v);
    }
    const double damping_, amplitude_;
  };

  RobotModel model;
  PerJoint rotors = PerJoint::Zero(7);
  SimulatedArm* arm;
  ModelDynamics* dynamics;
  Drive* drive;
  MomentumObserver *observer, *unaware;  // of the rotors
  ContactTorque* truth;
  std::optional<Diagram> diagram;
  std::optional<Simulator> sim;
};

TEST(MomentumObserver, StaysAtZeroInFreeFastMotion) {
  Watched run(50, 1, 20, {});
  double residual = 0, bound = 0, speed = 0;
  PerJoint before[2] = {PerJoint::Zero(7), PerJoint::Zero(7)};
  for (int k = 0; k < 2000; ++k) {
    run.sim->AdvanceThroughTick();
    const RobotDynamics& d = run.sim->Get(run.dynamics->dynamics);
    const PerJoint beta = d.coriolis_transposed - d.gravity;
    // The trapezoid misses h²/12 β̈ of the mean of β; β̈ by second differences.
    if (k >= 2)
      bound = std::max(bound, (beta - 2 * before[1] + before[0]).cwiseAbs().maxCoeff() / 12);
    before[0] = before[1];
    before[1] = beta;
    residual = std::max(residual, run.sim->Get(run.observer->residual).cwiseAbs().maxCoeff());
    speed = std::max(speed, d.v.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(speed, 2) << "rad/s: the motion was to be fast";
  EXPECT_LE(residual, 2 * bound);  // and h⁴ terms, and the jumps of β̈ at the ticks
  EXPECT_GT(residual, 0);
}

TEST(MomentumObserver, FollowsAPushOnAMovingArm) {
  const RobotModel m = Gen3();
  const double gain = 50, edge = 0.2;
  Watched run(gain, 2, 5,
              {{.model = m,
                .link = "forearm_link",
                .point = {0, 0.05, -0.1},
                .force = {10, -20, 15},
                .start_s = 0.3,
                .duration_s = 0.9,
                .edge_s = edge},
               {.model = m,
                .link = "tool_frame",
                .force = {-5, 8, 12},
                .start_s = 0.5,
                .duration_s = 0.6,
                .edge_s = edge}});
  PerJoint last = PerJoint::Zero(7);
  double lag = 0, rate = 0, pushed = 0;
  PerJoint expected = PerJoint::Zero(7);
  double filtered = 0;
  for (int k = 0; k < 1500; ++k) {
    run.sim->AdvanceThroughTick();
    const PerJoint tau_e = run.sim->Get(run.truth->torque);
    const PerJoint r = run.sim->Get(run.observer->residual);
    if (k > 0) rate = std::max(rate, (tau_e - last).cwiseAbs().maxCoeff() / kPeriod);
    // ṙ = K (τ_e − r), with the push of a tick acting until the next
    expected = std::exp(-gain * kPeriod) * expected + (1 - std::exp(-gain * kPeriod)) * last;
    filtered = std::max(filtered, (r - expected).cwiseAbs().maxCoeff());
    lag = std::max(lag, (r - tau_e).cwiseAbs().maxCoeff());
    pushed = std::max(pushed, tau_e.cwiseAbs().maxCoeff());
    last = tau_e;
  }
  EXPECT_GT(pushed, 3);                          // [N·m], so there is something to follow
  EXPECT_LE(lag, rate / gain + rate * kPeriod);  // of a first-order lag, and a sample
  EXPECT_LE(filtered, rate * kPeriod);           // the lever arm moves within the sample
}

TEST(MomentumObserver, FindsAPushOnAnArmWithRotors) {
  const double gain = 50, decay = std::exp(-gain * kPeriod);
  Watched run(gain, 2, 5,
              {{.model = Gen3(),
                .link = "forearm_link",
                .point = {0, 0.05, -0.1},
                .force = {20, -40, 30},
                .start_s = 0.3,
                .duration_s = 0.9}},
              true);
  PerJoint last = PerJoint::Zero(7), u = last, v = last, expected = last;
  double filtered = 0, unaware = 0, rate = 0, pushed = 0;
  for (int k = 0; k < 1500; ++k) {
    run.sim->AdvanceThroughTick();
    const PerJoint now = run.sim->Get(run.arm->measured_velocity);
    const PerJoint tau_e = run.sim->Get(run.truth->torque);
    if (k > 0) {
      rate = std::max(rate, (tau_e - last).cwiseAbs().maxCoeff() / kPeriod);
      // The sensor reads u − B v̇ at the end of a sample; its mean is u − B Δv/h.
      const PerJoint mean = u - run.rotors.cwiseProduct(now - v) / kPeriod;
      const PerJoint sampled = mean - run.sim->Get(run.arm->measured_torque);
      expected = decay * expected + (1 - decay) * (last + sampled);
      filtered = std::max(filtered,
                          (run.sim->Get(run.observer->residual) - expected).cwiseAbs().maxCoeff());
      unaware =
          std::max(unaware, (run.sim->Get(run.unaware->residual) - expected).cwiseAbs().maxCoeff());
    }
    pushed = std::max(pushed, tau_e.cwiseAbs().maxCoeff());
    last = tau_e;
    u = run.sim->Get(run.drive->torque);
    v = now;
  }
  EXPECT_GT(pushed, 3);                 // [N·m]
  EXPECT_LE(filtered, rate * kPeriod);  // the lever arm moves within the sample
  EXPECT_GT(unaware, pushed / 3);       // B q̈ is no push
}

TEST(MomentumObserver, RefusesGainsThatAreNone) {
  const Joints joints = Joints::Numbered(2);
  const auto error = [&](const PerJoint& gain) {
    return ErrorOf([&] { MomentumObserver o({.joints = joints, .gain = gain, .period = 1ms}); });
  };
  EXPECT_EQ(error(PerJoint::Ones(3)), "gain has an element for each of the 2 joints, got 3");
  EXPECT_EQ(error(PerJoint::Zero(2)), "gain[joint_1] must be > 0 1/s, got 0");
  EXPECT_EQ(ErrorOf([&] {
              MomentumObserver o({.joints = joints,
                                  .gain = PerJoint::Ones(2),
                                  .period = 1ms,
                                  .rotor_inertia = PerJoint::Constant(2, -1)});
            }),
            "rotor_inertia[joint_1] must be >= 0 kg·m², got -1");
}

}  // namespace
}  // namespace pliant
