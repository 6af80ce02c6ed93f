#include <gtest/gtest.h>

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

const Joints kJoints{"shoulder", "elbow"};

/// Every kind of value, every kind of rule, and a count of what each has seen.
class Everything final : public Block {
 public:
  Everything()
      : required{this, "required"},
        defaulted{this, "defaulted", {}, 3.0},
        list{this, "list"},
        product{this, "product"},
        total{this, "total"},
        held{this, "held", {}, -1.0},
        level{this, "level"},
        published{this, "published"},
        started{this, "started"},
        memory{this, "memory", {}, 5.0},
        mode{this, "mode"},
        x{this, "x"},
        scratch{this, "scratch", std::vector<double>(3)} {
    Compute(product).From(required, defaulted).As([](double a, double b) { return a * b; });
    Compute(total).From(list, scratch).As(&Everything::Total);
    Every(10ms, 5ms).Compute(held).From(held, product, clock).As(&Everything::Next);
    Compute(level).From(x).As([](double now) { return now - 0.5; });
    Derivative(x).From(memory).As([](double rate) { return rate; });
    Every(100ms).Update(memory).From(memory, held).As([](double m, double) { return m; });
    When(level).Crosses(Direction::Rising).Update(mode, x).From(x).As([](double now) {
      return std::tuple(7, now - 0.5);
    });
    AtStart().Update(started).From(product).As([](double p) { return p; });
    Every(50ms).Publish().From(published).As([](int& n) { ++n; });
  }

  Input<double> required, defaulted;
  InputList<double> list;
  Output<double> product, total, held, level;
  Scratch<int> published;
  Discrete<double> started, memory;
  Discrete<int> mode;
  Continuous<double> x;
  Scratch<std::vector<double>> scratch;

 private:
  double Total(const Joined<double>& all, std::vector<double>& seen) const {
    seen.assign(seen.size(), 0);
    for (int i = 0; i < all.size(); ++i) seen[static_cast<std::size_t>(i)] = all[i];
    return 100 * seen[0] + 10 * seen[1] + seen[2];
  }
  double Next(const double& y, const double& p, double t) const { return y + p + 1000 * t; }
};

TEST(Rules, OfEveryKindActOnValuesOfEveryKind) {
  DiagramBuilder b;
  auto& two = b.Add<Constant<double>>("two", {.value = 2});
  auto& three = b.Add<Constant<double>>("three", {.value = 3});
  auto& all = b.Add<Everything>("all");
  b.Connect(two.y, all.required);
  b.Connect(three.y, all.list);
  b.Connect(two.y, all.list);
  b.Connect(three.y, all.list);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};

  EXPECT_EQ(sim.Get(all.started), 6);  // before the first tick
  EXPECT_EQ(sim.Get(all.held), -1);    // until its first
  EXPECT_EQ(sim.Get(all.total), 323);  // in the order of the wires
  sim.AdvanceTo(0.005);
  EXPECT_EQ(sim.Get(all.held), -1);
  sim.AdvanceTo(0.006);
  EXPECT_EQ(sim.Get(all.held), -1 + 6 + 5);
  EXPECT_NEAR(sim.Get(all.x), 5 * 0.006, 1e-15);
  sim.Set(all.defaulted, 4);
  sim.Set(two.value, 1);
  EXPECT_EQ(sim.Get(all.product), 4);
  EXPECT_EQ(sim.Get(all.total), 313);
  sim.AdvanceTo(0.016);
  EXPECT_EQ(sim.Get(all.held), 10 + 4 + 15);
  EXPECT_EQ(sim.Get(all.mode), 0);
  sim.AdvanceTo(0.12);  // x has passed 0.5 at 0.1 s and was set back
  EXPECT_EQ(sim.Get(all.mode), 7);
  EXPECT_NEAR(sim.Get(all.x), 5 * 0.02, 1e-14);
  EXPECT_EQ(sim.Get(all.published), 3);
  EXPECT_EQ(sim.Get(all.started), 6);
}

TEST(Rules, RunOnlyWhenWhatTheyReadHasChanged) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<JointVelocity>>("one", {.space = kJoints, .value = {1.0, 2.0}});
  auto& first = b.Add<Gain<JointVelocity>>("first", {.space = kJoints, .gain = 2});
  auto& second = b.Add<Gain<JointVelocity>>("second", {.space = kJoints, .gain = 3});
  b.Connect(one.y, first.u);
  b.Connect(first.y, second.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(second.y)(1), 12);
  EXPECT_EQ(sim.context().rules_run(), 3u);
  sim.AdvanceTo(1);
  EXPECT_EQ(sim.Get(second.y)(1), 12);
  EXPECT_EQ(sim.context().rules_run(), 3u);  // time alone changes nothing here
  sim.Set(one.value, {1.0, 3.0});
  EXPECT_EQ(sim.Get(first.y)(1), 6);
  EXPECT_EQ(sim.context().rules_run(), 5u);  // and `second` was not asked for
}

enum class Mode { kIdle, kRunning };

struct Plain {
  int n = 0;
  std::string text;
};

