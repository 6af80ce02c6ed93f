#include "pliant/systems/context.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

const Joints kJoints{"shoulder", "elbow"};

struct Pair {
  Constant<JointVelocity>& one;
  Gain<JointVelocity>& gain;
  Diagram diagram;
};

Pair MakePair() {
  DiagramBuilder b;
  auto& one = b.Add<Constant<JointVelocity>>("one", {.space = kJoints, .value = {1.0, 2.0}});
  auto& gain = b.Add<Gain<JointVelocity>>("gain", {.space = kJoints, .gain = 2});
  b.Connect(one.y, gain.u);
  return {one, gain, b.Build()};
}

TEST(Context, CopiesAreIndependent) {
  const Pair p = MakePair();
  Context a = p.diagram.MakeContext();
  Context b = a;
  EXPECT_TRUE(a == b);
  b.Set(p.one.value, {5.0, 6.0});
  EXPECT_FALSE(a == b);
  EXPECT_EQ(a.Get(p.gain.y)(0), 2);
  EXPECT_EQ(b.Get(p.gain.y)(0), 10);
  a = b;
  EXPECT_TRUE(a == b);
  EXPECT_EQ(a.Get(p.gain.y)(0), 10);
}

TEST(Context, MovesAndSwaps) {
  const Pair p = MakePair();
  Context a = p.diagram.MakeContext(), b = p.diagram.MakeContext();
  b.Set(p.one.value, {5.0, 6.0});
  std::swap(a, b);
  EXPECT_EQ(a.Get(p.gain.y)(0), 10);
  EXPECT_EQ(b.Get(p.gain.y)(0), 2);
  Context c = std::move(a);
  a = c;
  EXPECT_EQ(a.Get(p.gain.y)(0), 10);
}

TEST(Context, IsComparedByStateAndNotByWhatFollows) {
  const Pair p = MakePair();
  Context a = p.diagram.MakeContext();
  const Context b = a;
  a.Get(p.gain.y);
  EXPECT_TRUE(a == b);
  a.Set(p.one.value, {1.0, -0.0});
  Context c = a;
  a.Set(p.one.value, {1.0, 0.0});
  EXPECT_FALSE(a == c);  // bit for bit
  const double nan = std::numeric_limits<double>::quiet_NaN();
  a.Set(p.one.value, {nan, nan});
  c = a;
  EXPECT_TRUE(a == c);
}

struct Opaque {
  std::vector<double> data;
};

TEST(Context, NamesATypeItCannotCompare) {
  DiagramBuilder b;
  b.Add<Constant<Opaque>>("opaque", {.value = {{1, 2}}});
  const Diagram diagram = b.Build();
  const Context x = diagram.MakeContext(), y = x;
  EXPECT_THAT(ErrorOf([&] { (void)(x == y); }), HasSubstr("cannot compare opaque.value : "));
}

TEST(Context, BelongsToItsDiagram) {
  const Pair p = MakePair(), q = MakePair();
  Context a = p.diagram.MakeContext(), b = q.diagram.MakeContext();
  EXPECT_FALSE(a == b);
  EXPECT_EQ(ErrorOf([&] { a = b; }), "a context is assigned from one of the same diagram");
  const std::string stranger =
      "gain.y is not a value of this diagram; build the diagram with its block, and read it "
      "through a context of that diagram";
  EXPECT_EQ(ErrorOf([&] { a.Get(q.gain.y); }), stranger);
  EXPECT_THAT(ErrorOf([&] { a.Set(q.one.value, {1.0, 2.0}); }), HasSubstr("one.value is not"));
  const Gain<JointVelocity> unbuilt({.space = kJoints, .gain = 2});
  EXPECT_THAT(ErrorOf([&] { a.Get(unbuilt.y); }), HasSubstr("y is not a value of this diagram"));
}

TEST(Context, RefusesToSetWhatFollows) {
  const Pair p = MakePair();
  Context a = p.diagram.MakeContext();
  EXPECT_EQ(ErrorOf([&] {
              a.Set(p.gain.u, {1.0, 2.0});
            }),
            "cannot set gain.u : joint velocity [rad/s] (shoulder, elbow): it is connected");
  EXPECT_EQ(ErrorOf([&] {
              a.Set(p.gain.y, {1.0, 2.0});
            }),
            "cannot set gain.y : joint velocity [rad/s] (shoulder, elbow): it follows from other "
            "values");
}

TEST(Context, RefusesVectorsOfAnotherSize) {
  const Pair p = MakePair();
  Context a = p.diagram.MakeContext();
  EXPECT_EQ(
      ErrorOf([&] {
        a.Set(p.one.value, {1.0, 2.0, 3.0});
      }),
      "cannot set one.value : joint velocity [rad/s] (shoulder, elbow): it has 2 numbers, got "
      "3");
}

/// Remembers in its workspace how often it ran; no result depends on it.
class Worker final : public Block {
 public:
  Worker() : u{this, "u", {}, 1.0}, y{this, "y"}, runs{this, "runs", 100} {
    Compute(y).From(u, runs).As([](double now, int& n) {
      ++n;
      return now;
    });
  }
  Input<double> u;
  Output<double> y;
  Scratch<int> runs;
};

TEST(Context, DoesNotCopyWorkspaces) {
  DiagramBuilder b;
  auto& worker = b.Add<Worker>("worker");
  const Diagram diagram = b.Build();
  Context a = diagram.MakeContext();
  a.Get(worker.y);
  Context c = a;
  EXPECT_EQ(a.Get(worker.runs), 101);
  EXPECT_EQ(c.Get(worker.runs), 100);
  EXPECT_TRUE(a == c);
  c = a;
  EXPECT_EQ(c.Get(worker.runs), 100);
  EXPECT_THAT(ErrorOf([&] { a.Set(worker.runs, 1); }), HasSubstr("it is a workspace"));
}

/// Throws when it is copied for the nth time, and counts those alive.
struct Fragile {
  static inline int alive = 0, copies_left = 1000;
  Fragile() { ++alive; }
  Fragile(const Fragile&) {
    if (copies_left-- == 0) throw std::runtime_error("no more copies");
    ++alive;
  }
  Fragile& operator=(const Fragile&) = default;
  ~Fragile() { --alive; }
};

TEST(Context, GivesBackWhatItMadeWhenACopyThrows) {
  DiagramBuilder b;
  for (const char* name : {"a", "b", "c"}) b.Add<Constant<Fragile>>(name, {.value = {}});
  const Diagram diagram = b.Build();
  const Context whole = diagram.MakeContext();
  const int alive = Fragile::alive;
  for (int n = 0; n < 6; ++n) {
    Fragile::copies_left = n;
    EXPECT_THROW(diagram.MakeContext(), std::runtime_error);
    EXPECT_EQ(Fragile::alive, alive);
    Fragile::copies_left = n;
    EXPECT_THROW(Context{whole}, std::runtime_error);
    EXPECT_EQ(Fragile::alive, alive);
  }
  Fragile::copies_left = 1000;
}

TEST(Context, OfADiagramWithoutBlocksHasATime) {
  DiagramBuilder b;
  const Diagram diagram = b.Build();
  Context a = diagram.MakeContext();
  EXPECT_EQ(a.time(), 0);
  EXPECT_TRUE(a == Context(a));
  Simulator sim{diagram};
  sim.AdvanceTo(2);
  EXPECT_EQ(sim.time(), 2);
}

}  // namespace
}  // namespace pliant
