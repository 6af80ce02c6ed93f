#include "pliant/systems/diagram_structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A filter behind a gain, and a gain that is not wired.
class Smoothed final : public Composite {
 public:
  Smoothed() : u{this, "u"}, spare{this, "spare", {}, 1.0}, y{this, "y"} {
    auto& gain = Add<Gain<double>>("gain", {.gain = 3});
    auto& filter = Add<LowPass<double>>("filter", {.cutoff_hz = 5, .period = 1ms});
    auto& loose = Add<Gain<double>>("loose", {.gain = 3});
    Connect(u, gain.u);
    Connect(gain.y, filter.u);
    Connect(filter.y, y);
    Connect(spare, loose.u);
  }
  Input<double> u, spare;
  Output<double> y;
};

/// Counts how often u rises through 0.
class Crossings final : public Block {
 public:
  Crossings() : u{this, "u"}, level{this, "level"}, y{this, "y"}, n{this, "n"} {
    Compute(level).From(u).As([](double now) { return now; });
    When(level).Crosses(Direction::Rising).Update(n).From(n).As([](double now) { return now + 1; });
    Compute(y).From(n).As([](double now) { return now; });
  }
  Input<double> u;
  Output<double> level, y;
  Discrete<double> n;
};

const DiagramStructure::Block& BlockAt(const DiagramStructure& of, const std::string& path) {
  return *std::ranges::find(of.blocks, path, &DiagramStructure::Block::path);
}

std::vector<std::string> WiresOf(const DiagramStructure& of) {
  std::vector<std::string> wires;
  for (const auto& wire : of.wires)
    wires.push_back(of.blocks[static_cast<std::size_t>(wire.from)].path + " | " + wire.output +
                    " > " + wire.input + " | " + of.blocks[static_cast<std::size_t>(wire.to)].path);
  return wires;
}

TEST(DiagramStructure, HasTheTypesAndTheParentsOfBlocks) {
  DiagramBuilder b;
  b.Add<Constant<JointTorque>>("torque", {.space = {"shoulder", "elbow"}, .value = {1.0, 2.0}});
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& smoothed = b.Add<Smoothed>("smoothed");
  b.Connect(one.y, smoothed.u);
  const DiagramStructure of = DiagramStructure::Of(b.Build());
  std::vector<std::string> lines;
  for (const auto& block : of.blocks)
    lines.push_back(block.path + " | " + block.name + " | " + block.type + " | " +
                    std::to_string(block.parent) + (block.composite ? " | composite" : ""));
  EXPECT_THAT(lines, ElementsAre("torque | torque | Constant<JointTorque> | -1",
                                 "one | one | Constant<double> | -1",
                                 "smoothed | smoothed | Smoothed | -1 | composite",
                                 "smoothed.gain | gain | Gain<double, double> | 2",
                                 "smoothed.filter | filter | LowPass<double> | 2",
                                 "smoothed.loose | loose | Gain<double, double> | 2"));
  EXPECT_THAT(BlockAt(of, "torque").free, ElementsAre("torque.value"));
  EXPECT_THAT(BlockAt(of, "smoothed").free, ElementsAre("smoothed.spare"));
  EXPECT_THAT(BlockAt(of, "smoothed.loose").free, ElementsAre("smoothed.loose.u"));
  EXPECT_THAT(BlockAt(of, "smoothed.gain").free, IsEmpty());
}

TEST(DiagramStructure, HasWiresBehindThePortsOfComposites) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& smoothed = b.Add<Smoothed>("smoothed");
  auto& integral = b.Add<Integral>("integral");
  b.Connect(one.y, smoothed.u);
  b.Connect(smoothed.y, integral.u);
  const DiagramStructure of = DiagramStructure::Of(b.Build());
  EXPECT_THAT(WiresOf(of), ElementsAre("one | one.y > smoothed.gain.u | smoothed.gain",
                                       "smoothed.gain | smoothed.gain.y > smoothed.filter.u | "
                                       "smoothed.filter",
                                       "smoothed.filter | smoothed.filter.y > integral.u | "
                                       "integral"));
}

TEST(DiagramStructure, HasAWireForEachMemberOfAListInItsOrder) {
  class List final : public Block {
   public:
    List() : all{this, "all"}, y{this, "y"} {
      Compute(y).From(all).As([](const Joined<double>& x) { return 1.0 * x.size(); });
    }
    InputList<double> all;
    Output<double> y;
  };
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& two = b.Add<Constant<double>>("two", {.value = 1});
  auto& list = b.Add<List>("list");
  b.Connect(two.y, list.all);
  b.Connect(one.y, list.all);
  EXPECT_THAT(WiresOf(DiagramStructure::Of(b.Build())),
              ElementsAre("two | two.y > list.all | list", "one | one.y > list.all | list"));
}

