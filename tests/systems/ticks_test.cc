#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using Row = Recorder::Row;

TEST(Ticks, CascadeOfSampledFiltersIsAPlainLoop) {
  DiagramBuilder b;
  auto& last = b.Add<LowPass<double>>("last", {.cutoff_hz = 40, .period = 1ms});
  auto& source = b.Add<Source>("source", [](double t) { return std::sin(50 * t); });
  auto& middle = b.Add<LowPass<double>>("middle", {.cutoff_hz = 30, .period = 1ms});
  auto& first = b.Add<LowPass<double>>("first", {.cutoff_hz = 20, .period = 1ms});
  b.Connect(source.y, first.u);
  b.Connect(first.y, middle.u);
  b.Connect(middle.y, last.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};

  const auto alpha = [](double f) {
    return 1 - std::exp(-2 * std::numbers::pi * f * seconds(Duration(1ms)));
  };
  double y1 = 0, y2 = 0, y3 = 0;
  for (int k = 0; k < 200; ++k) {
    const double u = std::sin(50 * (k / 1e3));
    y1 = y1 + alpha(20) * (u - y1);
    y2 = y2 + alpha(30) * (y1 - y2);
    y3 = y3 + alpha(40) * (y2 - y3);
    sim.AdvanceTo((k + 0.5) / 1e3);
    ASSERT_EQ(sim.Get(last.y), y3) << "tick " << k;
  }
}

TEST(Ticks, TwoBlocksSwapTheirDiscreteValues) {
  DiagramBuilder b;
  auto& left = b.Add<Delay>("left", {.period = 1ms, .initial = 1});
  auto& right = b.Add<Delay>("right", {.period = 1ms, .initial = 2});
  b.Connect(left.y, right.u);
  b.Connect(right.y, left.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(sim.Get(left.y), k % 2 == 0 ? 1 : 2);
    EXPECT_EQ(sim.Get(right.y), k % 2 == 0 ? 2 : 1);
    sim.AdvanceTo((k + 0.5) / 1e3);
  }
}

TEST(Ticks, OrderOfInsertionDoesNotMatter) {
  const auto run = [](const std::vector<int>& order) {
    DiagramBuilder b;
    Source* source = nullptr;
    LowPass<double>* filter = nullptr;
    Sampler* sampler = nullptr;
    Delay* delay = nullptr;
    Integral* integral = nullptr;
    Sum* sum = nullptr;
    for (const int i : order) {
      if (i == 0) source = &b.Add<Source>("source", [](double t) { return std::cos(9 * t); });
      if (i == 1) filter = &b.Add<LowPass<double>>("filter", {.cutoff_hz = 8, .period = 2ms});
      if (i == 2) sampler = &b.Add<Sampler>("sampler", {.period = 3ms});
      if (i == 3) delay = &b.Add<Delay>("delay", {.period = 1ms});
      if (i == 4) integral = &b.Add<Integral>("integral");
      if (i == 5) sum = &b.Add<Sum>("sum");
    }
    b.Connect(source->y, sum->a);
    b.Connect(delay->y, sum->b);
    b.Connect(sum->y, filter->u);
    b.Connect(filter->y, integral->u);
    b.Connect(integral->y, sampler->u);
    b.Connect(sampler->y, delay->u);
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    sim.AdvanceTo(0.1);
    return std::vector{sim.Get(sum->y), sim.Get(filter->y), sim.Get(integral->y),
                       sim.Get(sampler->y), sim.Get(delay->y)};
  };
  std::vector<int> order(6);
  std::iota(order.begin(), order.end(), 0);
  const std::vector<double> expected = run(order);
  while (std::ranges::next_permutation(order).found) ASSERT_EQ(run(order), expected);
}

