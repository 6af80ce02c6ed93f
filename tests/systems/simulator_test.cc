#include "pliant/systems/simulator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const Joints kJoints{"shoulder", "elbow"};

/// A ball on a spring: ẋ = v, v̇ = u − 9.81 − 50 min(x, 0); it writes down when it leaves the
/// ground.
class Hopper final : public Block {
 public:
  explicit Hopper(std::vector<double>& times)
      : u{this, "u"}, height{this, "height"}, x{this, "x", {}, 1.0}, v{this, "v"} {
    Derivative(x).From(v).As([](double now) { return now; });
    Derivative(v).From(x, u).As(
        [](double now, double push) { return push - 9.81 - 500 * std::min(now, 0.0); });
    Compute(height).From(x).As([](double now) { return now; });
    const auto leaves = When(height).Crosses(Direction::Rising);
    leaves.Publish().From(clock).As([&times](double t) { times.push_back(t); });
    leaves.Update(v).From(v).As([](double now) { return 0.95 * now; });
  }
  Input<double> u;
  Output<double> height;
  Continuous<double> x, v;
};

const std::vector<IntegratorOptions> kIntegrators{
    {.method = Method::kHeunEuler, .relative_tolerance = 1e-4},
    {.method = Method::kBogackiShampine},
    {.method = Method::kZonneveld},
    {.method = Method::kSayfyAburub},
    {.method = Method::kCashKarp},
    {.method = Method::kFehlberg},
    {.method = Method::kDormandPrince},
    {.method = Method::kSdirk},
    {.method = Method::kAdams},
    {.method = Method::kBdf},
    {.method = Method::kBogackiShampine, .fixed_step_s = 3e-3}};

TEST(Simulator, SplitIntoManyCallsIsTheSameRun) {
  const auto run = [](const IntegratorOptions& integrator, const std::vector<double>& stops) {
    std::vector<double> numbers;
    std::vector<Recorder::Row> rows;
    DiagramBuilder b;
    auto& hopper = b.Add<Hopper>("hopper", numbers);
    auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 3, .period = 20ms});
    auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = Hertz(70)});
    b.Connect(hopper.height, filter.u);
    b.Connect(filter.y, hopper.u);
    b.Connect(hopper.height, recorder.a);
    b.Connect(filter.y, recorder.b);
    const Diagram diagram = b.Build();
    Simulator sim{diagram, {.integrator = integrator}};
    for (const double t : stops) {
      sim.AdvanceTo(t);
      sim.Get(hopper.height);
    }
    EXPECT_FALSE(numbers.empty());
    for (const Recorder::Row& row : rows) numbers.insert(numbers.end(), {row.t, row.a, row.b});
    numbers.insert(numbers.end(), {sim.Get(hopper.x), sim.Get(hopper.v), sim.Get(filter.y)});
    return numbers;
  };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> step(0, 0.01);
  std::vector<double> many;
  for (double t = 0; t < 3; t += step(random)) many.push_back(t);
  many.push_back(3);
  std::vector<double> ticks;
  for (int k = 1; k <= 300; ++k) ticks.push_back(k / 100.0);
  for (const IntegratorOptions& integrator : kIntegrators) {
    const std::vector<double> whole = run(integrator, {3});
    EXPECT_EQ(run(integrator, many), whole) << Name(integrator.method);
    EXPECT_EQ(run(integrator, ticks), whole) << Name(integrator.method);
  }
}

TEST(Simulator, AdvancesToFiniteTimesAheadOnly) {
  DiagramBuilder b;
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  sim.AdvanceTo(1);
  EXPECT_EQ(ErrorOf([&] { sim.AdvanceTo(0.5); }),
            "AdvanceTo: t must not lie before the time reached, 1 s, got 0.5");
  for (const double t : {kNan, HUGE_VAL, -HUGE_VAL, 1e10})
    EXPECT_THAT(ErrorOf([&] { sim.AdvanceTo(t); }), HasSubstr("t must be finite and below 9e9 s"));
  EXPECT_EQ(sim.time(), 1);
}

TEST(Simulator, RefusesOptionsThatMeanNothing) {
  DiagramBuilder b;
  const Diagram diagram = b.Build();
  EXPECT_EQ(ErrorOf([&] { Simulator(diagram, {.guard_spacing_s = 0}); }),
            "guard_spacing_s must be > 0, got 0");
  EXPECT_EQ(ErrorOf([&] { Simulator(diagram, {.zeno_interval_s = -1}); }),
            "zeno_interval_s must be >= 0, got -1");
}

/// q̇ = v, with two joints and a rate from outside.
class Joint final : public Block {
 public:
  Joint() : v{this, "v", kJoints, JointVelocity::Zero(kJoints)}, q{this, "q", kJoints} {
    Derivative(q).From(v).As([](const JointVelocity& now) { return now; });
  }
  Input<JointVelocity> v;
  Continuous<JointPosition> q;
};

TEST(Simulator, NamesTheTimeAndTheStateOfADerivativeThatIsNotFinite) {
  DiagramBuilder b;
  auto& joint = b.Add<Joint>("joint");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);
  sim.Set(joint.v, {0.0, kNan});
  const std::string error = ErrorOf([&] { sim.AdvanceTo(1); });
  EXPECT_THAT(error, HasSubstr("cannot integrate past t = 0.5 s: a derivative is nan"));
  EXPECT_THAT(error, HasSubstr("state  joint.q[elbow]"));
  EXPECT_EQ(sim.time(), 0.5);
  sim.Set(joint.v, {1.0, 2.0});  // and it goes on
  sim.AdvanceTo(1);
  EXPECT_NEAR(sim.Get(joint.q)(1), 1.0, 1e-15);
}