TEST(DiagramStructure, EndsWiresAtACompositeThatReadsThemItself) {
  class Doubled final : public Composite {
   public:
    Doubled() : u{this, "u"}, twice{this, "twice"} {
      Compute(twice).From(u).As([](double now) { return 2 * now; });
      auto& integral = Add<Integral>("integral");
      Connect(twice, integral.u);
    }
    Input<double> u;
    Output<double> twice;
  };
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& doubled = b.Add<Doubled>("doubled");
  b.Connect(one.y, doubled.u);
  EXPECT_THAT(WiresOf(DiagramStructure::Of(b.Build())),
              ElementsAre("one | one.y > doubled.u | doubled",
                          "doubled | doubled.twice > doubled.integral.u | doubled.integral"));
}

TEST(DiagramStructure, GivesComputedValuesTheRatesOfWhatTheyFollow) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& fixed = b.Add<Gain<double>>("fixed", {.gain = 2});
  auto& time = b.Add<Source>("time", [](double t) { return t; });
  auto& fast = b.Add<Sampler>("fast", {.period = 1ms});
  auto& slow = b.Add<Delay>("slow", {.period = 5ms});
  auto& both = b.Add<Sum>("both");
  auto& integral = b.Add<Integral>("integral");
  auto& crossings = b.Add<Crossings>("crossings");
  b.Connect(one.y, fixed.u);
  b.Connect(time.y, fast.u);
  b.Connect(fast.y, slow.u);
  b.Connect(fast.y, both.a);
  b.Connect(slow.y, both.b);
  b.Connect(both.y, integral.u);
  b.Connect(integral.y, crossings.u);
  const DiagramStructure of = DiagramStructure::Of(b.Build());
  const auto rates = [&](const std::string& path) { return BlockAt(of, path).rates.texts(); };
  EXPECT_THAT(rates("one"), IsEmpty());
  EXPECT_THAT(rates("fixed"), IsEmpty());
  EXPECT_THAT(rates("time"), ElementsAre("continuous"));
  EXPECT_THAT(rates("fast"), ElementsAre("1 kHz"));
  EXPECT_THAT(rates("slow"), ElementsAre("200 Hz"));
  EXPECT_THAT(rates("both"), ElementsAre("1 kHz", "200 Hz"));
  EXPECT_THAT(rates("integral"), ElementsAre("continuous"));
  EXPECT_THAT(rates("crossings"), ElementsAre("continuous", "events"));
  EXPECT_EQ(of.wires.front().output, "one.y");
  EXPECT_EQ(of.wires.front().rates, Rates{});
  EXPECT_EQ(of.wires.back().output, "integral.y");
  EXPECT_EQ(of.wires.back().rates, Rates{.continuous = true});
}

TEST(DiagramStructure, KnowsWhatHoldsStateAndWhatRecords) {
  DiagramBuilder b;
  auto& smoothed = b.Add<Smoothed>("smoothed");
  auto& slow = b.Add<Delay>("slow", {.period = 5ms});
  auto& sampler = b.Add<Sampler>("sampler", {.period = 5ms});
  auto& integral = b.Add<Integral>("integral");
  auto& logger = b.Add<Logger>("logger", {.capacity = 1});
  b.Connect(integral.y, smoothed.u);
  b.Connect(integral.y, slow.u);
  b.Connect(slow.y, sampler.u);
  b.Connect(slow.y, integral.u);
  b.Connect(slow.y, logger.in);
  b.Connect(sampler.y, logger.in);
  const DiagramStructure of = DiagramStructure::Of(b.Build());
  std::vector<std::string> integrating, remembering, recording;
  for (const auto& block : of.blocks) {
    if (block.integrates) integrating.push_back(block.path);
    if (block.remembers) remembering.push_back(block.path);
    if (block.records) recording.push_back(block.path);
  }
  EXPECT_THAT(integrating, ElementsAre("integral"));
  // A filter reads what it was; so it is in its composite. A sample that is held is no memory.
  EXPECT_THAT(remembering, ElementsAre("smoothed", "smoothed.filter", "slow"));
  EXPECT_THAT(recording, ElementsAre("logger"));
  EXPECT_THAT(BlockAt(of, "logger").rates.texts(), ElementsAre("steps"));
  EXPECT_THAT(BlockAt(of, "smoothed").rates.texts(), ElementsAre("continuous", "1 kHz"));
}

TEST(Rates, AreOrderedAndSaidInTheUnitThatSuits) {
  Rates rates{.periods = {5ms}, .steps = true};
  rates |= {.periods = {std::chrono::seconds(5)}};
  rates |= {.periods = {125us, Hertz(30)}, .continuous = true};
  EXPECT_THAT(rates.texts(),
              ElementsAre("continuous", "8 kHz", "200 Hz", "30 Hz", "every 5 s", "steps"));
  const Rates before = rates;
  rates |= before;
  EXPECT_EQ(rates, before);
}

}  // namespace
}  // namespace pliant
