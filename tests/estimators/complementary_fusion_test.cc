#include "pliant/estimators/complementary_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "pliant/estimators/momentum_observer.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Complex = std::complex<double>;

const Joints kJoints = Joints::Numbered(2);
const PerJoint kGain = PerJoint::LinSpaced(2, 10, 50);
constexpr double kPeriod = 1e-3;

ComplementaryFusion::Options Options() { return {.joints = kJoints, .gain = kGain, .period = 1ms}; }

/// Observer and fusion side by side: τ_e acts on a unit momentum, the sensor measures `sensed`.
template <class External, class Sensed>
PerJoint Fused(int ticks, External impulse, Sensed sensed) {
  BlockTester<MomentumObserver> observer({.joints = kJoints, .gain = kGain, .period = 1ms});
  BlockTester<ComplementaryFusion> fusion(Options());
  RobotDynamics d;
  d.p = JointMomentum::Zero(kJoints);
  d.v = JointVelocity::Zero(kJoints);
  d.coriolis_transposed = d.gravity = JointTorque::Zero(kJoints);
  for (int k = 0; k < ticks; ++k) {
    d.p = PerJoint::Constant(2, impulse(k * kPeriod));
    observer.Set(observer->dynamics, d);
    observer.Set(observer->torque, JointTorque::Zero(kJoints));
    observer.Tick();
    fusion.Set(fusion->residual, observer.Get(observer->residual));
    fusion.Set(fusion->sensor_torque, PerJoint::Constant(2, sensed(k * kPeriod)));
    fusion.Tick();
  }
  return fusion.Get(fusion->external_torque);
}

TEST(ComplementaryFusion, IsTheExternalTorqueWhereTheSensorIsExact) {
  for (const int ticks : {1, 2, 3, 10, 1000}) {
    const double t = (ticks - 1) * kPeriod;
    // a step that is there from the start, and a ramp
    const PerJoint step = Fused(
        ticks, [](double s) { return 7 * s; }, [](double) { return 7.0; });
    EXPECT_LT((step.array() - 7).abs().maxCoeff(), 1e-12) << ticks;
    const PerJoint ramp = Fused(
        ticks, [](double s) { return 3 * s + 20 * s * s; }, [](double s) { return 3 + 40 * s; });
    EXPECT_LT((ramp.array() - (3 + 40 * t)).abs().maxCoeff(), 1e-11) << ticks;  // ε 20 / 1 ms
  }
}

/// The steady amplitude and phase that fusion passes on, of a sine in the residual or the sensor.
Complex Gain(double omega, int joint, bool of_sensor) {
  BlockTester<ComplementaryFusion> t(Options());
  const int settle = 3000, measured = 4000;
  Complex sum = 0;
  double window = 0;
  for (int k = 0; k < settle + measured; ++k) {
    const double x = std::sin(omega * k * kPeriod);
    t.Set(t->residual, PerJoint::Constant(2, of_sensor ? 0 : x));
    t.Set(t->sensor_torque, PerJoint::Constant(2, of_sensor ? x : 0));
    t.Tick();
    if (k < settle) continue;
    // A Hann window leaves 10⁻⁶ of what is off the frequency.
    const double w = 0.5 * (1 - std::cos(2 * std::numbers::pi * (k - settle) / measured));
    sum += w * t.Get(t->external_torque)(joint) * std::exp(Complex(0, -omega * k * kPeriod));
    window += w;
  }
  return sum * Complex(0, 2) / window;
}

TEST(ComplementaryFusion, SplitsFrequenciesAtTheObserversGain) {
  for (const double hz : {0.5, 2.0, 10.0, 50.0})
    for (const int joint : {0, 1}) {
      const double omega = 2 * std::numbers::pi * hz;
      const Complex s(0, omega), high = s / (kGain(joint) + s);  // EC (26)
      // The filter takes the mean of a sample for its course: Kh ωh/12, and (ωh)²/12 of a sine.
      const double sampling = omega * kPeriod * (omega + kGain(joint)) * kPeriod / 12 + 2e-6;
      EXPECT_LT(std::abs(Gain(omega, joint, true) - high), sampling) << hz;
      EXPECT_LT(std::abs(Gain(omega, joint, false) - 1.0), 2e-6) << hz;
    }
}

