#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

constexpr double kGravity = 9.81;

/// ḧ = −g; at h = 0 the velocity turns round: ḣ⁺ = −e ḣ⁻.
class Ball final : public Block {
 public:
  struct Options {
    double restitution;
    std::vector<double>& bounces;
    double height = 1;
  };
  explicit Ball(const Options& o)
      : height{this, "height"},
        h{this, "h", {}, o.height},
        v{this, "v"},
        count{this, "count"},
        restitution_{o.restitution} {
    Compute(height).From(h).As([](double now) { return now; });
    Derivative(h).From(v).As([](double now) { return now; });
    Derivative(v).From().As([] { return -kGravity; });
    const auto impact = When(height).Crosses(Direction::Falling);
    impact.Update(v).From(v).As(&Ball::Bounce);
    impact.Update(count).From(count).As([](int n) { return n + 1; });
    impact.Publish().From(clock).As([&times = o.bounces](double t) { times.push_back(t); });
  }
  Output<double> height;
  Continuous<double> h, v;
  Discrete<int> count;

 private:
  double Bounce(const double& now) const { return -restitution_ * now; }
  const double restitution_;
};

/// Writes down when u passes zero.
class Watch final : public Block {
 public:
  struct Options {
    Direction direction;
    std::vector<double>& times;
  };
  explicit Watch(const Options& o) : u{this, "u"}, guard{this, "guard"} {
    Compute(guard).From(u).As([](double now) { return now; });
    When(guard).Crosses(o.direction).Publish().From(clock).As([&times = o.times](double t) {
      times.push_back(t);
    });
  }
  Input<double> u;
  Output<double> guard;
};

std::vector<double> Crossings(double (*f)(double), Direction direction, double end) {
  std::vector<double> times;
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", f);
  auto& watch = b.Add<Watch>("watch", {.direction = direction, .times = times});
  b.Connect(source.y, watch.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(end);
  return times;
}

void ExpectNear(const std::vector<double>& found, const std::vector<double>& expected,
                double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], tolerance);
}

TEST(Guards, LocateFourBouncesToANanosecond) {
  std::vector<double> bounces;
  DiagramBuilder b;
  auto& ball = b.Add<Ball>("ball", {.restitution = 0.9, .bounces = bounces});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(3);
  const double fall = std::sqrt(2 / kGravity);
  std::vector<double> expected{fall};
  for (int i = 1; i < 4; ++i) expected.push_back(expected.back() + 2 * fall * std::pow(0.9, i));
  ExpectNear(bounces, expected, 1e-9);
  EXPECT_EQ(sim.Get(ball.count), 4);
}

