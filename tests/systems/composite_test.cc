#include <gtest/gtest.h>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

/// y = Σ of a list.
class Total final : public Block {
 public:
  Total() : terms{this, "terms"}, y{this, "y"} {
    Compute(y).From(terms).As([](const Joined<double>& all) {
      double sum = 0;
      for (int i = 0; i < all.size(); ++i) sum = 10 * sum + all[i];
      return sum;
    });
  }
  InputList<double> terms;
  Output<double> y;
};

/// y = 2 u; `same` is u; `total` joins its own first input and a list from outside.
class Inner final : public Composite {
 public:
  Inner()
      : u{this, "u"}, terms{this, "terms"}, y{this, "y"}, same{this, "same"}, total{this, "total"} {
    auto& gain = Add<Gain<double>>("gain", {.gain = 2});
    auto& sum = Add<Total>("sum");
    Connect(u, gain.u);
    Connect(u, sum.terms);
    Connect(terms, sum.terms);
    Connect(gain.y, y);
    Connect(u, same);
    Connect(sum.y, total);
  }
  Input<double> u;
  InputList<double> terms;
  Output<double> y, same, total;
};

/// y = 2 (u + 1), two levels deep.
class Middle final : public Composite {
 public:
  Middle() : u{this, "u"}, offset{this, "offset", {}, 1.0}, y{this, "y"}, same{this, "same"} {
    auto& sum = Add<Sum>("sum");
    inner = &Add<Inner>("inner");
    Connect(u, sum.a);
    Connect(offset, sum.b);
    Connect(sum.y, inner->u);
    Connect(inner->y, y);
    Connect(inner->same, same);
    Connect(offset, inner->terms);
    Connect(u, inner->terms);
  }
  Input<double> u, offset;
  Output<double> y, same;
  Inner* inner;
};

TEST(Composite, ExportsPortsThroughLevels) {
  DiagramBuilder b;
  auto& three = b.Add<Constant<double>>("three", {.value = 3});
  auto& middle = b.Add<Middle>("middle");
  auto& after = b.Add<Gain<double>>("after", {.gain = 10});
  b.Connect(three.y, middle.u);
  b.Connect(middle.y, after.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(after.y), 80);
  EXPECT_EQ(sim.Get(middle.y), 8);
  EXPECT_EQ(sim.Get(middle.same), 4);
  EXPECT_EQ(sim.Get(middle.inner->same), 4);
  EXPECT_EQ(sim.Get(middle.inner->total), 413);
  EXPECT_EQ(sim.context().rules_run(), 5u);  // as many as there are blocks with rules
  sim.Set(middle.offset, 2);
  EXPECT_EQ(sim.Get(after.y), 100);
}

TEST(Composite, IsListedBeforeItsParts) {
  DiagramBuilder b;
  auto& three = b.Add<Constant<double>>("three", {.value = 3});
  auto& middle = b.Add<Middle>("middle");
  b.Connect(three.y, middle.u);
  const Diagram diagram = b.Build();
  EXPECT_EQ(diagram.BlockPaths(),
            (std::vector<std::string>{"three", "middle", "middle.sum", "middle.inner",
                                      "middle.inner.gain", "middle.inner.sum"}));
  EXPECT_EQ(middle.inner->y.path(), "middle.inner.y");
}

/// A gain of 1 + 1e-3, `depth` levels down.
class Nested final : public Composite {
 public:
  explicit Nested(int depth) : u{this, "u"}, y{this, "y"} {
    if (depth == 0) {
      auto& gain = Add<Gain<double>>("gain", {.gain = 2});
      Connect(u, gain.u);
      Connect(gain.y, y);
    } else {
      auto& inner = Add<Nested>("n", depth - 1);
      Connect(u, inner.u);
      Connect(inner.y, y);
    }
  }
  Input<double> u;
  Output<double> y;
};

TEST(Composite, MayBeAThousandLevelsDeep) {
  DiagramBuilder b;
  auto& three = b.Add<Constant<double>>("three", {.value = 3});
  auto& nested = b.Add<Nested>("nested", 1000);
  b.Connect(three.y, nested.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_EQ(sim.Get(nested.y), 6);
  EXPECT_EQ(sim.context().rules_run(), 2u);
}

TEST(Composite, ChainsOfTenThousandBlocksRun) {
  constexpr int kBlocks = 10'000;
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  const Output<double>* last = &one.y;
  for (int i = 0; i < kBlocks; ++i) {
    auto& gain = b.Add<Gain<double>>("gain_" + std::to_string(i), {.gain = i % 2 == 0 ? 2.0 : 0.5});
    b.Connect(*last, gain.u);
    last = &gain.y;
  }
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.Set(one.value, 3);
  EXPECT_EQ(sim.Get(*last), 3);
  EXPECT_EQ(sim.context().rules_run(), kBlocks + 1u);
}

}  // namespace
}  // namespace pliant
