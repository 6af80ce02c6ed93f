#include "pliant/systems/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;

const Joints kJoints{"shoulder", "elbow"};

/// Keeps rows in memory, without allocation up to a thousand; drops every `drops_each`-th.
class Memory final : public RecordSink {
 public:
  struct Row {
    int stream;
    std::int64_t time_ns;
    std::array<double, 16> numbers;
  };

  explicit Memory(int drops_each = 0) : drops_each_{drops_each} { rows.reserve(1000); }

  int Open(std::vector<RecordedValue> values) override {
    opened.push_back(std::move(values));
    return static_cast<int>(opened.size()) - 1;
  }
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override {
    if (drops_each_ > 0 && ++begun_ % drops_each_ == 0) return {};
    std::size_t n = 0;
    for (const RecordedValue& value : opened[static_cast<std::size_t>(stream)])
      n += value.elements.size();
    rows.push_back({stream, time_ns, {}});
    return std::span(rows.back().numbers).first(n);
  }
  void Commit() noexcept override { ++committed; }

  std::vector<std::vector<RecordedValue>> opened;
  std::vector<Row> rows;
  std::size_t committed = 0;

 private:
  const int drops_each_;
  int begun_ = 0;
};

/// ẋ = −x from 1, and n = number of ticks of 1 ms before this one.
class Decay final : public Block {
 public:
  Decay() : x{this, "x", {}, 1.0}, n{this, "n"}, twice{this, "twice"} {
    Derivative(x).From(x).As([](double now) { return -now; });
    Every(1ms).Update(n).From(n).As([](int k) { return k + 1; });
    Every(1ms).Compute(twice).From(n).As([](int k) { return 2.0 * k; });
  }
  Continuous<double> x;
  Discrete<int> n;
  Output<double> twice;
};

struct Opaque {
  bool operator==(const Opaque&) const = default;
};
class OpaqueSource final : public Block {
 public:
  OpaqueSource() : y{this, "y"} {
    Compute(y).From(clock).As([](double) { return Opaque{}; });
  }
  Output<Opaque> y;
};

/// A vector that is two long until its first tick, and then one.
class Shrinking final : public Block {
 public:
  Shrinking() : y{this, "y", {}, PerJoint::Zero(2)} {
    Every(1ms).Compute(y).From(clock).As([](double) { return PerJoint(PerJoint::Ones(1)); });
  }
  Output<PerJoint> y;
};

TEST(Recorder, OpensItsSinkOnceWithWhatIsWired) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kJoints, .value = {1, 2}});
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& flag = b.Add<Constant<bool>>("flag", {.value = true});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink});
  b.Connect(torque.y, recorder.in);
  b.Connect(flag.y, recorder.in);
  b.Connect(pose.y, recorder.in);
  EXPECT_TRUE(sink->opened.empty());
  const Diagram diagram = b.Build();
  Simulator one{diagram}, other{diagram};
  one.AdvanceTo(0.01);

  ASSERT_EQ(sink->opened.size(), 1u);
  const std::vector<RecordedValue>& values = sink->opened[0];
  ASSERT_EQ(values.size(), 3u);
  EXPECT_EQ(values[0], (RecordedValue{.path = "torque.y",
                                      .type = "joint torque",
                                      .elements = {"[shoulder]", "[elbow]"},
                                      .units = {"N·m", "N·m"}}));
  EXPECT_EQ(values[1],
            (RecordedValue{.path = "flag.y", .type = "bool", .elements = {""}, .units = {""}}));
  EXPECT_EQ(values[2].type, "pose");
  EXPECT_EQ(values[2].elements[2], ".position[z]");
  EXPECT_EQ(values[2].units[2], "m");
  EXPECT_EQ(values[2].elements[11], ".rotation[2,2]");
}

/// Three levels above a constant, of which none exports it.
class Within final : public Composite {
 public:
  explicit Within(int levels) {
    if (levels > 0)
      part = Add<Within>("part", levels - 1).part;
    else
      part = &Add<Constant<double>>("seven", {.value = 7}).y;
  }
  const Output<double>* part;
};

TEST(Recorder, LooksAtAnyPartOfAPart) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b, other;
  auto& within = b.Add<Within>("within", 2);
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink});
  b.Connect(*within.part, recorder.in);
  EXPECT_THAT(ErrorOf([&] { b.Connect(*other.Add<Within>("else", 2).part, recorder.in); }),
              testing::StartsWith("cannot connect: else.part.part.seven.y is not a port of this "
                                  "diagram or of a part of it"));
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0005);
  ASSERT_EQ(sink->opened.at(0).size(), 1u);
  EXPECT_EQ(sink->opened[0][0].path, "within.part.part.seven.y");
  EXPECT_EQ(sink->rows.at(0).numbers[0], 7);
}

