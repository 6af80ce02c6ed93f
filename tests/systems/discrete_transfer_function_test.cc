#include "pliant/systems/discrete_transfer_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

/// The vendor's torque filter of a Gen3: a lag with poles at 1 Hz and 3 Hz, zeros at 8 Hz and 20
/// Hz.
const DiscreteTransferFunction<double>::Options kVendor{
    .b = {0.02017482, -0.03697504, 0.01691718}, .a = {1, -1.975063, 0.9751799}, .period = 1ms};

/// The difference equation as it stands, with its whole past.
std::vector<double> Direct(const std::vector<double>& b, const std::vector<double>& a,
                           const std::vector<double>& u) {
  std::vector<double> y(u.size());
  for (std::size_t k = 0; k < u.size(); ++k) {
    for (std::size_t i = 0; i < b.size() && i <= k; ++i) y[k] += b[i] * u[k - i];
    for (std::size_t i = 1; i < a.size() && i <= k; ++i) y[k] -= a[i] * y[k - i];
    y[k] /= a[0];
  }
  return y;
}

void ExpectDirect(const DiscreteTransferFunction<double>::Options& o, double tolerance) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<double> u(200);
  std::ranges::generate(u, [&] { return number(random); });
  const std::vector<double> y = Direct(o.b, o.a, u);
  BlockTester<DiscreteTransferFunction<double>> t(o);
  for (std::size_t k = 0; k < u.size(); ++k) {
    t.Set(t->u, u[k]);
    t.Tick();
    EXPECT_NEAR(t.Get(t->y), y[k], tolerance) << "k = " << k;
  }
}

TEST(DiscreteTransferFunction, IsItsDifferenceEquation) {
  // round-off of sums of numbers of size 1; the second is near the unit circle and remembers it
  ExpectDirect({.b = {1, 0.5}, .a = {2, -0.3, 0.2, 0.1}, .period = 1ms}, 1e-14);
  ExpectDirect(kVendor, 1e-12);
}

TEST(DiscreteTransferFunction, WithoutPolesIsAConvolution) {
  ExpectDirect({.b = {1, -2, 3, -4, 5}, .period = 1ms}, 1e-14);
}

TEST(DiscreteTransferFunction, OfOrderZeroIsAGain) {
  ExpectDirect({.b = {3}, .a = {2}, .period = 1ms}, 1e-15);
}

TEST(DiscreteTransferFunction, FiltersEachJoint) {
  BlockTester<DiscreteTransferFunction<JointTorque, MotorCurrent>> t(
      {.space = kJoints, .b = {0.5}, .a = {1, -0.5}, .period = 1ms});
  t.Set(t->u, {1, -2});
  t.Tick();
  EXPECT_EQ(t.Get(t->y), (MotorCurrent{0.5, -1}));
  t.Tick();
  EXPECT_EQ(t.Get(t->y), (MotorCurrent{0.75, -1.5}));
}

TEST(DiscreteTransferFunction, HasTheStaticGainOfTheVendorsFilter) {
  BlockTester<DiscreteTransferFunction<double>> t(kVendor);
  t.Set(t->u, 1);
  t.AdvanceTo(10);  // 2π · 1 Hz · 10 s = 63 time constants of the slow pole
  const double gain = (0.02017482 - 0.03697504 + 0.01691718) / (1 - 1.975063 + 0.9751799);
  EXPECT_NEAR(t.Get(t->y), gain, 1e-9);  // differences of the coefficients lose 4 digits
  EXPECT_NEAR(gain, 1.0005, 1e-3);       // the coefficients have 7 digits
}

TEST(DiscreteTransferFunction, RefusesBadOptions) {
  using Block = DiscreteTransferFunction<double>;
  EXPECT_EQ(ErrorOf([] { BlockTester<Block>({.b = {}, .period = 1ms}); }),
            "block: b must have an element, b₀");
  EXPECT_EQ(ErrorOf([] { BlockTester<Block>({.b = {1}, .a = {}, .period = 1ms}); }),
            "block: a must have an element, a₀");
  EXPECT_EQ(ErrorOf([] {
              BlockTester<Block>({.b = {1}, .a = {0, 1}, .period = 1ms});
            }),
            "block: a₀ must not be 0, got 0");
}

TEST(DiscreteTransferFunction, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<DiscreteTransferFunction<double>>(kVendor));
  ExpectBlockLaws(BlockTester<DiscreteTransferFunction<JointTorque>>(
      {.space = kJoints, .b = {1, 0.5}, .a = {2, -0.3, 0.2, 0.1}, .period = 1ms}));
}

}  // namespace
}  // namespace pliant
