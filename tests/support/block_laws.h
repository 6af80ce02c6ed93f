#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {

struct LawOptions {
  double amplitude = 10;  ///< of the random inputs
  double step_s = 1e-3;   ///< between changes of the inputs
  int steps = 200;
};

namespace internal {

/// Every number a block shows or remembers.
inline std::vector<const Value*> Shown(const Block& block) {
  std::vector<const Value*> shown;
  for (const auto& value : Access::Values(block))
    if ((value.kind == Kind::Output || value.kind == Kind::Discrete ||
         value.kind == Kind::Continuous) &&
        value.type->write)
      shown.push_back(value.value);
  return shown;
}

/// Runs on with random inputs, the same for the same seed, and writes down all that is shown.
struct LawRun {
  template <class T>
  LawRun(BlockTester<T>& t, const LawOptions& o) {
    Simulator& sim = t.simulator();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-o.amplitude, o.amplitude);
    const std::vector<const Value*> shown = Shown(*t);
    std::vector<double> in, out;
    const double start = sim.time();
    for (int i = 1; i <= o.steps; ++i) {
      for (const Value* input : t.inputs()) {
        in.resize(Access::TypeOf(*input).count(Access::Of(*input).initial.get()));
        std::ranges::generate(in, [&] { return number(random); });
        sim.SetNumbers(*input, in);
      }
      const long before = Allocations();
      sim.AdvanceTo(start + i * o.step_s);
      allocations += Allocations() - before;
      for (const Value* value : shown) {
        out.resize(Access::TypeOf(*value).count(Access::Of(*value).initial.get()));
        const long before_reading = Allocations();
        sim.GetNumbers(*value, out);
        allocations += Allocations() - before_reading;
        numbers.insert(numbers.end(), out.begin(), out.end());
      }
    }
  }

  std::vector<double> numbers;
  long allocations = 0;
};

}  // namespace internal

/// What holds for every block: finite in gives finite out, no heap while running, and run, restore,
/// run again is equal bit for bit. The tester's required and joined inputs are driven at random.
template <class T>
void ExpectBlockLaws(BlockTester<T>&& t, const LawOptions& o = {}) {
  Simulator& sim = t.simulator();
  internal::LawRun(t, o);
  const Context snapshot = sim.Snapshot();
  const internal::LawRun first(t, o);
  const Context end = sim.Snapshot();
  sim.Restore(snapshot);
  const internal::LawRun second(t, o);

  EXPECT_TRUE(std::ranges::all_of(first.numbers, [](double x) { return std::isfinite(x); }))
      << "finite in gives finite out";
  EXPECT_EQ(first.allocations, 0) << "no heap while running";
  EXPECT_EQ(second.numbers, first.numbers) << "run, restore, run again";
  EXPECT_TRUE(sim.Snapshot() == end) << "run, restore, run again";
}

}  // namespace pliant
