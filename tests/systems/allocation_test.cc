#include <gtest/gtest.h>

#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

const Joints kJoints = Joints::Numbered(7);

/// q̇ = v, v̇ = −q + u; at each turn of the first joint its speed is set anew.
class Swing final : public Block {
 public:
  Swing()
      : u{this, "u", kJoints},
        speed{this, "speed", kJoints},
        first{this, "first"},
        q{this, "q", kJoints, JointPosition(PerJoint::Ones(7))},
        v{this, "v", kJoints},
        turns{this, "turns"} {
    Derivative(q).From(v).As([](const JointVelocity& now) { return now; });
    Derivative(v).From(q, u).As([](const JointPosition& angle, const JointVelocity& push) {
      return JointAcceleration(push - angle);
    });
    Compute(speed).From(v).As([](const JointVelocity& now) { return now; });
    Compute(first).From(q).As([](const JointPosition& now) { return now(0); });
    const auto turn = When(first).Crosses(Direction::Both);
    turn.Update(v).From(v).As([](const JointVelocity& now) { return JointVelocity(1.001 * now); });
    turn.Update(turns).From(turns).As([](int n) { return n + 1; });
  }
  Input<JointVelocity> u;
  Output<JointVelocity> speed;
  Output<double> first;
  Continuous<JointPosition> q;
  Continuous<JointVelocity> v;
  Discrete<int> turns;
};

/// Allocations from 1 s to 10 s of a run, which is steady by then.
long AllocationsOf(Simulator& sim) {
  sim.AdvanceTo(1);
  const long before = Allocations();
  for (int k = 1001; k <= 10'000; ++k) sim.AdvanceTo(k / 1e3);
  return Allocations() - before;
}

TEST(Allocation, IsCounted) {
  if (!kCountsAllocations) return;  // a sanitizer has a heap of its own
  const long before = Allocations();
  const std::vector<double> vector(100);
  EXPECT_EQ(Allocations() - before, 1) << vector.size();
}

TEST(Allocation, IsNoneInSampledBlocksOfSeveralRates) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& fast = b.Add<LowPass<double>>("fast", {.cutoff_hz = 3, .period = 1ms});
  auto& slow = b.Add<LowPass<double>>("slow", {.cutoff_hz = 3, .period = Hertz(30)});
  auto& gain = b.Add<Gain<double>>("gain", {.gain = 2});
  auto& delay = b.Add<Delay>("delay", {.period = 2ms});
  b.Connect(one.y, fast.u);
  b.Connect(fast.y, slow.u);
  b.Connect(slow.y, gain.u);
  b.Connect(gain.y, delay.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(AllocationsOf(sim), 0);
}

TEST(Allocation, IsNoneInStepsAndAtGuards) {
  for (const IntegratorOptions& integrator :
       {IntegratorOptions{}, IntegratorOptions{.method = Method::kDormandPrince},
        IntegratorOptions{.fixed_step_s = 1e-3}, IntegratorOptions{.method = Method::kAdams}}) {
    DiagramBuilder b;
    auto& swing = b.Add<Swing>("swing");
    auto& filter =
        b.Add<LowPass<JointVelocity>>("filter", {.space = kJoints, .cutoff_hz = 3, .period = 5ms});
    auto& gain = b.Add<Gain<JointVelocity>>("gain", {.space = kJoints, .gain = -0.1});
    b.Connect(swing.speed, filter.u);
    b.Connect(filter.y, gain.u);
    b.Connect(gain.y, swing.u);
    const Diagram diagram = b.Build();
    Simulator sim{diagram, {.integrator = integrator}};
    EXPECT_EQ(AllocationsOf(sim), 0) << Name(integrator.method);
    EXPECT_GE(sim.Get(swing.turns), 3) << Name(integrator.method);
  }
}

TEST(Allocation, IsNoneInReadingSettingAndRestoring) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<JointVelocity>>(
      "one", {.space = kJoints, .value = JointVelocity::Zero(kJoints)});
  auto& swing = b.Add<Swing>("swing");
  b.Connect(one.y, swing.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  const Context snapshot = sim.Snapshot();
  const JointVelocity push{1, 2, 3, 4, 5, 6, 7};
  const long before = Allocations();
  sim.Set(one.value, push);
  sim.Get(swing.speed);
  sim.Restore(snapshot);
  EXPECT_EQ(Allocations() - before, 0);
}

}  // namespace
}  // namespace pliant
