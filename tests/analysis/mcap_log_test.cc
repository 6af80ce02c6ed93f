#include "pliant/analysis/mcap_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include "pliant/systems/constant.h"
#include "pliant/systems/recorder.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/analysis/mcap/mcap_scan.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/mcap_bytes.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::StartsWith;
using WallClock = std::chrono::steady_clock;

const RecordedValue kCount{"count", "double", {""}, {""}};

RecordedValue Wide(int n) {
  RecordedValue value{"wide", "double", {}, {}};
  for (int i = 0; i < n; ++i) value.elements.push_back("[" + std::to_string(i) + "]");
  value.units.resize(value.elements.size());
  return value;
}

constexpr std::int64_t kMillisecond = 1'000'000;

/// Rows of 1 ms from the `first`-th on, of its number; as many as found room.
int Count(McapLog& log, int stream, int rows, int first = 0) {
  int written = 0;
  for (int k = first; k < first + rows; ++k)
    if (const std::span<double> row = log.Begin(stream, k * kMillisecond); !row.empty()) {
      std::ranges::fill(row, k);
      log.Commit();
      ++written;
    }
  return written;
}

class McapLogTest : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return directory_.path() / "run.mcap"; }
  McapScan Scan() const { return McapScan(ReadText(file())); }

  TemporaryDirectory directory_;
};

TEST_F(McapLogTest, HoldsAMessageForEachValueAtEachTick) {
  const auto log = std::make_shared<McapLog>(
      McapLog::Options{.file = file(), .metadata = {{"pliant", {{"seed", "7"}}}}});
  const Joints joints{"shoulder", "elbow"};
  DiagramBuilder b;
  auto& torque = b.Add<Constant<JointTorque>>("torque", {.space = joints, .value = {1, -2}});
  auto& flag = b.Add<Constant<bool>>("flag", {.value = true});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = log});
  b.Connect(torque.y, recorder.in);
  b.Connect(flag.y, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.01);
  log->Close();

  const McapScan scan = Scan();
  EXPECT_TRUE(scan.whole);
  EXPECT_EQ(scan.topics.size(), 2u);
  const McapScan::Channel& topic = scan.topics.at("/torque/y");
  EXPECT_EQ(topic.schema, "pliant/msg/JointTorque");
  EXPECT_EQ(topic.text, "# joint torque\nfloat64 shoulder  # N·m\nfloat64 elbow  # N·m\n");
  EXPECT_EQ(topic.metadata.at("pliant.path"), "torque.y");
  EXPECT_EQ(topic.metadata.at("pliant.type"), "joint torque");
  EXPECT_EQ(topic.metadata.at("pliant.elements"), R"(["[shoulder]","[elbow]"])");
  EXPECT_EQ(topic.metadata.at("pliant.units"), R"(["N·m","N·m"])");
  ASSERT_EQ(topic.messages.size(), 10u);
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(topic.messages[k].time_ns, k * 1'000'000);
    EXPECT_THAT(McapScan::Numbers(topic.messages[k]), ElementsAre(1, -2));
  }
  EXPECT_EQ(scan.topics.at("/flag/y").messages.size(), 10u);
  EXPECT_EQ(scan.metadata.at("pliant").at("seed"), "7");
  EXPECT_EQ(scan.metadata.at("pliant.statistics").at("rows"), "10");
  EXPECT_EQ(scan.metadata.at("pliant.statistics").at("dropped"), "0");

  const McapLog::Statistics s = log->statistics();
  EXPECT_EQ(s.rows, 10);
  EXPECT_EQ(s.dropped, 0);
  EXPECT_EQ(s.bytes, static_cast<std::int64_t>(std::filesystem::file_size(file())));
  EXPECT_EQ(s.error, "");
}

