#include "pliant/plants/encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPeriod = 1e-3;
const Joints kTwo{"shoulder", "elbow"};

Encoder::Options Options(EncoderVelocity velocity = EncoderVelocity::Difference) {
  return {.joints = kTwo,
          .counts_per_turn = PerJoint{{4096, 100}},
          .velocity = velocity,
          .period = 1ms};
}

TEST(Encoder, IsWithinHalfACountOfThePosition) {
  Encoder::Options o = Options();
  o.offset = PerJoint{{0.1, -0.2}};
  BlockTester<Encoder> t(o);
  for (int k = 0; k < 500; ++k) {
    const JointPosition q{3 * std::sin(0.1 * k), 20 * std::cos(0.07 * k)};
    t.Set(t->position, q);
    t.Tick();
    for (int i = 0; i < 2; ++i) {
      const double quantum = 2 * kPi / o.counts_per_turn(i);
      EXPECT_LE(std::abs(t.Get(t->measured_position)(i) - q(i)), quantum / 2 + 1e-14);
      const double c = t.Get(t->counts)(i);
      EXPECT_EQ(c, std::round(c));
      EXPECT_NEAR(t.Get(t->measured_position)(i), o.offset(i) + quantum * c, 1e-14);
    }
  }
}

TEST(Encoder, ThatKnowsOneTurnCountsModuloIt) {
  Encoder::Options o = Options();
  o.one_turn = true;
  BlockTester<Encoder> t(o);
  const double v = 40;  // [rad/s]
  for (int k = 0; k < 1000; ++k) {
    t.Set(t->position, JointPosition(PerJoint::Constant(2, v * kPeriod * k - 5)));
    t.Tick();
    const PerJoint c = t.Get(t->counts);
    EXPECT_TRUE(c(0) >= 0 && c(0) < 4096 && c(1) >= 0 && c(1) < 100);
    const JointVelocity measured = t.Get(t->measured_velocity);
    for (int i = 0; k > 0 && i < 2; ++i)  // also across the end of a turn
      EXPECT_LE(std::abs(measured(i) - v), 2 * kPi / o.counts_per_turn(i) / kPeriod + 1e-9);
  }
}

TEST(Encoder, DifferencesCountsOfTwoTicks) {
  BlockTester<Encoder> t(Options());
  const double quantum = 2 * kPi / 100;
  t.Set(t->position, {0.0, 0.0});
  t.Tick();
  EXPECT_TRUE(t.Get(t->measured_velocity).isZero(0)) << "nothing to compare with";
  t.Set(t->position, {0.0, 3 * quantum});
  t.Tick();
  EXPECT_NEAR(t.Get(t->measured_velocity)(1), 3 * quantum / kPeriod, 1e-9);
  t.Tick();
  EXPECT_EQ(t.Get(t->measured_velocity)(1), 0);
}

/// Largest error of the elbow's velocity once it is known, as a part of it.
double ErrorAt(double v, EncoderVelocity how) {
  BlockTester<Encoder> t(Options(how));
  const double ticks_per_count = 2 * kPi / 100 / (v * kPeriod);
  double worst = 0;
  for (int k = 0; k < 20 * ticks_per_count + 10; ++k) {
    t.Set(t->position, {0.0, v * kPeriod * k});
    t.Tick();
    if (k > 3 * ticks_per_count)
      worst = std::max(worst, std::abs(t.Get(t->measured_velocity)(1) - v) / v);
  }
  return worst;
}

// A count takes T ticks: Period is off by one in T at most, Difference by a whole count in a tick.
TEST(Encoder, OfSlowMotionPeriodsTellMoreThanDifferences) {
  for (const double v : {0.3, 1.0, 3.0}) {
    const double T = 2 * kPi / 100 / (v * kPeriod);
    EXPECT_LE(ErrorAt(v, EncoderVelocity::Period), 1 / (T - 1) + 1e-9) << v;
    EXPECT_GE(ErrorAt(v, EncoderVelocity::Difference), 1 - 1e-9) << v;
  }
}

TEST(Encoder, OfAJointThatStopsFadesToZero) {
  BlockTester<Encoder> t(Options(EncoderVelocity::Period));
  const double quantum = 2 * kPi / 100, v = 1;
  double q = 0;
  for (int k = 0; k < 200; ++k, q += v * kPeriod) {
    t.Set(t->position, {0.0, q});
    t.Tick();
  }
  double last = t.Get(t->measured_velocity)(1);
  EXPECT_GT(last, 0.9);
  for (int k = 1; k <= 2000; ++k) {
    t.Tick();
    const double now = t.Get(t->measured_velocity)(1);
    EXPECT_LE(now, last);
    EXPECT_GE(now, 0);
    last = now;
  }
  EXPECT_LE(last, quantum / (2000 * kPeriod) + 1e-12) << "no more than a count in that time";
}

TEST(Encoder, KeepsTheLawsOfBlocks) {
  for (const EncoderVelocity how : {EncoderVelocity::Difference, EncoderVelocity::Period})
    for (const bool one_turn : {false, true}) {
      Encoder::Options o = Options(how);
      o.one_turn = one_turn;
      ExpectBlockLaws(BlockTester<Encoder>(o));
    }
}

TEST(Encoder, RefusesCountsThatAreNone) {
  Encoder::Options o = Options();
  o.counts_per_turn(1) = 99.5;
  EXPECT_EQ(ErrorOf([&] { BlockTester<Encoder>{o}; }),
            "block: counts_per_turn[elbow] must be whole, got 99.5");
  o.counts_per_turn(1) = 0;
  EXPECT_EQ(ErrorOf([&] { BlockTester<Encoder>{o}; }),
            "block: counts_per_turn[elbow] must be >= 1, got 0");
  o = Options();
  o.offset = PerJoint::Zero(3);
  EXPECT_EQ(ErrorOf([&] { BlockTester<Encoder>{o}; }),
            "block: offset has an element for each of the 2 joints, got 3");
}

}  // namespace
}  // namespace pliant
