#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pliant/systems/real_time_runner.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;

/// ḧ = −2, from h = 1 at rest: h is 0 at t = 1.
class FallingBall final : public Block {
 public:
  FallingBall()
      : height{this, "height"}, h{this, "h", {}, 1.0}, v{this, "v"}, impacts{this, "impacts"} {
    Compute(height).From(h).As([](double now) { return now; });
    Derivative(h).From(v).As([](double now) { return now; });
    Derivative(v).From().As([] { return -2.0; });
    const auto impact = When(height).Crosses(Direction::Falling);
    impact.Stop("it has reached the floor");
    impact.Update(v).From(v).As([](double now) { return -now; });
    impact.Update(impacts).From(impacts).As([](int n) { return n + 1; });
  }
  Output<double> height;
  Continuous<double> h, v;
  Discrete<int> impacts;
};

/// Counts its ticks, and ends the run when it comes to `last`.
class Counter final : public Block {
 public:
  struct Options {
    Duration period;
    int last;
    Duration offset = {};
    std::vector<int>* seen = nullptr;
  };
  explicit Counter(const Options& o) : ticks{this, "ticks"}, done{this, "done"}, last_{o.last} {
    const auto tick = Every(o.period, o.offset);
    tick.Compute(ticks).From(ticks).As([](int n) { return n + 1; });
    tick.StopIf("it has counted to the last").From(ticks).As(&Counter::IsLast);
    tick.Update(done).From(ticks).As([](int n) { return n; });
    if (o.seen) tick.Publish().From(ticks).As([seen = o.seen](int n) { seen->push_back(n); });
  }
  Output<int> ticks;
  Discrete<int> done;

 private:
  bool IsLast(int n) const { return n == last_; }
  const int last_;
};

TEST(Stop, EndsTheRunWhereAGuardCrosses) {
  DiagramBuilder b;
  auto& ball = b.Add<FallingBall>("ball");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_FALSE(sim.ended());
  sim.AdvanceTo(0.5);
  EXPECT_FALSE(sim.ended());
  sim.AdvanceTo(5);
  ASSERT_TRUE(sim.ended());
  EXPECT_NEAR(sim.time(), 1, 1e-12);  // a parabola, which the default method integrates exactly
  EXPECT_EQ(sim.ended()->time, sim.time());
  EXPECT_EQ(sim.ended()->block, "ball");
  EXPECT_EQ(sim.ended()->reason, "it has reached the floor");
  EXPECT_EQ(sim.ended()->text(),
            "ball ended the run at t = " + Text(sim.time()) + " s: it has reached the floor");
  EXPECT_EQ(sim.Get(ball.impacts), 1) << "the updates of the last event";
  EXPECT_GT(sim.Get(ball.v), 0);
}

TEST(Stop, LeavesTheSimulatorWhereItIs) {
  DiagramBuilder b;
  auto& ball = b.Add<FallingBall>("ball");
  auto& counter = b.Add<Counter>("counter", {.period = 10ms, .last = -1});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(5);
  const Context end = sim.context();
  sim.AdvanceTo(6);
  sim.AdvanceThroughTick();
  EXPECT_TRUE(sim.context() == end);
  EXPECT_EQ(sim.Get(ball.impacts), 1);
  EXPECT_NEAR(sim.Get(counter.ticks), 100, 1);  // the impact is within round-off of a tick
}

TEST(Stop, ComesAfterAllEventsOfItsInstant) {
  std::vector<int> seen;
  DiagramBuilder b;
  auto& first = b.Add<Counter>("first", {.period = 10ms, .last = 4});
  auto& slow = b.Add<Counter>("slow", {.period = 30ms, .last = -1, .seen = &seen});
  auto& second = b.Add<Counter>("second", {.period = 30ms, .last = 2});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  ASSERT_TRUE(sim.ended());
  EXPECT_EQ(sim.time(), 0.03);
  EXPECT_EQ(sim.ended()->block, "first") << "who asked first";
  EXPECT_EQ(sim.Get(first.done), 4);
  EXPECT_EQ(sim.Get(slow.done), 2);
  EXPECT_EQ(sim.Get(second.done), 2);
  EXPECT_THAT(seen, ElementsAre(1, 2));
}

TEST(Stop, OfAGuardLetsATickOfTheSameInstantThrough) {
  DiagramBuilder b;
  auto& ramp = b.Add<Source>("ramp", [](double t) { return t - 0.5; });
  class AtZero final : public Block {
   public:
    AtZero() : u{this, "u"}, guard{this, "guard"} {
      Compute(guard).From(u).As([](double now) { return now; });
      When(guard).Crosses(Direction::Rising).Stop("it is half past");
    }
    Input<double> u;
    Output<double> guard;
  };
  auto& at_zero = b.Add<AtZero>("at_zero");
  auto& counter = b.Add<Counter>("counter", {.period = 250ms, .last = -1});
  b.Connect(ramp.y, at_zero.u);
  const Diagram diagram = b.Build();
  for (const bool by_ticks : {false, true}) {
    Simulator sim{diagram};
    if (by_ticks)
      for (int k = 0; k < 10; ++k) sim.AdvanceThroughTick();
    else
      sim.AdvanceTo(2);
    EXPECT_EQ(sim.time(), 0.5);
    EXPECT_EQ(sim.Get(counter.done), 3) << "at 0, 0.25 and 0.5 s";
    EXPECT_EQ(sim.ended()->block, "at_zero");
  }
}