TEST_F(McapLogTest, IsTheSameFileForTheSameRows) {
  // A chunk is closed early only where a machine takes half a second for it.
  std::string one, other;
  for (int tries = 0; tries < 10; ++tries) {
    const auto begin = WallClock::now();
    for (std::string* bytes : {&one, &other}) {
      McapLog log({.file = file(), .force = true});
      Count(log, log.Open({Wide(100)}), 3000);
      log.Close();
      *bytes = ReadText(file());
    }
    if (WallClock::now() - begin < 500ms) break;
  }
  EXPECT_GT(Scan().chunks, 2u);
  EXPECT_TRUE(one == other);
}

TEST_F(McapLogTest, NamesInEachChunkTheChannelsOfItsMessages) {
  McapLog log({.file = file()});
  const int wide = log.Open({Wide(100), {"a", "double", {""}, {"m"}}, {"b", "int", {""}, {""}}});
  Count(log, wide, 500);
  const int late = log.Open({kCount, {"late", "joint torque", {"[elbow]"}, {"N·m"}}});
  Count(log, late, 1500);
  Count(log, wide, 1500, 500);
  log.Close();

  constexpr int kChunk = 6;
  std::map<std::string, std::size_t> messages;
  const std::string bytes = ReadText(file());
  for (const McapBytes& record : RecordsOf(bytes))
    if (record.op == kChunk) {
      // A log of this chunk alone, whose scan fails at a message of an unknown channel.
      const McapScan scan(LogBytes(bytes.substr(record.at, record.end() - record.at)));
      for (const auto& [topic, channel] : scan.topics) messages[topic] += channel.messages.size();
    }
  EXPECT_GT(Scan().chunks, 1u);
  EXPECT_THAT(messages, ElementsAre(Pair("/a", 2000), Pair("/b", 2000), Pair("/count", 1500),
                                    Pair("/late", 1500), Pair("/wide", 2000)));
}

TEST_F(McapLogTest, SharesASchemaBetweenValuesOfOneShape) {
  McapLog log({.file = file()});
  const int stream = log.Open({{"a", "joint torque", {"[elbow]"}, {"N·m"}},
                               {"b", "joint torque", {"[elbow]"}, {"N·m"}},
                               {"c", "joint torque", {"[wrist]"}, {"N·m"}},
                               {"d-e", "double", {""}, {""}},
                               {"d_e", "double", {""}, {""}},
                               {"tf", "double", {""}, {""}}});
  Count(log, stream, 1);
  log.Close();
  const McapScan scan = Scan();
  EXPECT_EQ(scan.topics.at("/a").schema, "pliant/msg/JointTorque");
  EXPECT_EQ(scan.topics.at("/b").schema, "pliant/msg/JointTorque");
  EXPECT_EQ(scan.topics.at("/c").schema, "pliant/msg/JointTorque2");
  EXPECT_EQ(scan.topics.at("/d_e").metadata.at("pliant.path"), "d-e");
  EXPECT_EQ(scan.topics.at("/d_e_2").metadata.at("pliant.path"), "d_e");
  EXPECT_EQ(scan.topics.at("/tf_2").metadata.at("pliant.path"), "tf");
}

TEST_F(McapLogTest, IsACompleteFileWithoutRows) {
  McapLog log({.file = file()});
  log.Open({kCount});
  log.Close();
  EXPECT_TRUE(Scan().whole);
  EXPECT_EQ(Scan().chunks, 0u);
}

TEST_F(McapLogTest, ClosesWithItsEndAndTakesNoRowsAfterwards) {
  { McapLog log({.file = file()}); }
  EXPECT_TRUE(Scan().whole);
  McapLog log({.file = file(), .force = true});
  const int stream = log.Open({kCount});
  log.Close();
  log.Close();
  EXPECT_EQ(Count(log, stream, 3), 0);
  EXPECT_EQ(log.statistics().dropped, 3);
}

