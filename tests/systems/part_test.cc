#include "pliant/systems/part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// y = Σ terms · 10^i, the last with i = 0.
class Digits final : public Block {
 public:
  Digits() : terms{this, "terms"}, y{this, "y"} {
    Compute(y).From(terms).As([](const Joined<double>& all) {
      double sum = 0;
      for (int i = 0; i < all.size(); ++i) sum = 10 * sum + all[i];
      return sum;
    });
  }
  InputList<double> terms;
  Output<double> y;
};

/// digits joins u, the list and an offset with a default.
class Joining final : public Composite {
 public:
  Joining() : u{this, "u"}, list{this, "list"}, offset{this, "offset", {}, 7.0}, y{this, "y"} {
    auto& digits = Add<Digits>("digits");
    Connect(u, digits.terms);
    Connect(list, digits.terms);
    Connect(offset, digits.terms);
    Connect(digits.y, y);
  }
  Input<double> u;
  InputList<double> list;
  Input<double> offset;
  Output<double> y;
};

/// A Joining within a composite whose own input has a default.
class Outer final : public Composite {
 public:
  Outer() : list{this, "list"}, offset{this, "offset", {}, 5.0}, y{this, "y"} {
    auto& source = Add<Source>("source", [](double t) { return t; });
    auto& joining = Add<Joining>("joining");
    Connect(source.y, joining.u);
    Connect(list, joining.list);
    Connect(offset, joining.offset);
    Connect(joining.y, y);
  }
  InputList<double> list;
  Input<double> offset;
  Output<double> y;
};

std::vector<std::string> PathsOf(const std::vector<NamedValue>& values) {
  std::vector<std::string> paths;
  for (const NamedValue& v : values) paths.push_back(v.path);
  return paths;
}

/// outer, whose list joins the integrals `a` and `b`, and a sampler behind it.
DiagramBuilder Listed() {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& first = b.Add<Integral>("a");
  auto& second = b.Add<Integral>("b");
  auto& outer = b.Add<Outer>("outer");
  auto& sampler = b.Add<Sampler>("sampler", {.period = 1ms});
  b.Connect(one.y, first.u);
  b.Connect(one.y, second.u);
  b.Connect(first.y, outer.list);
  b.Connect(second.y, outer.list);
  b.Connect(outer.y, sampler.u);
  return b;
}

const std::vector<std::string> kListed{"outer.source.y", "a.y", "b.y", "outer.y"};

void Set(Simulator& sim, const NamedValue& value, double x) {
  sim.SetNumbers(*value.value, std::vector{x});
}

double Get(Simulator& sim, const NamedValue& value) {
  std::vector<double> x(1);
  sim.GetNumbers(*value.value, x);
  return x[0];
}

TEST(Part, HasAFreeValueForEachWireOfAList) {
  const Part part = Listed().BuildPart("outer.joining", kListed);
  ASSERT_THAT(PathsOf(part.given), ElementsAre("outer.source.y", "a.y", "b.y"));
  ASSERT_THAT(PathsOf(part.computed), ElementsAre("outer.y"));
  EXPECT_THAT(part.along, IsEmpty());
  EXPECT_THAT(part.unknown, IsEmpty());
  Simulator sim{part.diagram};
  Set(sim, part.given[0], 1);
  Set(sim, part.given[1], 2);
  Set(sim, part.given[2], 3);
  EXPECT_EQ(Get(sim, part.computed[0]), 1235);  // the default is that of the outer composite
}

TEST(Part, KeepsThePathsOfAllValues) {
  const Part part = Listed().BuildPart("outer.joining", kListed);
  std::vector<std::string> paths;
  for (const ValueInfo& v : part.diagram.Values()) paths.push_back(v.path + ": " + v.kind);
  EXPECT_THAT(paths,
              ::testing::UnorderedElementsAre(
                  "outer.offset: input", "outer.source.y: input", "a.y: input", "b.y: input",
                  "outer.joining.u: input", "outer.joining.list: input list",
                  "outer.joining.offset: input", "outer.joining.y: output",
                  "outer.joining.digits.terms: input list", "outer.joining.digits.y: output"));
}

