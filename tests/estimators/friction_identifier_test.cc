#include "pliant/estimators/friction_identifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using namespace std::chrono_literals;

const Joints kArm{"shoulder", "elbow"};

FrictionIdentifier::Options Options() {
  return {.joints = kArm,
          .period = 1ms,
          .reflected_inertia = PerJoint{{0.4, 0.2}},
          .fit = {.offset = true, .least_velocity = 0.01, .folds = 0},
          .capacity = 512};
}

/// Exact samples of c = 3 and 1, d = 2 and 0.5, b = 0.25 and 0, at velocities that come and go.
void Sweep(BlockTester<FrictionIdentifier>& t, int ticks) {
  for (int k = 0; k < ticks; ++k) {
    const double v = std::sin(0.0071 * k), a = 0.3 * std::cos(0.0071 * k);
    const double sign = v < 0 ? -1 : 1;
    t.Set(t->velocity, {v, -v});
    t.Set(t->acceleration, {a, -a});
    t.Set(t->torque, {1.0, -2.0});
    t.Set(t->motor_torque, {1 + 0.25 + 3 * sign + 2 * v + 0.4 * a, -2 - sign - 0.5 * v - 0.2 * a});
    t.Tick();
  }
}

TEST(FrictionIdentifier, FindsTheFrictionOfAllJointsWhenItIsTriggered) {
  BlockTester<FrictionIdentifier> t(Options());
  t.Set(t->trigger, false);
  Sweep(t, 3000);
  EXPECT_EQ(t.Get(t->friction).status, PerJoint::Zero(2));
  EXPECT_EQ(t.Get(t->friction).coulomb, PerJoint::Zero(2));
  t.Set(t->trigger, true);
  Sweep(t, 1);
  const IdentifiedJoints found = t.Get(t->friction);
  for (int j = 0; j < 2; ++j)
    EXPECT_EQ(found.status(j), static_cast<double>(FrictionStatus::Identified));
  // Thinned samples bend by 0.003 from one to the next, which passes for noise where a sine turns.
  EXPECT_NEAR(found.coulomb(0), 3, 0.02);
  EXPECT_NEAR(found.coulomb(1), 1, 0.02);
  EXPECT_NEAR(found.viscous(0), 2, 0.02);
  EXPECT_NEAR(found.viscous(1), 0.5, 0.02);
  EXPECT_NEAR(found.offset(0), 0.25, 0.02);
  EXPECT_NEAR(found.offset(1), 0, 0.02);
  EXPECT_LT(found.residual(0), 0.02);
  // More Coulomb friction is less viscous friction at the speeds that were seen.
  EXPECT_LT(found.coulomb_viscous(0), 0);
  EXPECT_LT(std::abs(found.coulomb_viscous(0)), found.coulomb_error(0) * found.viscous_error(0));
}

TEST(FrictionIdentifier, SolvesOnceForEachTimeTheTriggerRises) {
  BlockTester<FrictionIdentifier> t(Options());
  t.Set(t->trigger, true);
  Sweep(t, 1);
  EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::TooFewSamples));
  Sweep(t, 2000);
  EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::TooFewSamples));
  t.Set(t->trigger, false);
  Sweep(t, 1);
  t.Set(t->trigger, true);
  Sweep(t, 1);
  EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::Identified));
}

TEST(FrictionIdentifier, GathersNothingWhileTheGateIsClosed) {
  BlockTester<FrictionIdentifier> t(Options());
  t.Set(t->trigger, false);
  t.Set(t->gate, false);
  Sweep(t, 2000);
  t.Set(t->trigger, true);
  Sweep(t, 1);
  EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::TooFewSamples));
}

TEST(FrictionIdentifier, SaysThatOneSpeedDoesNotTell) {
  BlockTester<FrictionIdentifier> t(Options());
  t.Set(t->trigger, false);
  t.Set(t->torque, {0.0, 0.0});
  t.Set(t->velocity, {0.5, 0.5});
  t.Set(t->motor_torque, {4.0, 4.0});
  for (int k = 0; k < 200; ++k) t.Tick();
  t.Set(t->trigger, true);
  t.Tick();
  EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::PartlyIdentified));
  EXPECT_EQ(t.Get(t->friction).coulomb(0), 0);
}

TEST(FrictionIdentifier, SaysThatNoiseAtRestDoesNotSlide) {
  FrictionIdentifier::Options o = Options();
  for (const double least : {0.0, 0.01}) {
    o.fit.least_velocity = least;
    BlockTester<FrictionIdentifier> t(o);
    t.Set(t->trigger, false);
    t.Set(t->torque, {0.0, 0.0});
    t.Set(t->motor_torque, {0.0, 0.0});
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int k = 0; k < 500; ++k) {
      t.Set(t->velocity, {0.01 * normal(random), 0.01 * normal(random)});
      t.Tick();
    }
    t.Set(t->trigger, true);
    t.Tick();
    EXPECT_EQ(t.Get(t->friction).status(0), static_cast<double>(FrictionStatus::TooFewSamples));
    EXPECT_EQ(t.Get(t->friction).coulomb(0), 0);
  }
}

TEST(FrictionIdentifier, ObeysTheLawsOfBlocks) {
  BlockTester<FrictionIdentifier> t(Options());
  ExpectBlockLaws(std::move(t), {.steps = 2000});
}

TEST(FrictionIdentifier, IsTheSameAfterARestoredRun) {
  BlockTester<FrictionIdentifier> t(Options());
  t.Set(t->trigger, false);
  Sweep(t, 1500);
  const Context before = t.simulator().Snapshot();
  Sweep(t, 700);
  t.Set(t->trigger, true);
  Sweep(t, 1);
  const PerJoint first = t.Get(t->friction).coulomb;
  t.simulator().Restore(before);
  Sweep(t, 700);
  t.Set(t->trigger, true);
  Sweep(t, 1);
  EXPECT_EQ(t.Get(t->friction).coulomb, first);
}

TEST(FrictionIdentifier, RefusesNoRoomForSamples) {
  FrictionIdentifier::Options o = Options();
  o.capacity = 10;
  EXPECT_EQ(ErrorOf([&] { FrictionIdentifier identifier(o); }),
            "capacity must be from 64 to 65536, got 10");
  o = Options();
  o.reflected_inertia = PerJoint{{-1.0, 0.0}};
  EXPECT_EQ(ErrorOf([&] { FrictionIdentifier identifier(o); }),
            "reflected_inertia[shoulder] must be >= 0 kg·m², got -1");
  o = Options();
  o.fit.folds = 1;
  EXPECT_EQ(ErrorOf([&] { FrictionIdentifier identifier(o); }),
            "folds must be 0 or from 2 to 100, got 1");
  o.fit = {.least_velocity = -0.1};
  EXPECT_EQ(ErrorOf([&] { FrictionIdentifier identifier(o); }),
            "least_velocity must be ≥ 0, got -0.1");
}

}  // namespace
}  // namespace pliant
