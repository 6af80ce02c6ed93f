#include "pliant/systems/diagram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

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

Diagram MakeExample() {
  DiagramBuilder b;
  auto& torque =
      b.Add<Constant<JointTorque>>("torque", {.space = {"shoulder", "elbow"}, .value = {1.0, 2.0}});
  (void)torque;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& smoothed = b.Add<Smoothed>("smoothed");
  auto& integral = b.Add<Integral>("integral");
  b.Connect(one.y, smoothed.u);
  b.Connect(smoothed.y, integral.u);
  return b.Build();
}

TEST(Diagram, ListsItsBlocks) {
  EXPECT_THAT(MakeExample().BlockPaths(),
              ::testing::ElementsAre("torque", "one", "smoothed", "smoothed.gain",
                                     "smoothed.filter", "smoothed.loose", "integral"));
}

TEST(Diagram, ListsItsValuesWithKindTypeUnitAndSpace) {
  std::vector<std::string> lines;
  for (const ValueInfo& v : MakeExample().Values())
    lines.push_back(v.path + " | " + v.kind + " | " + v.type + " | " + v.unit + " | " + v.space);
  EXPECT_THAT(lines, ::testing::IsSupersetOf(std::vector<std::string>{
                         "torque.value | input | joint torque | N·m | (shoulder, elbow)",
                         "torque.y | output | joint torque | N·m | (shoulder, elbow)",
                         "smoothed.filter.y | held output | double |  | ",
                         "smoothed.y | held output | double |  | ",
                         "integral.x | continuous | double |  | "}));
}

TEST(Diagram, IsDrawnForGraphviz) {
  EXPECT_EQ(MakeExample().Graphviz(),
            R"(digraph diagram {
  rankdir=LR;
  node [shape=box, style=rounded, fontname="sans-serif"];
  edge [fontname="sans-serif", fontsize=9];
  b1 [label="torque"];
  b2 [label="one"];
  subgraph cluster_b3 {
    label="smoothed";
    b4 [label="gain"];
    b5 [label="filter"];
    b6 [label="loose"];
  }
  b7 [label="integral"];
  b2 -> b4 [taillabel="y", headlabel="u"];
  b4 -> b5 [taillabel="y", headlabel="u"];
  b5 -> b7 [taillabel="y", headlabel="u"];
}
)");
}

TEST(Diagram, IsDrawnForMermaid) {
  EXPECT_EQ(MakeExample().Mermaid(),
            R"(flowchart LR
  b1["torque"]
  b2["one"]
  subgraph b3["smoothed"]
    b4["gain"]
    b5["filter"]
    b6["loose"]
  end
  b7["integral"]
  b2 -- "y → u" --> b4
  b4 -- "y → u" --> b5
  b5 -- "y → u" --> b7
)");
}

TEST(Diagram, IsDrawnWithAWireForEachMemberOfAList) {
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
  const std::string picture = b.Build().Mermaid();
  EXPECT_THAT(picture, HasSubstr("  b2 -- \"y → all\" --> b3\n  b1 -- \"y → all\" --> b3\n"));
}

TEST(Diagram, WithoutBlocksIsEmpty) {
  DiagramBuilder b;
  const Diagram diagram = b.Build();
  EXPECT_TRUE(diagram.BlockPaths().empty());
  EXPECT_TRUE(diagram.Values().empty());
  EXPECT_EQ(diagram.Mermaid(), "flowchart LR\n");
  EXPECT_EQ(diagram.MakeContext().state().size(), 0u);
}

}  // namespace
}  // namespace pliant
