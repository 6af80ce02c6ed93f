#include "pliant/systems/tick_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

/// y_k = u_k after some time of work.
class Work final : public Block {
 public:
  struct Options {
    std::chrono::microseconds time;
    Duration period = 1ms;
  };
  explicit Work(const Options& o) : u{this, "u", {}, 0.0}, y{this, "y"}, time_{o.time} {
    Every(o.period).Compute(y).From(u).As(&Work::Do);
  }
  Input<double> u;
  Output<double> y;

 private:
  double Do(double now) const {
    const auto end = std::chrono::steady_clock::now() + time_;
    while (std::chrono::steady_clock::now() < end) continue;
    return now;
  }
  const std::chrono::microseconds time_;
};

TEST(TickCost, IsTheTimeOfTheRulesByBlock) {
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", [](double t) { return t; });
  auto& light = b.Add<Work>("light", {.time = 50us});
  auto& heavy = b.Add<Work>("heavy", {.time = 200us});
  b.Connect(source.y, light.u);
  b.Connect(light.y, heavy.u);
  const TickCost cost = EstimateTickCost(b.Build(), 20);
  ASSERT_EQ(cost.blocks.size(), 3u);
  EXPECT_EQ(cost.blocks[0].path, "heavy");
  EXPECT_EQ(cost.blocks[1].path, "light");
  EXPECT_EQ(cost.blocks[2].path, "source");
  // What looking at the clock costs is taken off: far less than 5 µs.
  EXPECT_GE(cost.blocks[0].cost, 195e-6);
  EXPECT_GE(cost.blocks[1].cost, 45e-6);
  EXPECT_LT(cost.blocks[2].cost, 45e-6);
  EXPECT_EQ(cost.rules, 3);
  EXPECT_EQ(cost.period, 1e-3);
  double sum = 0;
  for (const TickCost::Block& block : cost.blocks) sum += block.cost;
  EXPECT_EQ(cost.cost, sum);
}

TEST(TickCost, CountsTheRulesOfATickAlone) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& fixed = b.Add<Gain<double>>("fixed", {.gain = 2});  // once: its input is a constant
  auto& delay = b.Add<Delay>("delay", {.period = 1ms});     // an update, and y from x
  auto& unread = b.Add<Source>("unread", [](double t) { return t; });
  auto& slow = b.Add<Sampler>("slow", {.period = 10ms});  // due at the dearest tick
  b.Connect(one.y, fixed.u);
  b.Connect(fixed.y, delay.u);
  b.Connect(delay.y, slow.u);
  const TickCost cost = EstimateTickCost(b.Build());
  EXPECT_EQ(cost.rules, 3) << unread.path();
  for (const TickCost::Block& block : cost.blocks)
    EXPECT_EQ(block.rules, block.path == "delay" ? 2 : 1) << block.path;
  EXPECT_EQ(cost.period, 1e-3);
}

TEST(TickCost, RunsNoPublishRuleButWhatItReads) {
  std::vector<Recorder::Row> rows;
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", [](double t) { return t; });
  auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 1ms});
  b.Connect(source.y, recorder.a);
  const TickCost cost = EstimateTickCost(b.Build());
  EXPECT_TRUE(rows.empty());
  ASSERT_EQ(cost.blocks.size(), 1u);
  EXPECT_EQ(cost.blocks[0].path, "source");
}

/// Counts its ticks from what it is set to at start, and shows the last count to a test.
class Counter final : public Block {
 public:
  explicit Counter(int& most) : n{this, "n"}, seen{this, "seen"}, most_{most} {
    AtStart().Update(n).From().As([] { return 20; });
    Every(1ms).Update(n).From(n).As([](int now) { return now + 1; });
    Every(1ms).Compute(seen).From(n).As(&Counter::See);
  }
  Discrete<int> n;
  Output<int> seen;

 private:
  int See(int now) const { return most_ = std::max(most_, now); }
  int& most_;
};

TEST(TickCost, GoesOnFromTheStartSampleBySample) {
  int most = 0;
  DiagramBuilder b;
  b.Add<Counter>("counter", most);
  EXPECT_EQ(EstimateTickCost(b.Build(), 5).rules, 2);
  EXPECT_EQ(most, 24);  // 20 before the first sample
}

TEST(TickCost, IsALineForAPerson) {
  const TickCost cost{.period = 1e-3,
                      .cost = 21.04e-6,
                      .rules = 214,
                      .blocks = {{"control.qp", 6.1e-6, 3}, {"arm", 850e-9, 8}, {"pad", 0, 1}}};
  EXPECT_EQ(cost.text(2),
            "estimated 21 µs a tick of 1 ms, 214 rules; control.qp 6.1 µs, arm 850 ns and 1 more "
            "block");
  EXPECT_EQ(cost.text(0), "estimated 21 µs a tick of 1 ms, 214 rules");
  EXPECT_EQ(cost.text(),
            "estimated 21 µs a tick of 1 ms, 214 rules; control.qp 6.1 µs, arm 850 ns, pad 0 ns");
}

TEST(TickCost, RefusesNoSamplesAndDiagramsThatDoNotTick) {
  DiagramBuilder ticking;
  ticking.Add<Work>("work", {.time = 0us});
  const Diagram diagram = ticking.Build();
  EXPECT_EQ(ErrorOf([&] { EstimateTickCost(diagram, 0); }), "samples must be >= 1, got 0");

  DiagramBuilder still;
  still.Add<Constant<double>>("one", {.value = 1});
  const Diagram constant = still.Build();
  EXPECT_EQ(ErrorOf([&] { EstimateTickCost(constant); }),
            "nothing ticks: no rule of the diagram has Every(period)");
}

}  // namespace
}  // namespace pliant
