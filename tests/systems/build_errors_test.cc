#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::StartsWith;

const Joints kJoints{"shoulder", "elbow"};

using Filter = LowPass<JointVelocity>;
using Rest = Constant<JointVelocity>;
using Scale = Gain<double>;

TEST(Build, NamesEveryUnconnectedInput) {
  DiagramBuilder b;
  b.Add<Filter>("filter", {.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  b.Add<Scale>("gain", {.gain = 2});
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "input is not connected:\n"
            "  filter.u : joint velocity [rad/s] (shoulder, elbow)\n"
            "  gain.u : double\n"
            "connect an output to it, or give it a default");
}

TEST(Build, RefusesTwoWiresToOneInput) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& two = b.Add<Constant<double>>("two", {.value = 2});
  auto& gain = b.Add<Scale>("gain", {.gain = 2});
  b.Connect(one.y, gain.u);
  EXPECT_EQ(ErrorOf([&] { b.Connect(two.y, gain.u); }),
            "cannot connect: the port is connected already\n"
            "  from  one.y : double\n"
            "  and   two.y : double\n"
            "  to    gain.u : double\n"
            "remove one of the wires, or give the block an InputList");
}

TEST(Build, RefusesOtherSizes) {
  DiagramBuilder b;
  auto& rest = b.Add<Rest>("rest", {.space = {"elbow"}, .value = {0.0}});
  auto& filter = b.Add<Filter>("filter", {.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  EXPECT_EQ(ErrorOf([&] { b.Connect(rest.y, filter.u); }),
            "cannot connect: the ports have different sizes, 1 and 2\n"
            "  from  rest.y : joint velocity [rad/s] (elbow)\n"
            "  to    filter.u : joint velocity [rad/s] (shoulder, elbow)");
}

TEST(Build, RefusesJointsInAnotherOrder) {
  DiagramBuilder b;
  auto& rest = b.Add<Rest>("rest", {.space = {"elbow", "shoulder"}, .value = {0.0, 0.0}});
  auto& filter = b.Add<Filter>("filter", {.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  EXPECT_EQ(ErrorOf([&] { b.Connect(rest.y, filter.u); }),
            "cannot connect: the ports are about different joints\n"
            "  from  rest.y : joint velocity [rad/s] (elbow, shoulder)\n"
            "  to    filter.u : joint velocity [rad/s] (shoulder, elbow)");
}

TEST(Build, RefusesOtherFrames) {
  DiagramBuilder b;
  auto& twist = b.Add<Constant<Twist>>("twist", {.space = "tool", .value = {}});
  auto& gain = b.Add<Gain<Twist>>("gain", {.space = "base", .gain = 2});
  EXPECT_EQ(ErrorOf([&] { b.Connect(twist.y, gain.u); }),
            "cannot connect: the ports are about different frames\n"
            "  from  twist.y : twist [rad/s, m/s] in tool\n"
            "  to    gain.u : twist [rad/s, m/s] in base");
}

/// Passes u on and does not say which joints it is about.
class Vague final : public Composite {
 public:
  Vague() : u{this, "u"}, y{this, "y"} { Connect(u, y); }
  Input<JointVelocity> u;
  Output<JointVelocity> y;
};

TEST(Build, RefusesOtherJointsBehindPortsThatSayNothing) {
  DiagramBuilder b;
  auto& rest = b.Add<Rest>("rest", {.space = {"elbow", "shoulder"}, .value = {0.0, 0.0}});
  auto& vague = b.Add<Vague>("vague");
  auto& filter = b.Add<Filter>("filter", {.space = kJoints, .cutoff_hz = 5, .period = 1ms});
  b.Connect(rest.y, vague.u);
  b.Connect(vague.y, filter.u);
  EXPECT_THAT(ErrorOf([&] { b.Build(); }),
              StartsWith("cannot connect: the ports are about different joints\n  from  rest.y"));
}

TEST(Build, RefusesTwoBlocksOfOneName) {
  DiagramBuilder b;
  b.Add<Constant<double>>("one", {.value = 1});
  b.Add<Constant<double>>("one", {.value = 2});
  EXPECT_EQ(ErrorOf([&] { b.Build(); }), "two blocks are named 'one'; rename one of them");
}

TEST(Build, RefusesNamesThatSpoilPaths) {
  for (const std::string name : {"", "a.b", "a b", "a[0]", "\"", "a\n", "größe"}) {
    DiagramBuilder b;
    EXPECT_EQ(ErrorOf([&] { b.Add<Constant<double>>(name, {.value = 1}); }),
              "the name of a block has letters, digits, '_' and '-', got '" + name + "'");
  }
}

TEST(Build, PutsThePathBeforeErrorsOfConstructors) {
  DiagramBuilder b;
  EXPECT_EQ(
      ErrorOf([&] { b.Add<Filter>("filter", {.space = kJoints, .cutoff_hz = -3, .period = 1ms}); }),
      "filter: cutoff_hz must be > 0, got -3");
}

class Outer final : public Composite {
 public:
  Outer() { Add<Filter>("filter", {.space = kJoints, .cutoff_hz = -3, .period = 1ms}); }
};
class Outermost final : public Composite {
 public:
  Outermost() { Add<Outer>("outer"); }
};

TEST(Build, PutsTheWholePathBeforeErrorsOfNestedConstructors) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] { b.Add<Outermost>("all"); }),
            "all.outer.filter: cutoff_hz must be > 0, got -3");
}

