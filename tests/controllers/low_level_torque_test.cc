#include "pliant/controllers/low_level_torque.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"first", "second"};
const FrictionCompensation::Options kFriction{.joints = kTwo,
                                              .coulomb = Eigen::Vector2d(3, 1.25),
                                              .viscous = Eigen::Vector2d(2.4, 1.1),
                                              .stiction = Eigen::Vector2d(3.5, 1.5)};

TEST(FrictionCompensation, FollowsMotionElseIntention) {
  BlockTester<FrictionCompensation> t(kFriction);
  const auto at = [&](JointVelocity v, JointAcceleration a) {
    t.Set(t->velocity, v);
    t.Set(t->acceleration, a);
    return Eigen::Vector2d(t.Get(t->torque));
  };
  EXPECT_EQ(at({0.5, -0.1}, {-9, 9}), Eigen::Vector2d(3 + 2.4 * 0.5, -1.25 - 1.1 * 0.1));
  EXPECT_EQ(at({0.09, -0.09}, {-1, 20}), Eigen::Vector2d(-3.5, 1.5));
  EXPECT_EQ(at({0.09, 0}, {0.99, -0.5}), Eigen::Vector2d(0, 0));
}

LowLevelTorque::Options Options() {
  return {.joints = kTwo,
          .torque_per_ampere = Eigen::Vector2d(11, 7.6),
          .reflected_inertia = Eigen::Vector2d(0.4, 0.22),
          .friction = kFriction,
          .leak_limit = {4.75, 2.25},
          .period = 1ms};
}

TEST(LowLevelTorque, AsksForNoMoreThanWhatIsWantedAndRubsOffWhenTheTorqueIsThere) {
  BlockTester<LowLevelTorque> t(Options());
  t.Set(t->torque, {20, -8});
  t.Set(t->acceleration, {5, -2});
  t.Set(t->measured_velocity, {1, -1});
  t.Set(t->measured_torque, {20 - 0.4 * 5, -8 + 0.22 * 2});
  for (int k = 0; k < 1000; ++k) t.Tick();
  EXPECT_LT(t.Get(t->error).norm(), 1e-14);
  EXPECT_NEAR(11 * t.Get(t->current)(0), 20 + 3 + 2.4, 1e-12);
  EXPECT_NEAR(7.6 * t.Get(t->current)(1), -8 - 1.25 - 1.1, 1e-12);
}

TEST(LowLevelTorque, RaisesTheCurrentForWhatIsMissingByLagAndClampedLeak) {
  BlockTester<LowLevelTorque> t(Options());
  t.Set(t->torque, {10, 1});
  t.Set(t->acceleration, {0, 0});
  t.Set(t->measured_velocity, {0, 0});
  t.Set(t->measured_torque, {8, 0.9});
  t.AdvanceTo(60);
  // At rest: λ H(1) e + K_I e clamped, H(1) = Σb/Σa of the printed coefficients.
  const double H1 = (0.02017482 - 0.03697504 + 0.01691718) / (1 - 1.975063 + 0.9751799);
  EXPECT_NEAR(H1, 1, 1e-3);
  EXPECT_NEAR(11 * t.Get(t->current)(0), 10 + 5 * H1 * 2 + 4.75, 1e-9);
  EXPECT_NEAR(7.6 * t.Get(t->current)(1), 1 + 5 * H1 * 0.1 + 10 * 0.1, 1e-9);
}

TEST(LowLevelTorque, SwitchesItsPartsOff) {
  LowLevelTorque::Options o = Options();
  o.lag_gain = o.leak_gain = 0;
  for (PerJoint* figure : {&o.friction.coulomb, &o.friction.viscous, &o.friction.stiction})
    figure->setZero();
  BlockTester<LowLevelTorque> t(o);
  t.Set(t->torque, {22, -7.6});
  t.Set(t->acceleration, {9, 9});
  t.Set(t->measured_velocity, {1, 1});
  t.Set(t->measured_torque, {0, 0});
  t.AdvanceTo(1);
  EXPECT_EQ(t.Get(t->current), Eigen::Vector2d(2, -1));
}

