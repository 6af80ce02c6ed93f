#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

fs::path NewFile(const std::string& name) {
  const fs::path file = fs::path(::testing::TempDir()) / ("snapshot_test_" + name);
  fs::remove_all(file);
  return file;
}

std::string Contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A swinging mass that is kicked whenever it comes back: ẋ = v, v̇ = u − sin x.
class Swing final : public Block {
 public:
  Swing()
      : u{this, "u"},
        angle{this, "angle"},
        x{this, "x", {}, 1.0},
        v{this, "v"},
        kicks{this, "kicks"} {
    Derivative(x).From(v).As([](double now) { return now; });
    Derivative(v).From(x, u).As(
        [](double angle_now, double push) { return push - 9.81 * std::sin(angle_now); });
    Compute(angle).From(x).As([](double now) { return now; });
    const auto back = When(angle).Crosses(Direction::Falling);
    back.Update(v).From(v).As([](double now) { return 1.01 * now; });
    back.Update(kicks).From(kicks).As([](int n) { return n + 1; });
  }
  Input<double> u;
  Output<double> angle;
  Continuous<double> x, v;
  Discrete<int> kicks;
};

struct Loop {
  Swing& swing;
  LowPass<double>& filter;
  Diagram diagram;
};

Loop MakeLoop(Duration period = 7ms) {
  DiagramBuilder b;
  auto& swing = b.Add<Swing>("swing");
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 3, .period = period});
  auto& delay = b.Add<Delay>("delay", {.period = Hertz(30), .initial = 0.5});
  b.Connect(swing.angle, filter.u);
  b.Connect(filter.y, delay.u);
  b.Connect(delay.y, swing.u);
  return {swing, filter, b.Build()};
}

const std::vector<IntegratorOptions> kIntegrators{
    {.method = Method::kHeunEuler, .relative_tolerance = 1e-4},
    {.method = Method::kBogackiShampine},
    {.method = Method::kZonneveld},
    {.method = Method::kSayfyAburub},
    {.method = Method::kCashKarp},
    {.method = Method::kFehlberg},
    {.method = Method::kDormandPrince},
    {.method = Method::kSdirk},
    {.method = Method::kAdams},
    {.method = Method::kBdf},
    {.method = Method::kBogackiShampine, .fixed_step_s = 3e-3}};

TEST(Snapshot, ResumesFromAFileBitForBit) {
  for (const IntegratorOptions& integrator : kIntegrators) {
    const fs::path file = NewFile("resume");
    const Loop loop = MakeLoop();
    Simulator sim{loop.diagram, {.integrator = integrator}};
    sim.AdvanceTo(0.9373);  // in mid-step, between ticks
    sim.Save(file);
    sim.AdvanceTo(2.5);
    const Context end = sim.Snapshot();
    ASSERT_GE(sim.Get(loop.swing.kicks), 1);

    const Loop again = MakeLoop();
    Simulator resumed{again.diagram, {.integrator = integrator}};
    resumed.Restore(file);
    EXPECT_EQ(resumed.time(), 0.9373);
    resumed.AdvanceTo(2.5);
    EXPECT_EQ(resumed.Get(again.swing.x), sim.Get(loop.swing.x)) << Name(integrator.method);
    EXPECT_EQ(resumed.Get(again.swing.v), sim.Get(loop.swing.v)) << Name(integrator.method);
    EXPECT_EQ(resumed.Get(again.filter.y), sim.Get(loop.filter.y)) << Name(integrator.method);

    sim.Restore(file);
    sim.AdvanceTo(2.5);
    EXPECT_TRUE(sim.Snapshot() == end) << Name(integrator.method);
  }
}