TEST(Build, ListsAWholeAlgebraicLoop) {
  DiagramBuilder b;
  auto& a = b.Add<Scale>("a", {.gain = 2});
  auto& c = b.Add<Scale>("c", {.gain = 2});
  auto& d = b.Add<Scale>("d", {.gain = 2});
  auto& after = b.Add<Scale>("after", {.gain = 2});
  b.Connect(a.y, c.u);
  b.Connect(c.y, d.u);
  b.Connect(d.y, a.u);
  b.Connect(d.y, after.u);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "algebraic loop; let one of these rules read a Discrete value instead:\n"
            "  a.y  from  d.y\n"
            "  d.y  from  c.y\n"
            "  c.y  from  a.y");
}

TEST(Build, FindsALoopOfOneBlock) {
  DiagramBuilder b;
  auto& a = b.Add<Scale>("a", {.gain = 2});
  b.Connect(a.y, a.u);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "algebraic loop; let one of these rules read a Discrete value instead:\n"
            "  a.y  from  a.y");
}

TEST(Build, FindsALoopOfHeldOutputs) {
  DiagramBuilder b;
  auto& a = b.Add<Sampler>("a", {.period = 1ms});
  auto& c = b.Add<Sampler>("c", {.period = 2ms});
  b.Connect(a.y, c.u);
  b.Connect(c.y, a.u);
  EXPECT_THAT(ErrorOf([&] { b.Build(); }), StartsWith("algebraic loop"));
}

class Doubled final : public Composite {
 public:
  Doubled() : u{this, "u"}, y{this, "y"} {
    auto& gain = Add<Scale>("gain", {.gain = 2});
    Connect(u, gain.u);
    Connect(gain.y, y);
  }
  Input<double> u;
  Output<double> y;
};

TEST(Build, FindsALoopThroughComposites) {
  DiagramBuilder b;
  auto& left = b.Add<Doubled>("left");
  auto& right = b.Add<Doubled>("right");
  b.Connect(left.y, right.u);
  b.Connect(right.y, left.u);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "algebraic loop; let one of these rules read a Discrete value instead:\n"
            "  left.gain.y  from  right.gain.y\n"
            "  right.gain.y  from  left.gain.y");
}

TEST(Build, FindsALoopOfWiresAlone) {
  DiagramBuilder b;
  auto& vague = b.Add<Vague>("vague");
  b.Connect(vague.y, vague.u);
  EXPECT_THAT(ErrorOf([&] { b.Build(); }),
              StartsWith("algebraic loop; wires alone lead from this port back to it:\n  vague."));
}