TEST(Guards, NeverLetABallThrough) {
  for (const double restitution : {0.9, 0.7, 0.5, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) {
    std::vector<double> bounces;
    DiagramBuilder b;
    auto& ball = b.Add<Ball>("ball", {.restitution = restitution, .bounces = bounces});
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    double lowest = 0;
    const std::string error = ErrorOf([&] {
      for (double t = 0.01; t < 30; t += 0.01) {
        sim.AdvanceTo(t);
        lowest = std::min(lowest, sim.Get(ball.height));
      }
    });
    EXPECT_THAT(error, HasSubstr("Zeno behaviour: the guard ball.height fires")) << restitution;
    EXPECT_THAT(error, HasSubstr("let its update end the motion")) << restitution;
    EXPECT_GT(lowest, -1e-9) << restitution;  // the last of a double at 30 s, times the speed
    EXPECT_NEAR(sim.time(), std::sqrt(2 / kGravity) * (1 + restitution) / (1 - restitution), 1e-3)
        << restitution;  // where the bounces heap up; they end at intervals of 0.1 ms
    EXPECT_THAT(ErrorOf([&] { sim.AdvanceTo(31); }), HasSubstr("Zeno")) << restitution;
  }
}

TEST(Guards, FireInTheirDirectionOnly) {
  constexpr auto wave = [](double t) { return std::sin(10 * t); };
  const double half = std::numbers::pi / 10;
  // To the last places of the time and of sin(10 t) near π.
  ExpectNear(Crossings(wave, Direction::Falling, 1.3), {half, 3 * half}, 1e-15);
  ExpectNear(Crossings(wave, Direction::Rising, 1.3), {2 * half, 4 * half}, 1e-15);
  ExpectNear(Crossings(wave, Direction::Both, 1.3), {half, 2 * half, 3 * half, 4 * half}, 1e-15);
}

TEST(Guards, ThatAreZeroAtStartHaveNotCrossed) {
  EXPECT_TRUE(Crossings([](double t) { return t; }, Direction::Both, 1).empty());
  EXPECT_TRUE(Crossings([](double t) { return -t; }, Direction::Both, 1).empty());
}

TEST(Guards, ThatReachZeroAndTurnBackHaveCrossed) {
  ExpectNear(Crossings([](double t) { return (t - 0.5) * (t - 0.5); }, Direction::Falling, 1),
             {0.5}, 1e-15);
}

TEST(Guards, FindTwoCrossingsInOneStepFurtherApartThanTheSpacing) {
  // Up at 50 ms and down 2 ms later; without states the steps are 0.1 s long.
  ExpectNear(Crossings([](double t) { return (t - 0.05) * (0.052 - t); }, Direction::Both, 1),
             {0.05, 0.052}, 1e-12);  // the slope there is 0.002, and round-off 1e-18
}

TEST(Guards, FireInTheOrderOfTheirTimes) {
  std::vector<double> times;
  DiagramBuilder b;
  auto& late = b.Add<Source>("late", [](double t) { return t - 0.0302; });
  auto& early = b.Add<Source>("early", [](double t) { return t - 0.0301; });
  auto& watch_late = b.Add<Watch>("watch_late", {.direction = Direction::Rising, .times = times});
  auto& watch_early = b.Add<Watch>("watch_early", {.direction = Direction::Rising, .times = times});
  b.Connect(late.y, watch_late.u);
  b.Connect(early.y, watch_early.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  ExpectNear(times, {0.0301, 0.0302}, 1e-16);
}

/// m flips when u rises through zero; at every tick y = m.
class Flip final : public Block {
 public:
  Flip() : u{this, "u"}, y{this, "y"}, guard{this, "guard"}, m{this, "m"} {
    Compute(guard).From(u).As([](double now) { return now; });
    When(guard).Crosses(Direction::Rising).Update(m).From().As([] { return 1.0; });
    Every(10ms).Compute(y).From(m).As([](double now) { return now; });
  }
  Input<double> u;
  Output<double> y, guard;
  Discrete<double> m;
};

TEST(Guards, GoBeforeATickAtTheSameInstant) {
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", [](double t) { return t - 0.05; });
  auto& flip = b.Add<Flip>("flip");
  b.Connect(source.y, flip.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.055);
  EXPECT_EQ(sim.Get(flip.y), 1);
}

/// Each event lets the next guard jump: a chain at one instant.
class Dominoes final : public Block {
 public:
  Dominoes() : first{this, "first"}, second{this, "second"}, a{this, "a"}, b{this, "b"} {
    Compute(first).From(clock).As([](double t) { return t - 0.3; });
    Compute(second).From(a).As([](double now) { return now - 0.5; });
    When(first).Crosses(Direction::Rising).Update(a).From().As([] { return 1.0; });
    When(second).Crosses(Direction::Rising).Update(b).From(clock).As([](double t) { return t; });
  }
  Output<double> first, second;
  Discrete<double> a, b;
};

TEST(Guards, ThatJumpOverZeroAtAnEventFireAtOnce) {
  DiagramBuilder b;
  auto& dominoes = b.Add<Dominoes>("dominoes");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  EXPECT_NEAR(sim.Get(dominoes.b), 0.3, 1e-16);
}

TEST(Guards, ThatJumpOverZeroBySetFireAtOnce) {
  std::vector<double> times;
  DiagramBuilder b;
  auto& level = b.Add<Constant<double>>("level", {.value = -1});
  auto& watch = b.Add<Watch>("watch", {.direction = Direction::Rising, .times = times});
  b.Connect(level.y, watch.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.25);
  sim.Set(level.value, 1);
  sim.AdvanceTo(0.5);
  EXPECT_EQ(times, std::vector{0.25});
}

TEST(Guards, OfHeldOutputsFireAtTicks) {
  std::vector<double> times;
  DiagramBuilder b;
  auto& time = b.Add<Source>("time", [](double t) { return t - 0.0455; });
  auto& sampler = b.Add<Sampler>("sampler", {.period = 10ms, .before = -1});
  auto& watch = b.Add<Watch>("watch", {.direction = Direction::Rising, .times = times});
  b.Connect(time.y, sampler.u);
  b.Connect(sampler.y, watch.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  EXPECT_EQ(times, std::vector{0.05});
}

/// A guard on t and on a value that a tick changes under way.
class Deadline final : public Block {
 public:
  explicit Deadline(std::vector<double>& times)
      : left{this, "left"}, until{this, "until", {}, 0.07} {
    Compute(left).From(until, clock).As([](double end, double t) { return end - t; });
    Every(20ms, 20ms).Update(until).From(clock).As([](double t) {
      return t < 0.1 ? t + 0.07 : 0.1;
    });
    When(left).Crosses(Direction::Falling).Publish().From(clock).As([&times](double t) {
      times.push_back(t);
    });
  }
  Output<double> left;
  Discrete<double> until;
};

TEST(Guards, DoNotForeseeWhatATickChanges) {
  std::vector<double> times;
  DiagramBuilder b;
  b.Add<Deadline>("deadline", times);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.3);
  EXPECT_EQ(times, std::vector{0.1});  // pushed on at 20 … 80 ms, and let go at 100 ms
}

TEST(Guards, SeeNothingNewWhenTheRunIsChangedInMidStep) {
  // Between 0.1 s and 0.2 s the guard rises, which is not its direction; the step is 1 s long.
  for (const bool snapshot : {true, false}) {
    std::vector<double> times;
    DiagramBuilder b;
    auto& one = b.Add<Constant<double>>("one", {.value = 1});
    auto& other = b.Add<Constant<double>>("other", {.value = 1});
    auto& x = b.Add<Integral>("x", -0.15);
    auto& watch = b.Add<Watch>("watch", {.direction = Direction::Falling, .times = times});
    b.Connect(one.y, x.u);
    b.Connect(x.y, watch.u);
    const Diagram diagram = b.Build();
    Simulator sim{diagram, {.integrator = {.max_step_s = 1, .initial_step_s = 1}}};
    sim.AdvanceTo(0.1);
    if (snapshot)
      sim.Snapshot();
    else
      sim.Set(other.value, 2);
    sim.AdvanceTo(2);
    EXPECT_TRUE(times.empty()) << "snapshot: " << snapshot;
  }
}

TEST(Guards, ResetDiscreteAndContinuousValuesTogether) {
  std::vector<double> bounces;
  DiagramBuilder b;
  auto& ball = b.Add<Ball>("ball", {.restitution = 1, .bounces = bounces});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(10);
  const double energy = kGravity * sim.Get(ball.h) + sim.Get(ball.v) * sim.Get(ball.v) / 2;
  EXPECT_NEAR(energy, kGravity, 1e-10);  // exact flight; round-off of each impact's time
  EXPECT_EQ(static_cast<std::size_t>(sim.Get(ball.count)), bounces.size());
  EXPECT_EQ(bounces.size(), 11u);
}

/// Two guards of one block that switch each other for ever.
class Chatter final : public Block {
 public:
  Chatter() : up{this, "up"}, down{this, "down"}, m{this, "m", {}, -1.0} {
    Compute(up).From(m, clock).As([](double mode, double t) { return t < 0.5 ? -1 : -mode; });
    Compute(down).From(m, clock).As([](double mode, double t) { return t < 0.5 ? -1 : mode; });
    When(up).Crosses(Direction::Rising).Update(m).From().As([] { return 1.0; });
    When(down).Crosses(Direction::Rising).Update(m).From().As([] { return -1.0; });
  }
  Output<double> up, down;
  Discrete<double> m;
};

TEST(Guards, ThatSwitchEachOtherForEverAreReported) {
  for (const double interval : {1e-4, 0.0}) {
    DiagramBuilder b;
    b.Add<Chatter>("chatter");
    const Diagram diagram = b.Build();
    Simulator sim{diagram, {.zeno_interval_s = interval}};
    EXPECT_THAT(ErrorOf([&] { sim.AdvanceTo(1); }),
                HasSubstr("Zeno behaviour: the guard chatter.up fires again and again at t = 0.5"));
  }
}

TEST(Guards, ThatAreNotFiniteAreNamed) {
  const std::string error = ErrorOf([] {
    Crossings([](double t) { return t < 0.5 ? 1 : std::numeric_limits<double>::quiet_NaN(); },
              Direction::Both, 1);
  });
  EXPECT_THAT(error, HasSubstr("the guard watch.guard is not finite at t = 0.5"));
}

TEST(Guards, AreCountedWhenTheyFire) {
  std::vector<double> times;
  DiagramBuilder b;
  b.Add<Ball>("ball", {.restitution = 1, .bounces = times});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.statistics().text(), "no step; 0 guards fired");
  sim.AdvanceTo(0.5);  // the first impact is at √(2/9.81) = 0.45 s, the next at 1.35 s
  EXPECT_EQ(sim.statistics().guards_fired, 1);
  EXPECT_TRUE(sim.statistics().text().ends_with("derivative calls; 1 guard fired"));
  sim.AdvanceTo(2);
  EXPECT_EQ(sim.statistics().guards_fired, std::ssize(times));
}

}  // namespace
}  // namespace pliant