TEST(Part, ComputesAgainWhatIsNotKnown) {
  const Part part = Listed().BuildPart("sampler", {"a.y", "b.y", "sampler.y"});
  EXPECT_THAT(part.along, ElementsAre("outer.joining.digits", "outer.source"));
  ASSERT_THAT(PathsOf(part.given), ElementsAre("a.y", "b.y"));
  Simulator sim{part.diagram};
  Set(sim, part.given[0], 2);
  Set(sim, part.given[1], 3);
  sim.AdvanceThroughTick();
  EXPECT_EQ(Get(sim, part.computed[0]), 235);  // the source is 0 at t = 0
}

TEST(Part, ReplacesNoValueOfABlockThatRunsAlong) {
  // Of the two outputs of a block one is known; the other is computed, and so are both.
  struct Two final : Block {
    Two() : u{this, "u"}, twice{this, "twice"}, half{this, "half"} {
      Compute(twice).From(u).As([](double x) { return 2 * x; });
      Compute(half).From(u).As([](double x) { return x / 2; });
    }
    Input<double> u;
    Output<double> twice, half;
  };
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& two = b.Add<Two>("two");
  auto& sum = b.Add<Sum>("sum");
  b.Connect(one.y, two.u);
  b.Connect(two.twice, sum.a);
  b.Connect(two.half, sum.b);
  const Part part = b.BuildPart("sum", {"two.twice", "sum.y"});
  EXPECT_THAT(part.given, IsEmpty());
  EXPECT_THAT(part.along, ElementsAre("two", "one"));
  Simulator sim{part.diagram};
  EXPECT_EQ(Get(sim, part.computed[0]), 2.5);
}

TEST(Part, IsWatchedBeforeItsStatesAreUpdated) {
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", [](double t) { return 1000 * t; });
  auto& delay = b.Add<Delay>("delay", {.period = 1ms, .initial = -1});
  b.Connect(source.y, delay.u);
  std::vector<std::string> seen;
  const Part part =
      b.BuildPart("delay", {"source.y", "delay.y"}, [&](double t, const AnyValues& values) {
        double y = 0;
        ASSERT_EQ(values.size(), 1);
        ASSERT_TRUE(values.type(0).store(values[0], &y, 1));
        seen.push_back(Text(t) + ": " + Text(y));
      });
  Simulator sim{part.diagram};
  for (const double u : {5, 6, 7}) {
    Set(sim, part.given[0], u);
    sim.AdvanceThroughTick();
    EXPECT_EQ(Get(sim, part.computed[0]), u);  // after the tick
  }
  EXPECT_THAT(seen, ElementsAre("0: -1", "0.001: 5", "0.002: 6"));
}

TEST(Part, KeepsALoggerWithinIt) {
  struct Logged final : Composite {
    Logged() : u{this, "u"}, y{this, "y"} {
      auto& gain = Add<Gain<double>>("gain", {.gain = 3});
      logger = &Add<Logger>("logger", {.period = 1ms});
      Connect(u, gain.u);
      Connect(u, logger->in);
      Connect(gain.y, logger->in);
      Connect(gain.y, y);
    }
    Input<double> u;
    Output<double> y;
    Logger* logger;
  };
  DiagramBuilder b;
  auto& integral = b.Add<Integral>("integral");
  auto& logged = b.Add<Logged>("logged");
  b.Connect(integral.y, logged.u);
  b.Connect(logged.y, integral.u);
  const Part part = b.BuildPart("logged", {"integral.y", "logged.y"});
  Simulator sim{part.diagram};
  Set(sim, part.given[0], 4);
  sim.AdvanceThroughTick();
  const Log& log = sim.Get(logged.logger->log);
  EXPECT_THAT(log.columns(), ElementsAre("logged.u", "logged.gain.y"));
  EXPECT_EQ(log["logged.gain.y"](0), 12);
}

TEST(Part, SaysWhichKnownPathsItDoesNotHave) {
  const Part part = Listed().BuildPart(
      "outer.joining",
      {"outer.source.y", "a.y", "b.y", "outer.joining.z", "elsewhere.z", "outer.joining.list"});
  EXPECT_THAT(part.unknown, ElementsAre("outer.joining.z", "outer.joining.list"));
  EXPECT_THAT(part.computed, IsEmpty());
}

