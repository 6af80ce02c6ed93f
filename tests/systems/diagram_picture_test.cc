#include "pliant/systems/diagram_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <sstream>
#include <string>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/logger.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// One sampler inside a composite inside a composite.
class Inner final : public Composite {
 public:
  Inner() : u{this, "u"}, y{this, "y"} {
    auto& sampler = Add<Sampler>("sampler", {.period = 1ms});
    Connect(u, sampler.u);
    Connect(sampler.y, y);
  }
  Input<double> u;
  Output<double> y;
};
class Outer final : public Composite {
 public:
  Outer() : u{this, "u"}, y{this, "y"} {
    auto& inner = Add<Inner>("inner");
    auto& delay = Add<Delay>("delay", {.period = 5ms});
    Connect(u, inner.u);
    Connect(inner.y, delay.u);
    Connect(delay.y, y);
  }
  Input<double> u;
  Output<double> y;
};

/// A loop with a sum that one block feeds twice, and a logger.
DiagramStructure Example() {
  DiagramBuilder b;
  auto& torque =
      b.Add<Constant<JointTorque>>("torque", {.space = {"shoulder", "elbow"}, .value = {1.0, 2.0}});
  auto& gain = b.Add<Gain<JointTorque>>("gain", {.space = {"shoulder", "elbow"}, .gain = 2});
  auto& outer = b.Add<Outer>("outer");
  auto& sum = b.Add<Sum>("sum");
  auto& integral = b.Add<Integral>("integral");
  auto& logger = b.Add<Logger>("logger", {.capacity = 1});
  b.Connect(torque.y, gain.u);
  b.Connect(outer.y, sum.a);
  b.Connect(outer.y, sum.b);
  b.Connect(sum.y, integral.u);
  b.Connect(integral.y, outer.u);
  b.Connect(integral.y, logger.in);
  return DiagramStructure::Of(b.Build());
}

/// The lines of a picture that connect blocks.
std::string EdgesOf(const std::string& picture) {
  std::istringstream in(picture);
  std::string edges;
  for (std::string line; std::getline(in, line);)
    if (line.find(" -> ") != std::string::npos || line.find("-->") != std::string::npos ||
        line.find("==>") != std::string::npos)
      edges += line.substr(2, line.find(" [") - 2) + "\n";
  return edges;
}

TEST(GraphvizText, DrawsCompositesAsBoxesAndSeveralWiresAsOne) {
  const std::string picture = GraphvizText(Example());
  EXPECT_THAT(picture, HasSubstr("  subgraph cluster_b3 {\n    label=\"outer\""));
  EXPECT_THAT(picture, HasSubstr("    subgraph cluster_b4 {\n      label=\"inner\""));
  EXPECT_EQ(EdgesOf(picture), "b1 -> b2\nb8 -> b5\nb5 -> b6\nb6 -> b7\nb7 -> b8\n");
  EXPECT_THAT(picture, HasSubstr("b6 -> b7 [color=\"#D55E00\", penwidth=2.4"));
  EXPECT_THAT(picture, HasSubstr("tooltip=\"outer.delay.y → sum.a: double, 200 Hz\\n"
                                 "outer.delay.y → sum.b: double, 200 Hz\""));
}

TEST(GraphvizText, NamesTypeRateStateAndSignal) {
  const std::string picture = GraphvizText(Example());
  EXPECT_THAT(picture, HasSubstr("<b>torque</b>"));
  EXPECT_THAT(picture, HasSubstr("Constant&lt;JointTorque&gt;"));
  EXPECT_THAT(picture, HasSubstr(">continuous ∫<"));
  EXPECT_THAT(picture, HasSubstr(">200 Hz z⁻¹<"));
  EXPECT_THAT(picture, HasSubstr("joint torque [N·m]"));
}

TEST(GraphvizText, MakesOneBoxOfACompositeAtItsDepth) {
  const std::string two = GraphvizText(Example(), {.depth = 2});
  EXPECT_EQ(EdgesOf(two), "b1 -> b2\nb8 -> b4\nb4 -> b6\nb6 -> b7\nb7 -> b8\n");
  const std::string one = GraphvizText(Example(), {.depth = 1});
  EXPECT_THAT(one, Not(HasSubstr("subgraph")));
  EXPECT_EQ(EdgesOf(one), "b1 -> b2\nb8 -> b3\nb3 -> b7\nb7 -> b8\n");
  EXPECT_THAT(one, HasSubstr("1 kHz, 200 Hz z⁻¹"));  // of what is in the box
}