TEST(Recorder, HandsOnTheInstantOfATick) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& recorder = b.Add<Recorder>("recorder", {.period = 2ms, .sink = sink});
  b.Connect(decay.x, recorder.in);
  b.Connect(decay.n, recorder.in);
  b.Connect(decay.twice, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0061);

  ASSERT_EQ(sink->rows.size(), 4u);
  EXPECT_EQ(sink->committed, 4u);
  for (int i = 0; i < 4; ++i) {
    const Memory::Row& row = sink->rows[static_cast<std::size_t>(i)];
    EXPECT_EQ(row.time_ns, i * 2'000'000);
    EXPECT_NEAR(row.numbers[0], std::exp(-2e-3 * i), 1e-6);  // default tolerance of the integrator
    EXPECT_EQ(row.numbers[1], 2 * i);                        // before the update of this tick
    EXPECT_EQ(row.numbers[2], 4 * i);                        // computed at this tick
  }
}

TEST(Recorder, HandsOnWhatALoggerLogsAtEveryStepOfTheIntegrator) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& logger = b.Add<Logger>("logger", {});
  auto& recorder = b.Add<Recorder>("recorder", {.sink = sink});
  b.Connect(decay.x, logger.in);
  b.Connect(decay.x, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.1);

  const Log& log = sim.Get(logger.log);
  ASSERT_GT(log.rows(), 2u);
  ASSERT_EQ(sink->rows.size(), log.rows());
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(1e-9 * static_cast<double>(sink->rows[i].time_ns), log.times()(at), 0.5e-9 + 1e-15);
    EXPECT_EQ(sink->rows[i].numbers[0], log["decay.x"](at));
  }
}

TEST(Recorder, TellsTimesToTheNanosecond) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& recorder = b.Add<Recorder>("recorder", {.period = Hertz(30), .sink = sink});
  b.Connect(one.y, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(30);
  ASSERT_EQ(sink->rows.size(), 900u);
  for (std::int64_t k = 0; k < 900; ++k)
    EXPECT_EQ(sink->rows[static_cast<std::size_t>(k)].time_ns, k * 1'000'000'000 / 30);
}

TEST(Recorder, SharesASinkWithOthersByNumbersOfStreams) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& two = b.Add<Constant<JointTorque>>("two", {.space = kJoints, .value = {2, 3}});
  auto& fast = b.Add<Recorder>("fast", {.period = 1ms, .sink = sink});
  auto& slow = b.Add<Recorder>("slow", {.period = 2ms, .sink = sink});
  b.Connect(one.y, fast.in);
  b.Connect(two.y, slow.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.003);
  std::vector<int> streams;
  for (const Memory::Row& row : sink->rows) {
    streams.push_back(row.stream);
    EXPECT_EQ(row.numbers[0], row.stream == 0 ? 1 : 2);
  }
  EXPECT_THAT(streams, ElementsAre(0, 1, 0, 0, 1));
}

TEST(Recorder, LeavesARowThatTheSinkDrops) {
  const auto sink = std::make_shared<Memory>(2);
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink});
  b.Connect(decay.n, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.01);
  ASSERT_EQ(sink->rows.size(), 5u);
  EXPECT_EQ(sink->committed, 5u);
  EXPECT_EQ(sink->rows[4].numbers[0], 8);
}

TEST(Recorder, AllocatesNothingInATick) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kJoints, .value = {1, 2}});
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink});
  b.Connect(torque.y, recorder.in);
  b.Connect(pose.y, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const long before = Allocations();
  sim.AdvanceTo(0.1);
  EXPECT_EQ(Allocations(), before);
  EXPECT_EQ(sink->rows.size(), 100u);
}

TEST(Recorder, HandsOnNanForAValueThatChangedItsShape) {
  const auto sink = std::make_shared<Memory>();
  DiagramBuilder b;
  auto& source = b.Add<Shrinking>("source");
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink});
  b.Connect(source.y, recorder.in);
  b.Connect(one.y, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.001);
  ASSERT_EQ(sink->rows.size(), 1u);
  EXPECT_TRUE(std::isnan(sink->rows[0].numbers[0]));
  EXPECT_TRUE(std::isnan(sink->rows[0].numbers[1]));
  EXPECT_EQ(sink->rows[0].numbers[2], 1);
}

TEST(Recorder, RefusesAValueThatIsNotMadeOfNumbers) {
  DiagramBuilder b;
  auto& source = b.Add<OpaqueSource>("source");
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = std::make_shared<Memory>()});
  b.Connect(source.y, recorder.in);
  EXPECT_EQ(
      ErrorOf([&] { b.Build(); }),
      "recorder: cannot log source.y : pliant::(anonymous namespace)::Opaque, which is not made "
      "of numbers\ngive its type a function template Fields");
}

TEST(Recorder, RefusesAVectorOfUnknownSize) {
  DiagramBuilder b;
  auto& source = b.Add<Constant<PerJoint>>("source", {.value = PerJoint::Ones(2)});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = std::make_shared<Memory>()});
  b.Connect(source.y, recorder.in);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "recorder: cannot log source.y : number per joint, which has no elements yet\n"
            "give its port a space or an initial value");
}

TEST(Recorder, NeedsASink) {
  DiagramBuilder b;
  EXPECT_EQ(ErrorOf([&] { b.Add<Recorder>("recorder", {.period = 1ms, .sink = nullptr}); }),
            "recorder: sink must be given");
}

}  // namespace
}  // namespace pliant