TEST(Part, IsFoundByItsPath) {
  EXPECT_EQ(ErrorOf([] { Listed().BuildPart("outer.joning", {}); }),
            "the diagram has no part 'outer.joning'; did you mean 'outer.joining'?");
  EXPECT_EQ(ErrorOf([] { DiagramBuilder().BuildPart("arm", {}); }),
            "the diagram has no part 'arm'");
}

TEST(Part, OfWhatIsIntegratedIsRefused) {
  EXPECT_EQ(ErrorOf([] { Listed().BuildPart("a", {"one.y"}); }),
            "cannot run a by itself: a.x : double changes between ticks\nname a part that is "
            "sampled");
}

TEST(Part, OfAGuardIsRefused) {
  struct Counter final : Block {
    Counter() : u{this, "u"}, watched{this, "watched"}, count{this, "count"} {
      Compute(watched).From(u).As([](double x) { return x; });
      When(watched).Crosses(Direction::Rising).Update(count).From(count).As([](double n) {
        return n + 1;
      });
    }
    Input<double> u;
    Output<double> watched;
    Discrete<double> count;
  };
  DiagramBuilder b;
  auto& source = b.Add<Source>("source", [](double t) { return t; });
  auto& counter = b.Add<Counter>("counter");
  b.Connect(source.y, counter.u);
  EXPECT_EQ(ErrorOf([&] { b.BuildPart("counter", {"source.y"}); }),
            "cannot run counter by itself: counter.watched : double changes between ticks\nname a "
            "part that is sampled");
}

TEST(Part, FedByAnIntegralThatIsNotKnownIsRefused) {
  EXPECT_EQ(ErrorOf([] { Listed().BuildPart("sampler", {"a.y"}); }),
            "cannot run sampler by itself: what feeds it is not known\n"
            "  from  b.y : double\n"
            "  to    outer.joining.digits.terms : double\n"
            "b.x changes between ticks, so it is not computed again; record b.y");
}

TEST(Part, WhoseStartReadsWhatIsGivenIsRefused) {
  struct Starter final : Block {
    Starter() : u{this, "u"}, twice{this, "twice"}, x{this, "x"} {
      Compute(twice).From(u).As([](double now) { return 2 * now; });
      AtStart().Update(x).From(twice).As([](double now) { return now; });
    }
    Input<double> u;
    Output<double> twice;
    Discrete<double> x;
  };
  const auto make = [] {
    DiagramBuilder b;
    auto& source = b.Add<Source>("source", [](double t) { return t + 1; });
    auto& starter = b.Add<Starter>("starter");
    b.Connect(source.y, starter.u);
    return b;
  };
  EXPECT_EQ(ErrorOf([&] { make().BuildPart("starter", {"source.y"}); }),
            "cannot run starter by itself: the start of starter follows from source.y, which is "
            "known from the first tick on\nname a part without starter");
  // computed again it is known from the start
  const Part part = make().BuildPart("starter", {"starter.x"});
  Simulator sim{part.diagram};
  EXPECT_EQ(Get(sim, part.computed[0]), 2);
}

TEST(Part, OfAnUnconnectedInputIsRefused) {
  DiagramBuilder b;
  b.Add<Sampler>("sampler", {.period = 1ms});
  EXPECT_EQ(ErrorOf([&] { b.BuildPart("sampler", {}); }),
            "input is not connected:\n  sampler.u : double\nconnect an output to it, or give it a "
            "default");
}

TEST(Part, InACircleOfWiresIsRefused) {
  struct Through final : Composite {
    Through() : u{this, "u"}, y{this, "y"} { Connect(u, y); }
    Input<double> u;
    Output<double> y;
  };
  DiagramBuilder b;
  auto& through = b.Add<Through>("through");
  b.Connect(through.y, through.u);
  EXPECT_EQ(ErrorOf([&] { b.BuildPart("through", {"through.y"}); }),
            "algebraic loop; wires alone lead from this port back to it:\n  through.u : double");
}

TEST(Part, LeavesTheBuilderEmpty) {
  DiagramBuilder b = Listed();
  b.BuildPart("outer.joining", kListed);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "the diagram is built already; start with a new DiagramBuilder");
}

}  // namespace
}  // namespace pliant