TEST_F(McapLogTest, DropsRowsThatFindNoRoomAndSaysHowMany) {
  McapLog log({.file = file(), .full = McapLog::Full::Drop, .ring_bytes = 2048});
  const int stream = log.Open({Wide(100)});
  int written = Count(log, stream, 1000);
  const int dropped = 1000 - written;
  EXPECT_GT(dropped, 0);
  // Room again, and a row that says how many were lost before it.
  while (Count(log, stream, 1, 1000) == 0) std::this_thread::sleep_for(1ms);
  const auto more = static_cast<int>(log.statistics().dropped);
  ++written;
  log.Close();

  EXPECT_EQ(log.statistics().rows, written);
  EXPECT_GE(more, dropped);
  const McapScan scan = Scan();
  EXPECT_EQ(scan.metadata.at("pliant.statistics").at("rows"), std::to_string(written));
  EXPECT_EQ(scan.metadata.at("pliant.statistics").at("dropped"), std::to_string(more));
  EXPECT_EQ(scan.topics.at("/wide").messages.size(), static_cast<std::size_t>(written));
  const McapScan::Channel& told = scan.topics.at("/pliant/dropped");
  EXPECT_EQ(told.schema, "std_msgs/msg/Int64");
  EXPECT_EQ(told.messages.back().time_ns, 1'000'000'000u);
  std::int64_t count;
  std::memcpy(&count, told.messages.back().data.data() + 4, sizeof count);
  EXPECT_EQ(count, more);
}

TEST_F(McapLogTest, TellsOfRowsDroppedAtTheEnd) {
  McapLog log({.file = file(), .full = McapLog::Full::Drop, .ring_bytes = 2048});
  const int stream = log.Open({Wide(100)});
  while (Count(log, stream, 1) == 1) {
  }
  log.Close();
  ASSERT_EQ(Scan().topics.count("/pliant/dropped"), 1u);
  std::int64_t count;
  std::memcpy(&count, Scan().topics.at("/pliant/dropped").messages.back().data.data() + 4,
              sizeof count);
  EXPECT_EQ(count, 1);
}

TEST_F(McapLogTest, WaitsForRoom) {
  McapLog log({.file = file(), .full = McapLog::Full::Wait, .ring_bytes = 2048});
  EXPECT_EQ(Count(log, log.Open({Wide(100)}), 100), 100);
  log.Close();
  const McapScan scan = Scan();
  const McapScan::Channel& topic = scan.topics.at("/wide");
  ASSERT_EQ(topic.messages.size(), 100u);
  for (std::size_t k = 0; k < 100; ++k)
    EXPECT_EQ(McapScan::Numbers(topic.messages[k]), std::vector(100, static_cast<double>(k)));
}

TEST_F(McapLogTest, AllocatesNothingInATick) {
  const auto log =
      std::make_shared<McapLog>(McapLog::Options{.file = file(), .full = McapLog::Full::Drop});
  const Joints joints = Joints::Numbered(7);
  DiagramBuilder b;
  auto& torque =
      b.Add<Constant<JointTorque>>("torque", {.space = joints, .value = JointTorque::Zero(joints)});
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = log});
  b.Connect(torque.y, recorder.in);
  b.Connect(pose.y, recorder.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const long before = Allocations();
  sim.AdvanceTo(100);  // more rows than the ring holds
  EXPECT_EQ(Allocations(), before);
  log->Close();
  EXPECT_EQ(log->statistics().rows + log->statistics().dropped, 100'000);
}

TEST_F(McapLogTest, DropsARowBeforeTimeZero) {
  McapLog log({.file = file()});
  const int stream = log.Open({kCount});
  EXPECT_TRUE(log.Begin(stream, -1).empty());
  log.Close();
  EXPECT_EQ(log.statistics().dropped, 1);
}

TEST_F(McapLogTest, RefusesAFileThatIsThere) {
  std::ofstream(file()) << "older";
  EXPECT_EQ(ErrorOf([&] { McapLog({.file = file()}); }),
            file().string() + " exists; give --force to write over it, or another place");
  EXPECT_EQ(ReadText(file()), "older");
}

TEST_F(McapLogTest, WritesOverAFileWhenForced) {
  std::ofstream(file()) << "older";
  McapLog log({.file = file(), .force = true});
  EXPECT_EQ(ReadText(file()).substr(1, 4), "MCAP");  // from its first bytes on
  log.Close();
  EXPECT_TRUE(Scan().whole);
  EXPECT_FALSE(std::filesystem::exists(file().string() + ".part"));
}

TEST_F(McapLogTest, WritesThroughALinkWhenForced) {
  const std::filesystem::path link = directory_.path() / "link.mcap";
  std::ofstream(file()) << "older";
  std::filesystem::create_symlink(file(), link);
  McapLog({.file = link, .force = true}).Close();
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_TRUE(Scan().whole);
}

TEST_F(McapLogTest, LeavesAnOlderFileWhenItCannotBegin) {
  std::ofstream(file()) << "older";
  std::filesystem::create_directory(file().string() + ".part");
  EXPECT_EQ(ErrorOf([&] { McapLog({.file = file(), .force = true}); }),
            "cannot write " + file().string() + ": Is a directory");
  EXPECT_EQ(ReadText(file()), "older");
}

TEST_F(McapLogTest, SaysWhyItCannotBegin) {
  const std::filesystem::path nowhere = directory_.path() / "none" / "run.mcap";
  EXPECT_EQ(ErrorOf([&] { McapLog({.file = nowhere}); }),
            "cannot write " + nowhere.string() + ": No such file or directory");
  EXPECT_EQ(ErrorOf([&] { McapLog({.file = directory_.path(), .force = true}); }),
            "cannot write " + directory_.path().string() + ": Is a directory");
  EXPECT_EQ(ErrorOf([&] { McapLog({.file = "/dev/full", .force = true}); }),
            "cannot write /dev/full: No space left on device");
}

TEST_F(McapLogTest, LeavesAllAsItWasWhenItsThreadCannotBegin) {
  std::ofstream(file()) << "older";
  pthread_attr_t before, huge;
  pthread_getattr_default_np(&before);
  pthread_attr_init(&huge);
  pthread_attr_setstacksize(&huge, std::size_t{1} << 48);  // more than there are addresses
  pthread_setattr_default_np(&huge);
  const std::string error = ErrorOf([&] { McapLog({.file = file(), .force = true}); });
  pthread_setattr_default_np(&before);

  EXPECT_THAT(error, StartsWith("cannot write " + file().string() +
                                ": the thread that writes cannot begin: "));
  EXPECT_EQ(ReadText(file()), "older");
  EXPECT_FALSE(std::filesystem::exists(file().string() + ".part"));
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_EQ(sigismember(&blocked, SIGINT), 0);
}

/// Until its end files may not grow beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(McapLogTest, GoesOnWithoutRowsWhenTheDiskIsFull) {
  constexpr int kRows = 2000;
  std::mt19937_64 random(1);
  McapLog log({.file = file()});
  const int stream = log.Open({Wide(1000)});  // 16 MB of noise
  {
    const FileSizeLimit limit(5'000'000);
    for (int k = 0; k < kRows; ++k)
      if (const std::span<double> row = log.Begin(stream, k); !row.empty()) {
        for (double& x : row) x = std::generate_canonical<double, 53>(random);
        log.Commit();
      }
    const std::string error = "cannot write " + file().string() + ": File too large";
    const std::string message = ErrorOf([&] { log.Close(); });
    const McapLog::Statistics s = log.statistics();
    EXPECT_EQ(s.error, error);
    EXPECT_GT(s.rows, 0);
    EXPECT_GT(s.dropped, 0);
    EXPECT_EQ(s.rows + s.dropped, kRows);
    EXPECT_EQ(message, error + "\n" + std::to_string(s.dropped) +
                           " of 2000 rows are missing; those before them can be read");
  }
  // A file without an end, and without half a record.
  const McapScan scan = Scan();
  EXPECT_FALSE(scan.whole);
  EXPECT_EQ(scan.topics.at("/wide").messages.size(),
            static_cast<std::size_t>(log.statistics().rows));
}