TEST(Snapshot, InMemoryResumesBitForBit) {
  for (const IntegratorOptions& integrator : kIntegrators)
    for (const double at : {0.0, 0.1234, 0.007, 0.8}) {
      const Loop loop = MakeLoop();
      Simulator sim{loop.diagram, {.integrator = integrator}};
      sim.AdvanceTo(at);
      const Context start = sim.Snapshot();
      sim.AdvanceTo(1.5);
      const Context end = sim.Snapshot();
      sim.Restore(start);
      EXPECT_TRUE(sim.context() == start);
      sim.AdvanceTo(1.5);
      EXPECT_TRUE(sim.Snapshot() == end) << Name(integrator.method) << " from " << at;
    }
}

TEST(Snapshot, IsRefusedByAnotherDiagram) {
  const fs::path file = NewFile("other");
  const Loop loop = MakeLoop(), other = MakeLoop(8ms);
  Simulator sim{loop.diagram}, stranger{other.diagram};
  sim.Save(file);
  EXPECT_EQ(ErrorOf([&] { stranger.Restore(file); }),
            "cannot restore from " + file.string() +
                ": it was taken of another diagram; build the diagram it was taken of");
}

TEST(Snapshot, IsRefusedWhenItIsCutOffOrDamaged) {
  const fs::path file = NewFile("damaged");
  const Loop loop = MakeLoop();
  Simulator sim{loop.diagram};
  sim.AdvanceTo(0.5);
  sim.Save(file);
  const Context before = sim.Snapshot();
  const std::string whole = Contents(file);
  for (std::size_t n = 0; n < whole.size(); n += 5) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, n);
    ASSERT_THAT(ErrorOf([&] { sim.Restore(file); }), HasSubstr("cannot restore from")) << n;
    std::string flipped = whole;
    flipped[n] = static_cast<char>(flipped[n] ^ 4);
    std::ofstream(file, std::ios::binary) << flipped;
    ASSERT_THAT(ErrorOf([&] { sim.Restore(file); }), HasSubstr("cannot restore from")) << n;
  }
  std::ofstream(file, std::ios::binary) << whole << 'x';
  EXPECT_THAT(ErrorOf([&] { sim.Restore(file); }), HasSubstr("cut off or damaged"));
  EXPECT_TRUE(sim.context() == before);
}

TEST(Snapshot, NamesAFileThatIsNotThere) {
  const fs::path file = NewFile("missing");
  const Loop loop = MakeLoop();
  Simulator sim{loop.diagram};
  EXPECT_EQ(ErrorOf([&] { sim.Restore(file); }),
            "cannot read the snapshot " + file.string() + ": No such file or directory");
}

struct Opaque {
  std::string text;
};

TEST(Snapshot, NamesATypeItCannotWrite) {
  const fs::path file = NewFile("opaque");
  DiagramBuilder b;
  b.Add<Constant<Opaque>>("opaque", {.value = {"x"}});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  EXPECT_THAT(ErrorOf([&] { sim.Save(file); }), HasSubstr("cannot save opaque.value : "));
  EXPECT_THAT(ErrorOf([&] { sim.Save(file); }), HasSubstr("function template Fields"));
  EXPECT_FALSE(fs::exists(file));
}

TEST(Snapshot, ThatCannotBeWrittenLeavesTheOldFile) {
  const fs::path folder = NewFile("folder");
  fs::create_directory(folder);
  const Loop loop = MakeLoop();
  Simulator sim{loop.diagram};
  const fs::path nowhere = folder / "none" / "file";
  EXPECT_EQ(ErrorOf([&] { sim.Save(nowhere); }),
            "cannot write the snapshot " + nowhere.string() + ": No such file or directory");

  const fs::path file = folder / "file";
  sim.Save(file);
  const std::string old = Contents(file);
  sim.AdvanceTo(0.5);
  fs::create_directory(fs::path(file) += ".part");  // in the way of the new one
  EXPECT_THAT(ErrorOf([&] { sim.Save(file); }), HasSubstr("cannot write the snapshot"));
  EXPECT_EQ(Contents(file), old);
}

}  // namespace
}  // namespace pliant