// Bit for bit: what nobody takes for lost is added as it always was.
TEST(ComplementaryFusion, IsTheEquationWhileTheSensorIsValid) {
  BlockTester<ComplementaryFusion> t(Options());
  RandomStates random(Gen3(), 6);
  const PerJoint decay = (-kGain * kPeriod).array().exp();
  PerJoint low = PerJoint::Zero(2), last;
  for (int k = 0; k < 1000; ++k) {
    const JointTorque r = random.Uniform(10).head(2), tau_s = random.Uniform(10).head(2);
    if (k > 0)
      low = decay.cwiseProduct(low) +
            (1 - decay.array()).matrix().cwiseProduct(PerJoint(0.5 * (tau_s + last)));
    last = tau_s;
    t.Set(t->residual, r);
    t.Set(t->sensor_torque, tau_s);
    t.Tick();
    ASSERT_EQ(t.Get(t->external_torque), JointTorque(r + tau_s - low)) << k;
  }
}

// After any loss: what the sensor showed before and meanwhile, NaN included, is nowhere in the sum.
TEST(ComplementaryFusion, IsTheObserversWhileTheSensorIsNotValid) {
  RandomStates random(Gen3(), 5);
  for (const int lost : {1, 2, 10}) {
    BlockTester<ComplementaryFusion> t(Options());
    for (int k = 0; k < 40; ++k) {
      const bool valid = k < 20 || k >= 20 + lost;
      const JointTorque r = random.Uniform(10).head(2), tau_s = random.Uniform(10).head(2);
      t.Set(t->residual, r);
      t.Set(t->sensor_torque, valid ? tau_s : JointTorque(PerJoint::Constant(2, std::nan(""))));
      t.Set(t->sensor_valid, valid);
      t.Tick();
      if (!valid || k == 20 + lost) {
        ASSERT_EQ(t.Get(t->external_torque), r) << k << ": exactly, with no rounding";
      } else {
        ASSERT_TRUE(t.Get(t->external_torque).allFinite()) << k;
      }
    }
  }
}

// From the first valid tick on it is a high-pass that had seen its first value for ever: of a
// constant it passes nothing, and of what comes later what a fresh one passes of the difference.
TEST(ComplementaryFusion, BeginsAnewWithoutAJumpWhenTheSensorIsBack) {
  for (const bool from_the_start : {false, true}) {
    BlockTester<ComplementaryFusion> t(Options()), fresh(Options());
    t.Set(t->residual, JointTorque::Zero(kJoints));
    fresh.Set(fresh->residual, JointTorque::Zero(kJoints));
    t.Set(t->sensor_torque, PerJoint::Constant(2, 3));
    if (!from_the_start)
      for (int k = 0; k < 5; ++k) t.Tick();
    t.Set(t->sensor_valid, false);
    for (int k = 0; k < 5; ++k) t.Tick();
    t.Set(t->sensor_valid, true);
    for (int k = 0; k < 200; ++k) {
      const double more = k == 0 ? 0 : std::sin(0.1 * k);
      t.Set(t->sensor_torque, PerJoint::Constant(2, 7 + more));
      fresh.Set(fresh->sensor_torque, PerJoint::Constant(2, more));
      t.Tick();
      fresh.Tick();
      const PerJoint difference = t.Get(t->external_torque) - fresh.Get(fresh->external_torque);
      ASSERT_LT(difference.cwiseAbs().maxCoeff(), 200 * 8 * 2.3e-16) << k;  // ε of 8 N·m a tick
    }
  }
}

TEST(ComplementaryFusion, ObeysTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<ComplementaryFusion>(Options()));
}

TEST(ComplementaryFusion, RefusesGainsThatAreNone) {
  const auto error = [](const PerJoint& gain) {
    ComplementaryFusion::Options o = Options();
    o.gain = gain;
    return ErrorOf([&] { ComplementaryFusion fusion(o); });
  };
  EXPECT_EQ(error(PerJoint::Ones(3)), "gain has an element for each of the 2 joints, got 3");
  EXPECT_EQ(error(PerJoint::Constant(2, -1)), "gain[joint_1] must be > 0 1/s, got -1");
}

}  // namespace
}  // namespace pliant