TEST(GraphvizText, LeavesOutRecordersAndUnwiredInputsUnlessAsked) {
  const std::string without = GraphvizText(Example());
  EXPECT_THAT(without, Not(HasSubstr("logger")));
  EXPECT_THAT(without, Not(HasSubstr("not wired</i>")));
  const std::string with = GraphvizText(Example(), {.inputs = true, .recorders = true});
  EXPECT_THAT(with, HasSubstr("<b>logger</b>"));
  EXPECT_THAT(EdgesOf(with), HasSubstr("b8 -> b9\n"));
  EXPECT_THAT(with, HasSubstr("value: not wired</i>"));
}

TEST(GraphvizText, ShowsCostsAndTheDearestBlockInFullColour) {
  const PictureOptions options{.costs = {{"outer.delay", 2e-6}, {"outer.inner.sampler", 1e-6}}};
  const std::string whole = GraphvizText(Example(), options);
  EXPECT_THAT(whole, HasSubstr("<b>2 µs</b>"));
  EXPECT_THAT(whole, HasSubstr("#FFB03A"));
  EXPECT_THAT(whole, HasSubstr("all blocks: 3 µs"));
  // What is inside is summed.
  EXPECT_THAT(GraphvizText(Example(), {.depth = 1, .costs = options.costs}),
              HasSubstr("<b>3 µs</b>"));
}

TEST(GraphvizText, IsTheSameEachTime) {
  EXPECT_EQ(GraphvizText(Example()), GraphvizText(Example()));
  EXPECT_EQ(MermaidText(Example()), MermaidText(Example()));
}

TEST(GraphvizText, DrawsACompositeThatHasRulesOfItsOwn) {
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
  const std::string picture = GraphvizText(DiagramStructure::Of(b.Build()));
  EXPECT_THAT(picture, HasSubstr("    b2 [label=\"its own rules\"];\n"));
  EXPECT_EQ(EdgesOf(picture), "b1 -> b2\nb2 -> b3\n");
}

/// The identifiers of a Mermaid picture are declared once, its boxes end, its labels are quoted.
void ExpectSound(const std::string& picture) {
  std::istringstream in(picture);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "flowchart LR");
  std::set<std::string> ids;
  int open = 0;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "end") {
      EXPECT_GE(--open, 0);
      continue;
    }
    if (word == "subgraph") {
      ++open;
      words >> word;
    }
    std::string text;  // between quotes
    const std::size_t quotes = static_cast<std::size_t>(std::ranges::count(line, '"'));
    EXPECT_TRUE(quotes == 0 || quotes == 2) << line;
    if (word == "style") continue;
    const std::string id = word.substr(0, word.find('['));
    EXPECT_TRUE(std::ranges::all_of(id, [](unsigned char c) { return std::isalnum(c) != 0; }))
        << line;
    if (word.find('[') != std::string::npos)
      EXPECT_TRUE(ids.insert(id).second) << line;
    else
      EXPECT_TRUE(ids.contains(id) && ids.contains(line.substr(line.rfind(' ') + 1))) << line;
  }
  EXPECT_EQ(open, 0);
}

TEST(MermaidText, IsSound) {
  ExpectSound(MermaidText(Example()));
  ExpectSound(MermaidText(Example(), {.depth = 1}));
  ExpectSound(MermaidText(Example(), {.inputs = true, .recorders = true}));
}

TEST(MermaidText, DrawsWhatGraphvizDoes) {
  EXPECT_EQ(EdgesOf(MermaidText(Example())),
            "b1 -- \"joint torque #91;N·m#93;\" --> b2\n"
            "b8 -- \"y\" --> b5\n"
            "b5 -- \"y\" --> b6\n"
            "b6 == \"y\" ==> b7\n"
            "b7 -- \"y\" --> b8\n");
  EXPECT_THAT(MermaidText(Example()),
              HasSubstr("  b1[\"torque<br/><small>Constant#60;JointTorque#62;<br/>constant</small>"
                        "\"]\n"));
}

TEST(MermaidText, QuotesNamesThatMermaidWouldReadOtherwise) {
  DiagramStructure odd;
  odd.blocks = {{.path = "end", .name = "end", .type = "A<\"x\">&#{}|;"},
                {.path = "_b", .name = "_b-1", .type = "`Code`"}};
  odd.wires = {
      {.from = 0, .to = 1, .output = "end.y", .input = "_b.u", .type = "a]\"-->b", .unit = "1/s²"}};
  const std::string picture = MermaidText(odd);
  ExpectSound(picture);
  EXPECT_THAT(picture, HasSubstr("A#60;#34;x#34;#62;#38;#35;#123;#125;#124;#59;"));
  EXPECT_THAT(GraphvizText(odd), HasSubstr("A&lt;&quot;x&quot;&gt;&amp;#{}|;"));
}

}  // namespace
}  // namespace pliant