TEST(Ticks, SampledSignalsDoNotDependOnTheIntegratorsSteps) {
  const auto run = [](double tolerance) {  // ẍ = y, the filtered x: grows as eᵗ
    std::vector<Row> rows;
    DiagramBuilder b;
    auto& position = b.Add<Integral>("position", 1.0);
    auto& velocity = b.Add<Integral>("velocity", 0.0);
    auto& force = b.Add<LowPass<double>>("force", {.cutoff_hz = 5, .period = 10ms});
    auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 10ms});
    b.Connect(velocity.y, position.u);
    b.Connect(position.y, force.u);
    b.Connect(force.y, velocity.u);
    b.Connect(force.y, recorder.a);
    b.Connect(position.y, recorder.b);
    const Diagram diagram = b.Build();
    Simulator sim{
        diagram,
        {.integrator = {.relative_tolerance = tolerance, .absolute_tolerance = tolerance}}};
    sim.AdvanceTo(1);
    return rows;
  };
  const std::vector<Row> coarse = run(1e-4), fine = run(1e-9);
  ASSERT_EQ(coarse.size(), 100u);
  ASSERT_EQ(fine.size(), coarse.size());
  for (std::size_t k = 0; k < fine.size(); ++k) {
    // Up to 100 steps of the coarse run, each wrong by its tolerance, grow by less than e² in 1 s.
    EXPECT_NEAR(coarse[k].a, fine[k].a, 100 * 1e-4 * 8) << "tick " << k;
    EXPECT_NEAR(coarse[k].b, fine[k].b, 100 * 1e-4 * 8) << "tick " << k;
  }
}

TEST(Ticks, SlowBlocksSampleFastAndContinuousOnesAtTheirOwnTicks) {
  std::vector<Row> rows;
  DiagramBuilder b;
  auto& slow = b.Add<Sampler>("slow", {.period = 5ms});
  auto& slow_time = b.Add<Sampler>("slow_time", {.period = 5ms});
  auto& time = b.Add<Source>("time", [](double t) { return t; });
  auto& fast = b.Add<Sampler>("fast", {.period = 2ms});
  auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 1ms});
  b.Connect(time.y, fast.u);
  b.Connect(fast.y, slow.u);
  b.Connect(time.y, slow_time.u);
  b.Connect(slow.y, recorder.a);
  b.Connect(slow_time.y, recorder.b);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0205);
  ASSERT_EQ(rows.size(), 21u);
  for (int k = 0; k <= 20; ++k) {
    const int tick = k / 5 * 5;          // of the slow blocks, in ms
    const int fast_tick = tick / 2 * 2;  // the fast one's at or before it
    EXPECT_EQ(rows[static_cast<std::size_t>(k)], (Row{k / 1e3, fast_tick / 1e3, tick / 1e3}));
  }
}

TEST(Ticks, TheFirstIsBeforeTheFirstStepOfTheIntegrator) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& sampler = b.Add<Sampler>("sampler", {.period = 10s, .before = 1e6});
  auto& integral = b.Add<Integral>("integral");
  b.Connect(one.y, sampler.u);
  b.Connect(sampler.y, integral.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(sampler.y), 1e6);
  sim.AdvanceTo(0);
  EXPECT_EQ(sim.Get(sampler.y), 1e6);  // events at t begin the next call
  sim.AdvanceTo(0.5);
  EXPECT_EQ(sim.Get(sampler.y), 1);
  EXPECT_NEAR(sim.Get(integral.y), 0.5, 1e-15);  // linear: round-off only
}

TEST(Ticks, ARowOfALogIsOneInstant) {
  std::vector<Row> rows;
  DiagramBuilder b;
  auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 1ms});
  auto& delay = b.Add<Delay>("delay", {.period = 1ms, .initial = -1});
  auto& sampler = b.Add<Sampler>("sampler", {.period = 1ms});
  auto& time = b.Add<Source>("time", [](double t) { return 1000 * t; });
  b.Connect(time.y, sampler.u);
  b.Connect(sampler.y, delay.u);
  b.Connect(sampler.y, recorder.a);
  b.Connect(delay.y, recorder.b);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0035);
  EXPECT_EQ(rows, (std::vector<Row>{{0, 0, -1}, {1e-3, 1, 0}, {2e-3, 2, 1}, {3e-3, 3, 2}}));
}