TEST_F(McapLogTest, LosesASecondAtMostWhenItsProcessIsKilled) {
  constexpr int kMost = 100'000;
  struct Shared {
    std::atomic<int> rows;
    std::int64_t wall_ns[kMost];
  };
  auto* const shared = static_cast<Shared*>(
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(shared, MAP_FAILED);
  const auto wall_ns = [] {
    return std::chrono::nanoseconds(WallClock::now().time_since_epoch()).count();
  };
  const pid_t child = fork();
  if (child == 0) {
    McapLog log({.file = file()});
    const int stream = log.Open({kCount});
    for (int k = 0; k < kMost; ++k) {
      Count(log, stream, 1, k);
      shared->wall_ns[k] = wall_ns();
      shared->rows = k + 1;
      std::this_thread::sleep_for(1ms);
    }
    _exit(0);
  }
  ASSERT_GT(child, 0);
  std::this_thread::sleep_for(2500ms);
  kill(child, SIGKILL);
  const std::int64_t killed_ns = wall_ns();
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));

  const McapScan scan = Scan();
  EXPECT_FALSE(scan.whole);
  const auto& messages = scan.topics.at("/count").messages;
  const auto old = std::count_if(shared->wall_ns, shared->wall_ns + shared->rows,
                                 [&](std::int64_t ns) { return ns < killed_ns - 1'000'000'000; });
  EXPECT_GT(old, 0);
  EXPECT_GE(messages.size(), static_cast<std::size_t>(old));
  for (std::size_t k = 0; k < messages.size(); ++k)
    EXPECT_THAT(McapScan::Numbers(messages[k]), ElementsAre(k));
  munmap(shared, sizeof(Shared));
}

TEST_F(McapLogTest, RefusesAValueThatIsRecordedTwice) {
  McapLog log({.file = file()});
  log.Open({kCount});
  EXPECT_EQ(ErrorOf([&] { log.Open({kCount}); }),
            "cannot record count twice in one log\nlet one recorder record it; a diagram that is "
            "built again needs a log of its own");
}

TEST_F(McapLogTest, RefusesARingThatIsTooSmall) {
  McapLog log({.file = file(), .ring_bytes = 1000});
  EXPECT_EQ(ErrorOf([&] { log.Open({Wide(100)}); }),
            "ring_bytes must be >= 1648, twice a row of 100 numbers, got 1000");
}

TEST_F(McapLogTest, RefusesJointStatesOfDifferentJoints) {
  McapLog log({.file = file(), .position = "q", .velocity = "v"});
  EXPECT_EQ(ErrorOf([&] {
              log.Open({{"q", "joint position", {"[a]", "[b]"}, {"rad", "rad"}},
                        {"v", "joint velocity", {"[b]", "[a]"}, {"rad/s", "rad/s"}}});
            }),
            "cannot write /joint_states: q and v are about different joints\n"
            "  q : (a, b)\n  v : (b, a)");
}

TEST_F(McapLogTest, RefusesJointStatesOfTwoRecorders) {
  McapLog log({.file = file(), .position = "q", .velocity = "v"});
  EXPECT_EQ(ErrorOf([&] {
              log.Open({{"q", "joint position", {"[a]"}, {"rad"}}});
            }),
            "cannot write /joint_states: q is recorded without v\nconnect both to one recorder");
}

TEST_F(McapLogTest, RefusesPositionsOfAnotherRobot) {
  McapLog log({.file = file(),
               .robot = RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf"),
               .position = "q"});
  EXPECT_THAT(ErrorOf([&] {
                log.Open({{"q", "joint position", {"[a]"}, {"rad"}}});
              }),
              StartsWith("cannot write /tf: q is about other joints than "));
}

TEST_F(McapLogTest, SaysAtItsEndWhichPathNobodyRecorded) {
  McapLog log({.file = file(), .torque = "coumt"});
  log.Open({kCount});
  EXPECT_EQ(ErrorOf([&] { log.Close(); }),
            file().string() +
                ": /joint_states is not in the log: nothing recorded 'coumt'; did you mean "
                "'count'?");
  EXPECT_TRUE(Scan().whole);
}

}  // namespace
}  // namespace pliant
