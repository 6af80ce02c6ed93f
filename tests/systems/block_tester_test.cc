#include "pliant/systems/block_tester.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

/// v̇ = a, q̇ = v; `pace` follows `gain` alone.
class Cart final : public Block {
 public:
  struct Options {
    double q = 0;
  };

  explicit Cart(const Options& o)
      : a{this, "a"},
        gain{this, "gain"},
        q{this, "q"},
        pace{this, "pace"},
        q_{this, "q_", {}, o.q},
        v_{this, "v_"} {
    Derivative(q_).From(v_).As([](double v) { return v; });
    Derivative(v_).From(a).As([](double now) { return now; });
    Compute(q).From(q_).As([](double now) { return now; });
    Compute(pace).From(gain).As([](double k) { return 2 * k; });
  }

  Input<double> a, gain;
  Output<double> q, pace;
  Continuous<double> q_, v_;
};

/// Σ of a list.
class Total final : public Block {
 public:
  Total() : terms{this, "terms"}, y{this, "y"} {
    Compute(y).From(terms).As([](const Joined<double>& x) {
      double sum = 0;
      for (int i = 0; i < x.size(); ++i) sum += x[i];
      return sum;
    });
  }

  InputList<double> terms;
  Output<double> y;
};

/// A filter behind a gain, as a block with ports of its own.
class Smoothed final : public Composite {
 public:
  Smoothed() : u{this, "u"}, y{this, "y"} {
    auto& gain = Add<Gain<double>>("gain", {.gain = 3});
    auto& filter = Add<LowPass<double>>("filter", {.cutoff_hz = 5, .period = 1ms});
    Connect(u, gain.u);
    Connect(gain.y, filter.u);
    Connect(filter.y, y);
  }

  Input<double> u;
  Output<double> y;
};

const LowPass<JointVelocity>::Options kFilter{.space = kJoints, .cutoff_hz = 5, .period = 1ms};
const double kAlpha = 1 - std::exp(-2 * std::numbers::pi * 5 * 1e-3);

TEST(BlockTester, SetsInputsWithoutWires) {
  BlockTester<LowPass<JointVelocity>> t({.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  t.Set(t->u, {1.0, -2.0});
  t.Tick();
  EXPECT_DOUBLE_EQ(t.Get(t->y)(0), kAlpha);
  EXPECT_DOUBLE_EQ(t.Get(t->y)(1), -2 * kAlpha);
}

TEST(BlockTester, TicksStopAtTheirInstant) {
  BlockTester<LowPass<JointVelocity>> t(kFilter);
  t.Set(t->u, {1.0, 0.0});
  t.Tick();
  EXPECT_EQ(t.time(), 0.0);
  t.Tick();
  EXPECT_EQ(t.time(), 1e-3);
  EXPECT_NEAR(t.Get(t->y)(0), 1 - (1 - kAlpha) * (1 - kAlpha), 1e-15);  // round-off only
}

TEST(BlockTester, TicksAndAdvancesInOneRun) {
  BlockTester<LowPass<JointVelocity>> ticked(kFilter), advanced(kFilter);
  ticked.Set(ticked->u, {1.0, -2.0});
  advanced.Set(advanced->u, {1.0, -2.0});
  for (int k = 0; k < 10; ++k) ticked.Tick();
  advanced.AdvanceTo(0.01);  // ends before the tick at 10 ms
  EXPECT_EQ(ticked.Get(ticked->y), advanced.Get(advanced->y));
}

TEST(BlockTester, RefusesToTickABlockThatDoesNot) {
  BlockTester<Gain<double>> t({.gain = 2});
  EXPECT_EQ(ErrorOf([&] { t.Tick(); }), "nothing ticks: no rule of the diagram has Every(period)");
}

TEST(BlockTester, ReadsWhatFollowsFromInputsThatAreSet) {
  BlockTester<Cart> t({});
  t.Set(t->gain, 4);
  EXPECT_EQ(t.Get(t->pace), 8);
}

TEST(BlockTester, NamesAnInputThatWasNeverSetBehindRulesAndStates) {
  BlockTester<Cart> t({});
  t.Set(t->gain, 4);
  EXPECT_EQ(ErrorOf([&] { t.Get(t->q); }),
            "cannot read block.q, which depends on an input that was never set:\n"
            "  block.a : double\n"
            "Set it first");
}

TEST(BlockTester, NamesAnInputThatWasNeverSetBehindWires) {
  BlockTester<Smoothed> t;
  EXPECT_EQ(ErrorOf([&] { t.Get(t->y); }),
            "cannot read block.y, which depends on an input that was never set:\n"
            "  block.u : double\n"
            "Set it first");
}

TEST(BlockTester, TestsComposites) {
  BlockTester<Smoothed> t;
  t.Set(t->u, 1);
  t.Tick();
  EXPECT_DOUBLE_EQ(t.Get(t->y), 3 * kAlpha);
}

TEST(BlockTester, StartsTheRunWithWhatWasSetBefore) {
  BlockTester<Cart> t({.q = 1});
  t.Set(t->a, 2);
  t.Set(t->q_, 5);
  EXPECT_EQ(t.Get(t->q), 5);
  t.AdvanceTo(1);
  EXPECT_NEAR(t.Get(t->q), 5 + 0.5 * 2, 1e-12);  // quadratic: exact for a method of order 2
}

TEST(BlockTester, ChangesInputsWhileRunning) {
  BlockTester<Cart> t({});
  t.Set(t->gain, 4);
  t.AdvanceTo(0.5);
  t.Set(t->gain, 5);
  EXPECT_EQ(t.Get(t->pace), 10);
}

TEST(BlockTester, JoinsValuesToAList) {
  BlockTester<Total> t;
  const Input<double>& first = t.Join(t->terms, 1);
  t.Join(t->terms, 10);
  EXPECT_EQ(t.Get(t->y), 11);
  t.Set(first, 2);
  EXPECT_EQ(t.Get(t->y), 12);
}

TEST(BlockTester, RefusesAValueOfTheWrongSize) {
  BlockTester<Gain<JointTorque>> t({.space = kJoints});
  EXPECT_EQ(ErrorOf([&] {
              t.Set(t->u, {1, 2, 3});
            }),
            "the value of 'u' has a number for each of (shoulder, elbow), got 3");
}

TEST(BlockTester, HoldsTheLawsOfABlock) {
  ExpectBlockLaws(BlockTester<LowPass<JointVelocity>>(kFilter));
  ExpectBlockLaws(BlockTester<Cart>({}));
  ExpectBlockLaws(BlockTester<Smoothed>());
}

}  // namespace
}  // namespace pliant
