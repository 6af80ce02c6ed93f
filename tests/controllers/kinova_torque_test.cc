#include "pliant/controllers/kinova_torque.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/plants/kinova_lag.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"first", "second"};
const Eigen::Vector2d kKappa(11, 7.6);

KinovaHighVelocityTorque::Options Loop(double feedforward, double gain) {
  return {.joints = kTwo,
          .torque_per_ampere = kKappa,
          .reflected_inertia = Eigen::Vector2d(0.4, 0.22),
          .feedforward = feedforward,
          .gain = gain,
          .period = 1ms};
}

/// H(1), of the printed coefficients.
double StaticGain() {
  const auto& [b0, b1, b2] = KinovaLag::b;
  const auto& [a0, a1, a2] = KinovaLag::a;
  return (b0 + b1 + b2) / (a0 + a1 + a2);
}

/// Joints that nothing moves: what the motors make is what the sensors see, a tick later.
template <class Loop>
JointTorque Delivered(BlockTester<Loop>& t, const JointTorque& wanted, int ticks) {
  JointTorque delivered = JointTorque::Zero(kTwo);
  t.Set(t->torque, wanted);
  t.Set(t->acceleration, {0, 0});
  t.Set(t->measured_velocity, {0, 0});
  for (int k = 0; k < ticks; ++k) {
    t.Set(t->measured_torque, delivered);
    t.Tick();
    delivered = t.Get(t->current).cwiseProduct(kKappa);
  }
  return delivered;
}

// τ = f τ_d + k H(1) (τ_d − τ) at rest. The slowest pole of the loop is 1 Hz and more.
TEST(KinovaHighVelocityTorque, DeliversThePartOfTheTorqueThatItsGainsAllow) {
  const double H1 = StaticGain();
  EXPECT_NEAR(H1, 1, 1e-3);
  const JointTorque wanted{20, -8};
  for (const double f : {0.0, 0.5, 1.0})
    for (const double k : {0.0, 1.0, 10.0}) {
      BlockTester<KinovaHighVelocityTorque> t(Loop(f, k));
      const JointTorque delivered = Delivered(t, wanted, 10000);
      const double part = (f + k * H1) / (1 + k * H1);
      EXPECT_LT((delivered - part * wanted).norm(), 1e-9) << "f = " << f << ", k = " << k;
      EXPECT_LT((t.Get(t->error) - (1 - part) * wanted).norm(), 1e-9);
    }
}

// 1 + k H(z)/z has a zero at z = −1, where it leaves the unit circle first: at high frequencies H
// is a gain, a tick late.
TEST(KinovaHighVelocityTorque, IsStableUpToTheGainThatMakesUpForTheLag) {
  const auto& [b0, b1, b2] = KinovaLag::b;
  const double limit = (1 - KinovaLag::a[1] + KinovaLag::a[2]) / (b0 - b1 + b2);
  EXPECT_NEAR(limit, 53.3, 0.1);
  const JointTorque wanted{1, -1};
  for (const double part : {0.97, 1.03}) {
    BlockTester<KinovaHighVelocityTorque> t(Loop(0, part * limit));
    const double k = part * limit * StaticGain();
    const double off = (Delivered(t, wanted, 5000) - k / (1 + k) * wanted).norm();
    if (part < 1)
      EXPECT_LT(off, 1e-6);
    else
      EXPECT_GT(off, 1e6);
  }
}

TEST(KinovaDampedTorque, HoldsBackWithTheVelocity) {
  const double d = 8;
  BlockTester<KinovaDampedTorque> damped({.torque = Loop(1, 3), .damping = d});
  BlockTester<KinovaHighVelocityTorque> free(Loop(1, 3));
  const JointVelocity v{0.5, -2};
  const auto run = [&](auto& t) {
    t.Set(t->torque, {5, 3});
    t.Set(t->acceleration, {1, 1});
    t.Set(t->measured_velocity, v);
    t.Set(t->measured_torque, {4, 4});
    for (int k = 0; k < 50; ++k) t.Tick();
    return JointTorque(t.Get(t->current).cwiseProduct(kKappa));
  };
  EXPECT_LT((run(free) - run(damped) - d * PerJoint(v)).norm(), 1e-12);
}

TEST(KinovaHighVelocityTorque, DoesNotKnowOfTheRotorsButItsErrorDoes) {
  BlockTester<KinovaHighVelocityTorque> t(Loop(1, 5));
  t.Set(t->torque, {20, -8});
  t.Set(t->acceleration, {5, -2});
  t.Set(t->measured_velocity, {1, -1});
  t.Set(t->measured_torque, {20, -8});
  for (int k = 0; k < 1000; ++k) t.Tick();
  EXPECT_LT((t.Get(t->current) - PerJoint(Eigen::Vector2d(20 / 11., -8 / 7.6))).norm(), 1e-12);
  EXPECT_LT((t.Get(t->error) - PerJoint(Eigen::Vector2d(-0.4 * 5, 0.22 * 2))).norm(), 1e-12);
}

TEST(KinovaHighVelocityTorque, ReportsTheCurrentsItCuts) {
  KinovaHighVelocityTorque::Options o = Loop(1, 0);
  o.current_limit = {2, 2};
  BlockTester<KinovaHighVelocityTorque> t(o);
  t.Set(t->torque, {50, -8});
  t.Set(t->acceleration, {0, 0});
  t.Set(t->measured_velocity, {0, 0});
  t.Set(t->measured_torque, {0, 0});
  EXPECT_EQ(t.Get(t->saturated), 1U);
  EXPECT_EQ(t.Get(t->current)(0), 2);
}

TEST(KinovaHighVelocityTorque, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<KinovaHighVelocityTorque>(Loop(1, 10)));
  ExpectBlockLaws(BlockTester<KinovaDampedTorque>(
      KinovaDampedTorque::Options{.torque = Loop(0, 10), .damping = 8}));
}

TEST(KinovaHighVelocityTorque, RefusesGainsThatAreNone) {
  const auto error = [](auto change) {
    KinovaDampedTorque::Options o{.torque = Loop(1, 1), .damping = 8};
    change(o);
    return ErrorOf([&] { KinovaDampedTorque loop(o); });
  };
  using O = KinovaDampedTorque::Options;
  EXPECT_EQ(error([](O& o) { o.torque.feedforward = -1; }), "feedforward must be >= 0, got -1");
  EXPECT_EQ(error([](O& o) { o.torque.gain = -1; }), "gain must be >= 0, got -1");
  EXPECT_EQ(error([](O& o) { o.damping = -8; }), "damping must be >= 0 N·m·s/rad, got -8");
  EXPECT_EQ(error([](O& o) { o.torque.torque_per_ampere(1) = 0; }),
            "motor: torque_per_ampere[second] must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](O& o) { o.torque.reflected_inertia(0) = -1; }),
            "error: reflected_inertia[first] must be >= 0 kg·m², got -1");
  EXPECT_EQ(error([](O& o) { o.torque.period = 2ms; }),
            "period must be 1 ms: H is made for it, got 2 ms");
}

}  // namespace
}  // namespace pliant
