#include "pliant/systems/logger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;

const Joints kJoints{"shoulder", "elbow"};

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

std::string Contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::filesystem::path NewFile(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / name;
  std::filesystem::remove(file);
  return file;
}

TEST(Logger, NamesColumnsByPathElementAndUnit) {
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kJoints, .value = {1, 2}});
  auto& twist = b.Add<Constant<Twist>>("twist", {.space = "tool", .value = {0, 0, 0, 0, 0, 0}});
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& gain = b.Add<Constant<PerJoint>>("gain", {.space = kJoints, .value = PerJoint::Ones(2)});
  auto& flag = b.Add<Constant<bool>>("flag", {.value = true});
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(torque.y, logger.in);
  b.Connect(gain.y, logger.in);
  b.Connect(flag.y, logger.in);
  b.Connect(twist.y, logger.in);
  b.Connect(pose.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};

  const std::vector<std::string>& names = sim.Get(logger.log).columns();
  ASSERT_EQ(names.size(), 2u + 2u + 1u + 6u + 12u);
  EXPECT_THAT(std::vector(names.begin(), names.begin() + 6),
              ElementsAre("torque.y[shoulder] (N·m)", "torque.y[elbow] (N·m)", "gain.y[shoulder]",
                          "gain.y[elbow]", "flag.y", "twist.y[wx] (rad/s)"));
  EXPECT_EQ(names[10], "twist.y[vz] (m/s)");
  EXPECT_EQ(names[13], "pose.y.position[z] (m)");
  EXPECT_EQ(names[14], "pose.y.rotation[0,0]");
}

TEST(Logger, RecordsTheInstantOfATick) {
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& logger = b.Add<Logger>("logger", {.period = 2ms, .capacity = 10});
  b.Connect(decay.x, logger.in);
  b.Connect(decay.n, logger.in);
  b.Connect(decay.twice, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.0061);

  const Log& log = sim.Get(logger.log);
  ASSERT_EQ(log.rows(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(log.times()(i), 2 * i / 1e3);
    EXPECT_NEAR(log["decay.x"](i), std::exp(-2e-3 * i),
                1e-6);                        // default tolerance of the integrator
    EXPECT_EQ(log["decay.n"](i), 2 * i);      // before the update of this tick
    EXPECT_EQ(log["decay.twice"](i), 4 * i);  // computed at this tick
  }
}

TEST(Logger, RecordsTheStartAndEveryStepOfTheIntegrator) {
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& logger = b.Add<Logger>("logger", {});
  b.Connect(decay.x, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);

  const Log& log = sim.Get(logger.log);
  ASSERT_GT(log.rows(), 2u);
  EXPECT_EQ(log.times()(0), 0);
  for (Eigen::Index i = 1; i < static_cast<Eigen::Index>(log.rows()); ++i) {
    EXPECT_GT(log.times()(i), log.times()(i - 1));
    EXPECT_NEAR(log["decay.x"](i), std::exp(-log.times()(i)), 1e-5);
  }
}

TEST(Logger, AllocatesNothingUpToItsCapacity) {
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kJoints, .value = {1, 2}});
  auto& logger = b.Add<Logger>("logger", {.period = 1ms, .capacity = 100});
  b.Connect(torque.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const long before = Allocations();
  sim.AdvanceTo(0.1);
  EXPECT_EQ(Allocations(), before);
  EXPECT_EQ(sim.Get(logger.log).rows(), 100u);
  sim.AdvanceTo(0.2);
  EXPECT_EQ(sim.Get(logger.log).rows(), 200u);
}

TEST(Logger, WritesOverTheLaterRowsOfARestoredRun) {
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay");
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(decay.x, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.005);
  const Context snapshot = sim.Snapshot();
  sim.AdvanceTo(0.01);
  const Log first = sim.Get(logger.log);
  sim.Restore(snapshot);
  sim.AdvanceTo(0.01);
  const Log& second = sim.Get(logger.log);
  ASSERT_EQ(second.rows(), 10u);
  EXPECT_EQ(second.times(), first.times());
  EXPECT_EQ(second["decay.x"], first["decay.x"]);
}