TEST(Build, AllowsALoopThroughADelay) {
  DiagramBuilder b;
  auto& delay = b.Add<Delay>("delay", {.period = 1ms});
  auto& gain = b.Add<Scale>("gain", {.gain = 2});
  b.Connect(delay.y, gain.u);
  b.Connect(gain.y, delay.u);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }), "no error");
}

/// A block whose rules are declared by a function.
class Ruled final : public Block {
 public:
  explicit Ruled(void (*declare)(Ruled&)) : y{this, "y"}, x{this, "x"}, c{this, "c"}, g{this, "g"} {
    declare(*this);
  }
  using Block::AtEveryStep;
  using Block::AtStart;
  using Block::Compute;
  using Block::Derivative;
  using Block::Every;
  using Block::When;

  static double One() { return 1; }
  void RuleAll() {
    Compute(y).From().As(One);
    Compute(g).From().As(One);
    Derivative(c).From().As(One);
  }

  Output<double> y;
  Discrete<double> x;
  Continuous<double> c;
  Output<double> g;
};

std::string ErrorOfRules(void (*declare)(Ruled&)) {
  return ErrorOf([&] {
    DiagramBuilder b;
    b.Add<Ruled>("block", declare);
    b.Build();
  });
}

TEST(Build, RefusesAnOutputWithoutARule) {
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.Compute(r.g).From().As(Ruled::One);
              r.Derivative(r.c).From().As(Ruled::One);
            }),
            "output without a rule: block.y : double\n"
            "give it Compute(…).From(…).As(…) in the constructor of its block");
}

TEST(Build, RefusesAContinuousValueWithoutADerivative) {
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.Compute(r.y).From().As(Ruled::One);
              r.Compute(r.g).From().As(Ruled::One);
            }),
            "continuous value without a Derivative rule: block.c : double\n"
            "give it Derivative(…).From(…).As(…), or make it Discrete");
}

TEST(Build, RefusesAValueRuledTwice) {
  const std::string y = "a value is ruled twice: block.y : double\nkeep one of its rules";
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.RuleAll();
              r.Compute(r.y).From().As(Ruled::One);
            }),
            y);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.RuleAll();
              r.Every(1ms).Compute(r.y).From().As(Ruled::One);
            }),
            y);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.Every(1ms).Compute(r.y).From().As(Ruled::One);
              r.Every(2ms).Compute(r.y).From().As(Ruled::One);
            }),
            y);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.RuleAll();
              r.Derivative(r.c).From().As(Ruled::One);
            }),
            "a value is ruled twice: block.c : double\nkeep one of its rules");
}

TEST(Build, RefusesTwoUpdatesOfAValueByOneKindOfEvent) {
  const std::string x =
      "a value is ruled twice: block.x : double has two updates by the same kind of event; keep "
      "one of them";
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.Every(1ms).Update(r.x).From().As(Ruled::One);
              r.Every(2ms).Update(r.x).From().As(Ruled::One);
            }),
            x);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.AtStart().Update(r.x).From().As(Ruled::One);
              r.AtStart().Update(r.x).From().As(Ruled::One);
            }),
            x);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.When(r.g).Crosses(Direction::Rising).Update(r.x).From().As(Ruled::One);
              r.When(r.g).Crosses(Direction::Rising).Update(r.x).From().As(Ruled::One);
            }),
            x);
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.Every(1ms).Update(r.x, r.x).From().As([] { return std::tuple(1.0, 2.0); });
            }),
            x);
}

TEST(Build, AllowsUpdatesOfAValueByDifferentEvents) {
  EXPECT_EQ(ErrorOfRules([](Ruled& r) {
              r.RuleAll();
              r.AtStart().Update(r.x).From().As(Ruled::One);
              r.Every(1ms).Update(r.x).From().As(Ruled::One);
              r.When(r.g).Crosses(Direction::Rising).Update(r.x).From().As(Ruled::One);
              r.When(r.g).Crosses(Direction::Falling).Update(r.x).From().As(Ruled::One);
            }),
            "no error");
}

