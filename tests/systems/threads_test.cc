#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

TEST(Threads, ShareADiagram) {
  DiagramBuilder b;
  auto& gain = b.Add<Constant<double>>("gain", {.value = 1});
  auto& sum = b.Add<Sum>("sum");
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 3, .period = 5ms});
  auto& integral = b.Add<Integral>("integral");
  b.Connect(gain.y, sum.a);
  b.Connect(integral.y, sum.b);
  b.Connect(sum.y, filter.u);
  b.Connect(filter.y, integral.u);
  const Diagram diagram = b.Build();

  const auto run = [&](double k) {
    Simulator sim{diagram};
    sim.Set(gain.value, k);
    sim.AdvanceTo(0.5);
    const Context middle = sim.Snapshot();
    sim.AdvanceTo(1);
    sim.Restore(middle);
    sim.AdvanceTo(1);
    return sim.Get(integral.y);
  };
  constexpr int kThreads = 4;
  std::vector<double> alone, together(kThreads);
  for (int k = 0; k < kThreads; ++k) alone.push_back(run(k));
  {
    std::vector<std::jthread> threads;
    for (int k = 0; k < kThreads; ++k)
      threads.emplace_back([&, k] { together[static_cast<std::size_t>(k)] = run(k); });
  }
  EXPECT_EQ(together, alone);
}

TEST(Threads, BuildDiagramsAtOnce) {
  const auto run = [] {
    DiagramBuilder b;
    auto& constant = b.Add<Constant<JointTorque>>("constant", {.space = {"a"}, .value = {2.0}});
    const Diagram diagram = b.Build();
    Simulator sim{diagram};
    return sim.Get(constant.y)(0);
  };
  std::vector<double> found(4);
  {
    std::vector<std::jthread> threads;
    for (double& x : found) threads.emplace_back([&] { x = run(); });
  }
  EXPECT_EQ(found, std::vector<double>(4, 2.0));
}

}  // namespace
}  // namespace pliant