TEST(Stop, IsTheSameHoweverTheRunIsSplit) {
  DiagramBuilder b;
  b.Add<FallingBall>("ball");
  b.Add<Counter>("counter", {.period = 10ms, .last = -1});
  const Diagram diagram = b.Build();
  Simulator whole{diagram}, split{diagram}, ticked{diagram};
  whole.AdvanceTo(2);
  for (int k = 1; k <= 700; ++k) split.AdvanceTo(k / 333.0);
  for (int k = 0; k < 300; ++k) ticked.AdvanceThroughTick();
  EXPECT_TRUE(split.context() == whole.context());
  EXPECT_TRUE(ticked.context() == whole.context());
}

TEST(Stop, IsTakenBackByASnapshotFromBefore) {
  const TemporaryDirectory directory;
  DiagramBuilder b;
  b.Add<FallingBall>("ball");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);
  const Context before = sim.Snapshot();
  sim.AdvanceTo(2);
  const Context end = sim.Snapshot();
  sim.Save(directory.path() / "end");
  EXPECT_TRUE(sim.ended());
  sim.Restore(before);
  EXPECT_FALSE(sim.ended());
  sim.AdvanceTo(0.6);
  EXPECT_EQ(sim.time(), 0.6);
  sim.AdvanceTo(2);
  EXPECT_TRUE(sim.context() == end);

  Simulator other{diagram};
  other.Restore(directory.path() / "end");
  ASSERT_TRUE(other.ended());
  EXPECT_EQ(other.ended()->reason, "it has reached the floor");
  other.AdvanceTo(3);
  EXPECT_TRUE(other.context() == end);
}

TEST(Stop, AtATickIsATimer) {
  DiagramBuilder b;
  class Timer final : public Block {
   public:
    Timer() { Every(1s, 2500ms).Stop("the time is over"); }
  };
  b.Add<Timer>("timer");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(2.5);
  EXPECT_FALSE(sim.ended()) << "events at t begin the next call";
  sim.AdvanceTo(9);
  EXPECT_EQ(sim.time(), 2.5);
  EXPECT_EQ(sim.ended()->reason, "the time is over");
}

TEST(Stop, NeedsAReason) {
  class Silent final : public Block {
   public:
    Silent() { Every(1ms).Stop(""); }
  };
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] { b.Add<Silent>("silent"); }),
            "silent: a rule that stops a run says why; give it a reason");
}

TEST(Stop, DoesNotAllocate) {
  if (!kCountsAllocations) return;  // a sanitizer has a heap of its own
  DiagramBuilder b;
  b.Add<Counter>("counter", {.period = 1ms, .last = 900});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.1);
  const long before = Allocations();
  for (int k = 100; k <= 1000; ++k) sim.AdvanceTo(k / 1e3);
  const bool ended = sim.ended().has_value();
  EXPECT_EQ(Allocations() - before, 0);
  EXPECT_TRUE(ended);
}

TEST(Stop, EndsARealTimeRunWithItsReason) {
  for (const int last : {1, 5}) {
    DiagramBuilder b;
    b.Add<Counter>("counter", {.period = 1ms, .last = last});
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    RealTimeRunner runner(sim, {.paced = false});
    const RunReport& report = runner.Run(1);
    EXPECT_EQ(report.end, RunEnd::Ended);
    EXPECT_EQ(report.ticks, last);
    EXPECT_EQ(report.reason, "counter ended the run at t = " + Text((last - 1) / 1e3) +
                                 " s: it has counted to the last");
    EXPECT_EQ(runner.Run(1).end, RunEnd::Ended) << "again";
    EXPECT_EQ(runner.report().ticks, 0);
  }
}

TEST(Stop, BetweenTicksEndsARealTimeRunBeforeTheNext) {
  DiagramBuilder b;
  b.Add<FallingBall>("ball");
  b.Add<Counter>("counter", {.period = 300ms, .last = -1});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  RealTimeRunner runner(sim, {.paced = false});
  EXPECT_EQ(runner.Run(5).end, RunEnd::Ended);
  EXPECT_EQ(runner.report().ticks, 4) << "at 0, 0.3, 0.6 and 0.9 s";
  EXPECT_NEAR(sim.time(), 1, 1e-12);  // as above

  Simulator short_one{diagram};
  EXPECT_EQ(RealTimeRunner(short_one, {.paced = false}).Run(1.1).end, RunEnd::Ended)
      << "behind the last tick";
}

}  // namespace
}  // namespace pliant