/// ẋ = x², from 1: x = 1/(1 − t) ends at t = 1.
class Explosion final : public Block {
 public:
  Explosion() : x{this, "x", {}, 1.0} {
    Derivative(x).From(x).As([](double now) { return now * now; });
  }
  Continuous<double> x;
};

TEST(Simulator, NamesTheTimeAndTheStateWhereStepsGetTooSmall) {
  DiagramBuilder b;
  b.Add<Explosion>("explosion");
  const Diagram diagram = b.Build();
  Simulator small{diagram, {.integrator = {.min_step_s = 1e-4}}};
  const std::string error = ErrorOf([&] { small.AdvanceTo(2); });
  EXPECT_THAT(error, HasSubstr("the error is too large even with min_step_s = 0.0001 s"));
  EXPECT_THAT(error, HasSubstr("state  explosion.x"));
  EXPECT_NEAR(small.time(), 1, 0.05);

  Simulator many{diagram, {.integrator = {.max_steps_between_events = 10}}};
  EXPECT_THAT(ErrorOf([&] { many.AdvanceTo(2); }), HasSubstr("max_steps_between_events = 10"));
}

/// Throws when u < 0, in what a derivative reads or in an update.
class Thrower final : public Block {
 public:
  explicit Thrower(bool in_update)
      : u{this, "u", {}, 1.0}, checked{this, "checked"}, x{this, "x"}, n{this, "n"} {
    if (in_update) {
      Compute(checked).From(u).As([](double now) { return now; });
      Every(10ms).Update(n).From(u, n).As(
          [](double now, int before) { return Positive(now) > 0 ? before + 1 : before; });
    } else {
      Compute(checked).From(u, x).As([](double now, double) { return Positive(now); });
      Every(10ms).Update(n).From(n).As([](int before) { return before + 1; });
    }
    Derivative(x).From(checked).As([](double now) { return now; });
  }
  static double Positive(double u) {
    if (u < 0) throw std::domain_error("u is negative");
    return u;
  }
  Input<double> u;
  Output<double> checked;
  Continuous<double> x;
  Discrete<int> n;
};

TEST(Simulator, LetsExceptionsOfRulesThroughAndRecovers) {
  for (const bool in_update : {false, true}) {
    DiagramBuilder b;
    auto& thrower = b.Add<Thrower>("thrower", in_update);
    const Diagram diagram = b.Build();
    Simulator sim{diagram}, undisturbed{diagram};
    sim.AdvanceTo(0.123);
    const Context before = sim.Snapshot();
    undisturbed.Restore(before);
    sim.Set(thrower.u, -1);
    EXPECT_THROW(sim.AdvanceTo(1), std::domain_error);
    EXPECT_EQ(sim.time(), in_update ? 0.13 : 0.123);
    EXPECT_THROW(sim.AdvanceTo(1), std::domain_error);
    sim.Restore(before);
    sim.AdvanceTo(1);
    undisturbed.AdvanceTo(1);
    EXPECT_TRUE(sim.Snapshot() == undisturbed.Snapshot());
    EXPECT_EQ(sim.Get(thrower.n), 100);
  }
}

TEST(Simulator, DoesNotOutliveATemporaryDiagram) {
  EXPECT_FALSE((std::is_constructible_v<Simulator, Diagram>));
  EXPECT_FALSE((std::is_constructible_v<Simulator, Diagram, Simulator::Options>));
  EXPECT_TRUE((std::is_constructible_v<Simulator, const Diagram&>));
}

TEST(Simulator, RunsADiagramThatHasMoved) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& integral = b.Add<Integral>("integral");
  b.Connect(one.y, integral.u);
  Diagram first = b.Build();
  const Diagram second = std::move(first);
  Simulator sim{second};
  sim.AdvanceTo(2);
  EXPECT_NEAR(sim.Get(integral.y), 2, 1e-14);
}

TEST(Simulator, PassesNanOnAsAnyOtherNumber) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 3, .period = 1ms});
  b.Connect(one.y, filter.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.Set(one.value, kNan);
  sim.AdvanceTo(0.01);
  EXPECT_TRUE(std::isnan(sim.Get(filter.y)));
  sim.Set(one.value, 1);
  sim.Set(filter.y, 0);  // a held output is state
  sim.AdvanceTo(0.02);
  EXPECT_GT(sim.Get(filter.y), 0);
}

/// A rate of another size than its state.
class Misfit final : public Block {
 public:
  Misfit() : u{this, "u", {}, 2.0}, q{this, "q", kJoints} {
    Derivative(q).From(u).As([](double n) {
      JointVelocity v;
      v.setZero(static_cast<int>(n));
      return v;
    });
  }
  Input<double> u;
  Continuous<JointPosition> q;
};

TEST(Simulator, RefusesRatesOfAnotherSize) {
  DiagramBuilder b;
  auto& misfit = b.Add<Misfit>("misfit");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.1);
  sim.Set(misfit.u, 3);
  EXPECT_EQ(ErrorOf([&] { sim.AdvanceTo(1); }),
            "the rate of misfit.q : joint position [rad] (shoulder, elbow) has 2 numbers, but its "
            "rule gave 3");
}

}  // namespace
}  // namespace pliant
