#include "pliant/systems/diagram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pliant/systems/constant.h"
#include "pliant/systems/diagram_picture.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

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

TEST(Diagram, IsDrawn) {
  const Diagram diagram = MakeExample();
  const DiagramStructure structure = DiagramStructure::Of(diagram);
  EXPECT_EQ(diagram.Graphviz(), GraphvizText(structure));
  EXPECT_EQ(diagram.Mermaid(), MermaidText(structure));
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