TEST(Ticks, UpdatesOfSeveralRatesAtOneInstantReadTheOldValues) {
  DiagramBuilder b;
  auto& fast = b.Add<Delay>("fast", {.period = 1ms, .initial = 1});
  auto& slow = b.Add<Delay>("slow", {.period = 2ms, .initial = 2});
  b.Connect(fast.y, slow.u);
  b.Connect(slow.y, fast.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0005);  // both at 0: swapped
  EXPECT_EQ(sim.Get(fast.y), 2);
  EXPECT_EQ(sim.Get(slow.y), 1);
  sim.AdvanceTo(0.0015);  // the fast one alone
  EXPECT_EQ(sim.Get(fast.y), 1);
  EXPECT_EQ(sim.Get(slow.y), 1);
}

TEST(Ticks, HeldOutputsOfSeveralRatesFollowOneAnotherAtOneInstant) {
  DiagramBuilder b;
  auto& last = b.Add<Sampler>("last", {.period = 3ms});
  auto& middle = b.Add<Sampler>("middle", {.period = 2ms});
  auto& first = b.Add<Sampler>("first", {.period = 1ms});
  auto& time = b.Add<Source>("time", [](double t) { return 1 + t; });
  b.Connect(time.y, first.u);
  b.Connect(first.y, middle.u);
  b.Connect(middle.y, last.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0005);
  EXPECT_EQ(sim.Get(last.y), 1);
  sim.AdvanceTo(0.0065);
  EXPECT_EQ(sim.Get(last.y), 1 + 0.006);
  sim.AdvanceTo(0.0095);
  EXPECT_EQ(sim.Get(last.y), 1 + 0.008);
}

TEST(Ticks, RatesAreRational) {
  std::vector<Row> rows;
  DiagramBuilder b;
  b.Add<Recorder>("recorder", {.rows = rows, .period = Hertz(30)});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(10.01);
  ASSERT_EQ(rows.size(), 301u);
  for (std::int64_t k = 0; k <= 300; ++k)
    EXPECT_EQ(rows[static_cast<std::size_t>(k)].t,
              static_cast<double>(k * 1'000'000'000 / 30) / 1e9);
}

TEST(Ticks, TheBillionthIsExact) {
  constexpr std::int64_t k = 1'000'000'000;
  EXPECT_EQ(Duration(1ms).Times(k), 1'000'000'000'000'000);
  EXPECT_EQ(Hertz(30).Times(k), 33'333'333'333'333'333);
  EXPECT_EQ(Hertz(30000, 1001).Times(30000 * 1000), 1'001'000 * k);
}

TEST(Ticks, OffsetsShiftThem) {
  std::vector<Row> rows;
  DiagramBuilder b;
  auto& time = b.Add<Source>("time", [](double t) { return t; });
  auto& sampler = b.Add<Sampler>("sampler", {.period = 10ms, .offset = 3ms, .before = -1});
  auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 10ms, .offset = 5ms});
  b.Connect(time.y, sampler.u);
  b.Connect(sampler.y, recorder.a);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.002);
  EXPECT_EQ(sim.Get(sampler.y), -1);
  sim.AdvanceTo(0.03);
  EXPECT_EQ(rows, (std::vector<Row>{{0.005, 0.003, 0}, {0.015, 0.013, 0}, {0.025, 0.023, 0}}));
}

TEST(Ticks, ThatOnlyPublishDoNotCutTheIntegratorsSteps) {
  std::vector<Row> rows;
  const auto steps = [&](bool recorded) {
    DiagramBuilder b;
    auto& integral = b.Add<Integral>("integral", 1.0);
    auto& one = b.Add<Constant<double>>("one", {.value = 1});
    b.Connect(one.y, integral.u);
    if (recorded) {
      auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 1ms});
      b.Connect(integral.y, recorder.a);
    }
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    sim.AdvanceTo(1);
    return sim.statistics().steps;
  };
  EXPECT_EQ(steps(true), steps(false));
  ASSERT_EQ(rows.size(), 1000u);
  for (const Row& row : rows) EXPECT_NEAR(row.a, 1 + row.t, 1e-14);  // linear: round-off only
}

}  // namespace
}  // namespace pliant