TEST(LowLevelTorque, SwitchesItsFeedforwardsOff) {
  LowLevelTorque::Options o = Options();
  o.lag_gain = o.leak_gain = 0;
  const auto torque = [&] {
    BlockTester<LowLevelTorque> t(o);
    t.Set(t->torque, {20, -8});
    t.Set(t->acceleration, {5, -2});
    t.Set(t->measured_velocity, {1, -1});
    t.Set(t->measured_torque, {0, 0});
    return Eigen::Vector2d(t.Get(t->current).cwiseProduct(o.torque_per_ampere));
  };
  const Eigen::Vector2d all = torque(), friction(3 + 2.4, -1.25 - 1.1), rotors(0.4 * 5, -0.22 * 2);
  o.friction_feedforward = false;
  EXPECT_LT((all - torque() - friction).norm(), 1e-14);
  o.friction_feedforward = true;
  o.rotor_feedforward = false;
  EXPECT_LT((all - torque() - rotors).norm(), 1e-14);
}

TEST(LowLevelTorque, IntegratesNothingThatDrivesACutCurrentFurther) {
  LowLevelTorque::Options o = Options();
  o.lag_gain = 0;
  o.leak_limit = {100, 100};
  o.current_limit = {2, 2};
  BlockTester<LowLevelTorque> t(o);
  t.Set(t->acceleration, {0, 0});
  t.Set(t->measured_velocity, {0, 0});
  t.Set(t->torque, {40, 2});
  t.Set(t->measured_torque, {22, 1});
  t.AdvanceTo(5);
  EXPECT_EQ(t.Get(t->saturated), 1U);
  EXPECT_EQ(t.Get(t->current)(0), 2);
  EXPECT_GT(7.6 * t.Get(t->current)(1), 2 + 5);  // the other joint integrates its 1 N·m
  // Below its limit again the current is τ_d alone, but for what one tick of 18 N·m has left.
  t.Set(t->torque, {20, 2});
  t.Set(t->measured_torque, {20, 2});
  t.Tick();
  EXPECT_NEAR(11 * t.Get(t->current)(0), 20, 10 * 18 * 1e-3 / 2);
  EXPECT_EQ(t.Get(t->saturated), 0U);
}

TEST(LowLevelTorque, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<LowLevelTorque>(Options()));
  LowLevelTorque::Options limited = Options();
  limited.current_limit = {0.5, 0.5};
  ExpectBlockLaws(BlockTester<LowLevelTorque>(limited));
  ExpectBlockLaws(BlockTester<FrictionCompensation>(kFriction));
}

TEST(LowLevelTorque, RefusesGainsThatAreNone) {
  const auto error = [](auto change) {
    LowLevelTorque::Options o = Options();
    change(o);
    return ErrorOf([&] { LowLevelTorque loop(o); });
  };
  using O = LowLevelTorque::Options;
  EXPECT_EQ(error([](O& o) { o.torque_per_ampere(0) = 0; }),
            "motor: torque_per_ampere[first] must be > 0 N·m/A, got 0");
  EXPECT_EQ(error([](O& o) { o.reflected_inertia(1) = -1; }),
            "error: reflected_inertia[second] must be >= 0 kg·m², got -1");
  EXPECT_EQ(error([](O& o) { o.lag_gain = -1; }), "lag_gain must be >= 0, got -1");
  EXPECT_EQ(error([](O& o) { o.friction.coulomb(0) = -3; }),
            "friction: coulomb[first] must be >= 0 N·m, got -3");
  EXPECT_EQ(error([](O& o) { o.friction.velocity_threshold = 0; }),
            "friction: velocity_threshold must be > 0 rad/s, got 0");
  EXPECT_EQ(error([](O& o) { o.leak_gain = -10; }), "leak_gain must be >= 0, got -10");
  EXPECT_EQ(error([](O& o) { o.leak_limit(1) = NAN; }),
            "leak_limit[second] must be >= 0 N·m, got nan");
  EXPECT_EQ(error([](O& o) { o.period = 5ms; }),
            "period must be 1 ms where lag_gain is > 0: H is made for it, got 5 ms");
  EXPECT_EQ(error([](O& o) { o.leak_time_s = 0; }), "leak_time_s must be > 0 s, got 0");
}

}  // namespace
}  // namespace pliant