TEST(Build, RefusesUpdatesAtEveryStep) {
  EXPECT_THAT(ErrorOfRules([](Ruled& r) {
                r.RuleAll();
                r.AtEveryStep().Update(r.x).From().As(Ruled::One);
              }),
              StartsWith("block: AtEveryStep() publishes and does not update"));
}

TEST(Build, RefusesPeriodsThatAreNotPositive) {
  EXPECT_EQ(ErrorOfRules([](Ruled& r) { (void)r.Every(0ms); }),
            "block: a period must be > 0, got 0 s");
  EXPECT_EQ(ErrorOfRules([](Ruled& r) { (void)r.Every(-1ms); }),
            "block: a period must be > 0, got -1 ms");
  EXPECT_EQ(ErrorOfRules([](Ruled& r) { (void)r.Every(1ms, -1us); }),
            "block: an offset must be >= 0, got -1 us");
  EXPECT_EQ(ErrorOf([] { Hertz(0); }), "a rate must be > 0, got 0");
  EXPECT_EQ(ErrorOf([] { Hertz(-5); }), "a rate must be > 0, got -5");
}

/// Names a value of another block in a rule.
class Spy final : public Block {
 public:
  explicit Spy(const Output<double>& other) : y{this, "y"} {
    Compute(y).From(other).As([](double now) { return now; });
  }
  Output<double> y;
};

TEST(Build, RefusesARuleThatReadsAnotherBlock) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  EXPECT_EQ(ErrorOf([&] { b.Add<Spy>("spy", one.y); }),
            "spy: a rule reads and writes values of its own block, but 'y' belongs to another; "
            "connect an Input instead");
}

/// Rules its output by a function of another block.
class Thief final : public Block {
 public:
  Thief() : y{this, "y"} { Compute(y).From().As(&Thief::Other::Value); }
  struct Other : Block {
    double Value() const { return 1; }
  };
  Output<double> y;
};

TEST(Build, RefusesAFunctionOfAnotherBlock) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] { b.Add<Thief>("thief"); }),
            "thief: a rule is a member function of its own block, not of another");
}

class Twins final : public Block {
 public:
  Twins() : a{this, "a"}, b{this, "a"} {}
  Input<double> a, b;
};

TEST(Build, RefusesTwoValuesOfOneName) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] { b.Add<Twins>("twins"); }), "twins: two values are named 'a'");
}

TEST(Build, RefusesPortsOfOtherDiagrams) {
  DiagramBuilder b, other;
  auto& one = other.Add<Constant<double>>("one", {.value = 1});
  auto& gain = b.Add<Scale>("gain", {.gain = 2});
  EXPECT_EQ(ErrorOf([&] { b.Connect(one.y, gain.u); }),
            "cannot connect: one.y is not a port of this diagram or of a part of it\n"
            "  from  one.y : double\n"
            "  to    gain.u : double\n"
            "add its block to this diagram, or export the port of the inner one");
}

TEST(Build, RefusesMoreJointsThanFit) {
  EXPECT_EQ(ErrorOf([] { Joints::Numbered(kMaxJoints + 1); }),
            "a vector of joints has at most 32 elements; configure with -DPLIANT_MAX_JOINTS=… for "
            "more, got 33");
}

TEST(Build, RefusesValuesThatDoNotFitTheirJoints) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] {
              b.Add<Rest>("rest", {.space = kJoints, .value = {1, 2, 3}});
            }),
            "rest: the value of 'value' has a number for each of (shoulder, elbow), got 3");
}

TEST(Build, EmptiesTheBuilder) {
  DiagramBuilder b;
  b.Build();
  const std::string built = "the diagram is built already; start with a new DiagramBuilder";
  EXPECT_EQ(ErrorOf([&] { b.Build(); }), built);
  EXPECT_EQ(ErrorOf([&] { b.Add<Scale>("gain", {.gain = 2}); }), built);
}

}  // namespace
}  // namespace pliant