struct Described {
  double x = 0;
  Mode mode = Mode::kIdle;
  std::array<Eigen::Vector3d, 2> points{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  template <class Visitor>
  void Fields(Visitor&& f) {
    f("x", x, "m");
    f("mode", mode, "");
    f("points", points, "m");
  }
};

struct alignas(256) Aligned {
  double x = 0;
};

template <class S>
S Passed(const S& value) {
  DiagramBuilder b;
  auto& constant = b.Add<Constant<S>>("constant", {.value = S{}});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.Set(constant.value, value);
  const Context copy = sim.Snapshot();
  sim.Set(constant.value, S{});
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(&sim.Get(constant.y)) % alignof(S), 0u);
  sim.Restore(copy);
  return sim.Get(constant.y);
}

TEST(Rules, PassAnyCopyableType) {
  EXPECT_EQ(Passed<std::string>(std::string(100, 'x')), std::string(100, 'x'));
  EXPECT_EQ(Passed<std::vector<int>>({1, 2, 3}), (std::vector{1, 2, 3}));
  EXPECT_EQ(Passed(Mode::kRunning), Mode::kRunning);
  EXPECT_EQ(Passed(Plain{3, "three"}).text, "three");
  EXPECT_EQ(Passed(Described{.x = 4}).x, 4);
  EXPECT_EQ(Passed(true), true);
  EXPECT_EQ(Passed(Aligned{2}).x, 2);
  EXPECT_EQ(Passed(Pose{}).rotation, Eigen::Matrix3d::Identity());
}

/// Writes its results in place, and all at once.
class InPlace final : public Block {
 public:
  InPlace() : u{this, "u", kJoints}, y{this, "y", kJoints}, a{this, "a"}, b{this, "b"} {
    Compute(y).From(u).As(&InPlace::Write);
    Every(1ms).Update(a, b).From(a, b).As(
        [](double& next_a, double& next_b, double now_a, double now_b) {
          next_a = now_b;
          next_b = now_a + 1;
        });
  }
  Input<JointVelocity> u;
  Output<JointVelocity> y;
  Discrete<double> a, b;

 private:
  void Write(JointVelocity& out, const JointVelocity& in) const noexcept { out = 2 * in; }
};

TEST(Rules, MayWriteInPlace) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<JointVelocity>>("one", {.space = kJoints, .value = {1.0, 2.0}});
  auto& block = b.Add<InPlace>("block");
  b.Connect(one.y, block.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0025);  // (0, 0), (0, 1), (1, 1), (1, 2)
  EXPECT_EQ(sim.Get(block.y)(1), 4);
  EXPECT_EQ(sim.Get(block.a), 1);
  EXPECT_EQ(sim.Get(block.b), 2);
}

/// Sums up all numbers of any values.
class Tally final : public Block {
 public:
  Tally() : in{this, "in"}, y{this, "y"} {
    Compute(y).From(in).As([](const AnyValues& values) {
      double sum = 0;
      for (int i = 0; i < values.size(); ++i) {
        std::vector<double> numbers;
        values.type(i).numbers(values[i], numbers);
        for (const double x : numbers) sum = 10 * sum + x;
      }
      return sum;
    });
  }
  AnyInputs in;
  Output<double> y;
};

TEST(Rules, ReadListsOfAnyTypesInTheOrderOfTheirWires) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<JointVelocity>>("one", {.space = kJoints, .value = {1.0, 2.0}});
  auto& three = b.Add<Constant<int>>("three", {.value = 3});
  auto& state = b.Add<Integral>("state", 4.0);
  auto& zero = b.Add<Constant<double>>("zero", {.value = 0});
  auto& tally = b.Add<Tally>("tally");
  b.Connect(zero.y, state.u);
  b.Connect(three.y, tally.in);
  b.Connect(state.x, tally.in);
  b.Connect(one.y, tally.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(tally.y), 3412);
}

/// A continuous value that is also sampled anew, twice a second.
class Sawtooth final : public Block {
 public:
  Sawtooth() : x{this, "x"} {
    Derivative(x).From().As([] { return 2.0; });
    Every(500ms, 500ms).Update(x).From(x).As([](double now) { return now - 1; });
  }
  Continuous<double> x;
};

TEST(Rules, OfTicksMayUpdateContinuousValues) {
  DiagramBuilder b;
  auto& saw = b.Add<Sawtooth>("saw");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  for (int k = 0; k < 20; ++k) {
    sim.AdvanceTo(0.25 + 0.5 * k);
    EXPECT_NEAR(sim.Get(saw.x), 0.5, 1e-13);
  }
}

/// Counts the steps of the integrator.
class StepCounter final : public Block {
 public:
  StepCounter() : steps{this, "steps"}, starts{this, "starts"} {
    AtEveryStep().Publish().From(steps).As([](int& n) { ++n; });
    AtStart().Publish().From(starts).As([](int& n) { ++n; });
  }
  Scratch<int> steps, starts;
};

TEST(Rules, AtEveryStepPublishOncePerStep) {
  for (const int calls : {1, 7, 1000}) {
    DiagramBuilder b;
    b.Add<Sawtooth>("saw");
    auto& counter = b.Add<StepCounter>("counter");
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    for (int i = 1; i <= calls; ++i) sim.AdvanceTo(static_cast<double>(i) / calls);
    EXPECT_EQ(sim.Get(counter.steps), sim.statistics().steps);
    EXPECT_EQ(sim.Get(counter.starts), 1);
  }
}

}  // namespace
}  // namespace pliant