TEST(Logger, NamesACompositesPortAsItWasConnected) {
  class Station final : public Composite {
   public:
    Station() : u{this, "u"}, y{this, "y"} {
      auto& gain = Add<Gain<double>>("gain", {.gain = 2});
      Connect(u, gain.u);
      Connect(gain.y, y);
    }
    Input<double> u;
    Output<double> y;
  };
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& station = b.Add<Station>("station");
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(one.y, station.u);
  b.Connect(station.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.001);
  EXPECT_EQ(sim.Get(logger.log)["station.y"](0), 2);
}

TEST(Logger, FindsAColumnWithItsUnitAndWithout) {
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = kJoints, .value = {1, 2}});
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(torque.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.001);
  const Log& log = sim.Get(logger.log);
  EXPECT_EQ(log["torque.y[elbow]"](0), 2);
  EXPECT_EQ(log["torque.y[elbow] (N·m)"](0), 2);
  EXPECT_EQ(ErrorOf([&] { log["torque.y[elbo]"]; }),
            "the log has no column 'torque.y[elbo]'; did you mean 'torque.y[elbow] (N·m)'?");
}

TEST(Logger, RefusesAValueThatIsNotMadeOfNumbers) {
  DiagramBuilder b;
  auto& source = b.Add<OpaqueSource>("source");
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(source.y, logger.in);
  EXPECT_EQ(
      ErrorOf([&] { b.Build(); }),
      "logger: cannot log source.y : pliant::(anonymous namespace)::Opaque, which is not made "
      "of numbers\ngive its type a function template Fields");
}

TEST(Logger, RefusesAVectorOfUnknownSize) {
  DiagramBuilder b;
  auto& source = b.Add<Constant<PerJoint>>("source", {.value = PerJoint::Ones(2)});
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(source.y, logger.in);
  EXPECT_EQ(ErrorOf([&] { b.Build(); }),
            "logger: cannot log source.y : number per joint, which has no elements yet\n"
            "give its port a space or an initial value");
}

TEST(Logger, RecordsNanForAValueThatChangedItsShape) {
  DiagramBuilder b;
  auto& source = b.Add<Shrinking>("source");
  auto& logger = b.Add<Logger>("logger", {.period = 1ms});
  b.Connect(source.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.001);
  EXPECT_TRUE(std::isnan(sim.Get(logger.log)["source.y[0]"](0)));
}

TEST(Logger, WritesCsvThatReadsBackExactly) {
  DiagramBuilder b;
  auto& value = b.Add<Constant<double>>("value", {.value = 0.1 + 0.2});
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& logger = b.Add<Logger>("logger", {.period = Hertz(3)});
  b.Connect(value.y, logger.in);
  b.Connect(pose.y, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);
  const std::filesystem::path file = NewFile("log.csv");
  sim.Get(logger.log).WriteCsv(file);
  EXPECT_EQ(Contents(file),
            "time (s),value.y,pose.y.position[x] (m),pose.y.position[y] (m),pose.y.position[z] (m),"
            "\"pose.y.rotation[0,0]\",\"pose.y.rotation[1,0]\",\"pose.y.rotation[2,0]\","
            "\"pose.y.rotation[0,1]\",\"pose.y.rotation[1,1]\",\"pose.y.rotation[2,1]\","
            "\"pose.y.rotation[0,2]\",\"pose.y.rotation[1,2]\",\"pose.y.rotation[2,2]\"\n"
            "0,0.30000000000000004,0,0,0,1,0,0,0,1,0,0,0,1\n"
            "0.333333333,0.30000000000000004,0,0,0,1,0,0,0,1,0,0,0,1\n");
}

TEST(Logger, LeavesAnOlderFileWhenWritingFails) {
  const std::filesystem::path folder = NewFile("log_folder.csv");
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "kept") << "older";
  const Log log;
  EXPECT_THAT(ErrorOf([&] { log.WriteCsv(folder); }),
              ::testing::StartsWith("cannot write the log " + folder.string() + ": "));
  EXPECT_FALSE(std::filesystem::exists(folder.string() + ".part"));
  EXPECT_EQ(Contents(folder / "kept"), "older");
  std::filesystem::remove_all(folder);
  EXPECT_EQ(
      ErrorOf([&] { log.WriteCsv(folder / "log.csv"); }),
      "cannot write the log " + (folder / "log.csv").string() + ": No such file or directory");
}

}  // namespace
}  // namespace pliant
