#include "pliant/systems/low_pass2.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

using Complex = std::complex<double>;

/// The filter's frequency response: the transform of its impulse response, which has died out.
Complex Response(const LowPass2<double>::Options& o, double frequency_hz) {
  BlockTester<LowPass2<double>> t(o);
  Complex sum = 0;
  for (int k = 0; k < 5000; ++k) {
    t.Set(t->u, k == 0 ? 1 : 0);
    t.Tick();
    sum +=
        t.Get(t->y) * std::polar(1.0, -2 * std::numbers::pi * frequency_hz * k * seconds(o.period));
  }
  return sum;
}

TEST(LowPass2, HasTheResponseOfThePrewarpedFilter) {
  const double f = 20, zeta = 0.4, h = 1e-3;
  const double omega = 2 * std::numbers::pi * f, c = omega / std::tan(omega * h / 2);
  for (const double frequency : {0.0, 3.0, 20.0, 50.0, 300.0}) {
    const Complex s(0, c * std::tan(std::numbers::pi * frequency * h));
    const Complex expected = omega * omega / (s * s + 2 * zeta * omega * s + omega * omega);
    const Complex found = Response({.cutoff_hz = f, .damping = zeta, .period = 1ms}, frequency);
    EXPECT_NEAR(std::abs(found - expected), 0, 1e-10) << frequency << " Hz";  // 5000 terms
  }
}

TEST(LowPass2, IsExactAtItsCutoff) {
  for (const double zeta : {0.3, std::numbers::sqrt2 / 2, 1.5}) {
    const Complex found = Response({.cutoff_hz = 100, .damping = zeta, .period = 1ms}, 100);
    EXPECT_NEAR(std::abs(found - Complex(0, -1 / (2 * zeta))), 0, 1e-10);  // 5000 terms
  }
}

TEST(LowPass2, ReachesAConstantWithoutOffset) {
  BlockTester<LowPass2<JointVelocity>> t({.space = kJoints, .cutoff_hz = 20, .period = 1ms});
  t.Set(t->u, {1, -2});
  t.AdvanceTo(2);  // 2π · 20 · 0.7 · 2 = 176 time constants
  EXPECT_NEAR(t.Get(t->y)(0), 1, 1e-12);
  EXPECT_NEAR(t.Get(t->y)(1), -2, 1e-12);
}

TEST(LowPass2, RefusesBadOptions) {
  EXPECT_EQ(ErrorOf([] { BlockTester<LowPass2<double>>({.cutoff_hz = -3, .period = 1ms}); }),
            "block: cutoff_hz must be > 0, got -3");
  EXPECT_EQ(ErrorOf([] { BlockTester<LowPass2<double>>({.cutoff_hz = 500, .period = 1ms}); }),
            "block: cutoff_hz · period must be < 1/2, got 0.5");
  EXPECT_EQ(
      ErrorOf([] { BlockTester<LowPass2<double>>({.cutoff_hz = 3, .damping = 0, .period = 1ms}); }),
      "block: damping must be > 0, got 0");
}

TEST(LowPass2, HoldsTheLaws) {
  ExpectBlockLaws(
      BlockTester<LowPass2<JointVelocity>>({.space = kJoints, .cutoff_hz = 20, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
