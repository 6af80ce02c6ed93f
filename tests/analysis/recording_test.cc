#include "pliant/analysis/recording.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/mcap_bytes.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

RecordedSignal Force() {
  return {{"arm.push", "force", {".force[x]", ".force[y]", ".on"}, {"N", "N", ""}},
          Eigen::Vector2d(0, 1),
          (Eigen::MatrixXd(3, 2) << 1, 2, 3, 4, 5, 6).finished()};
}

class RecordingOf : public testing::TestWithParam<std::string> {};

TEST_P(RecordingOf, HasTheNumbersThatAnotherWriterWrote) {
  const Recording run = Recording::Read(LogOf(GetParam()));
  ASSERT_EQ(run.signals().size(), 2u);

  const RecordedSignal& v = run["arm.measured_velocity"];
  EXPECT_EQ(v.type, "joint velocity");
  EXPECT_THAT(v.elements, ElementsAre("[shoulder]", "[elbow]"));
  EXPECT_THAT(v.units, ElementsAre("rad/s", "rad/s"));
  ASSERT_EQ(v.numbers.cols(), 50);
  for (int k = 0; k < 50; ++k) {
    EXPECT_EQ(v.times(k), k * 1'000'000 / 1e9);
    EXPECT_EQ(v.numbers(0, k), k / 3.0);
    EXPECT_EQ(v.numbers(1, k), -k / 7.0);
  }
  const RecordedSignal& e = run["energy"];
  EXPECT_THAT(e.elements, ElementsAre(""));
  ASSERT_EQ(e.numbers.cols(), 5);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(e.numbers(0, k), 100 * k * k / 11.0);

  EXPECT_EQ(run.metadata(),
            (Recording::Metadata{{"pliant", {{"version", "0.1.0"}, {"seed", "7"}}}}));
  EXPECT_EQ(run.robot_description(), "<robot name=\"two\"/>");
}

INSTANTIATE_TEST_SUITE_P(AnyLayout, RecordingOf,
                         testing::Values("plain.mcap", "zstd.mcap", "lz4.mcap", "no_chunks.mcap",
                                         "no_index.mcap", "no_statistics.mcap"),
                         [](const auto& test) {
                           return test.param.substr(0, test.param.find('.'));
                         });

TEST(Recording, HasAllThatMcapLogWrote) {
  const Recording run = Recording::Read(LogOf("mcap_log.mcap"));
  ASSERT_EQ(run.signals().size(), 3u);
  EXPECT_EQ(run["arm.measured_velocity"].numbers,
            Recording::Read(LogOf("zstd.mcap"))["arm.measured_velocity"].numbers);
  const RecordedSignal& push = run["arm.push"];
  EXPECT_EQ(static_cast<RecordedValue>(push),
            (RecordedValue{"arm.push", "wrench", {".force[x]", ".torque[x]"}, {"N", "N·m"}}));
  for (int k = 0; k < 50; ++k) EXPECT_EQ(push.numbers(0, k), std::sin(k));
  EXPECT_TRUE(std::isnan(push["torque.x"](3)));
  EXPECT_EQ(push["torque.x"](4), 0);
  EXPECT_EQ(run.metadata().at("pliant").at("scenario"), "joint: 1 # ü\n");
  EXPECT_EQ(run.robot_description(), "");
}

TEST(Recording, FindsAnElementWithOrWithoutBracketsAndDot) {
  const RecordedSignal push = Force();
  for (const char* name : {".force[y]", "force[y]", "force.y"})
    EXPECT_EQ(push[name], Eigen::Vector2d(3, 4)) << name;
  EXPECT_EQ(push["on"], Eigen::Vector2d(5, 6));
}

TEST(Recording, NamesTheNearestPathAndElement) {
  const Recording run({Force()}, {});
  EXPECT_TRUE(run.has("arm.push"));
  EXPECT_FALSE(run.has("arm.pull"));
  EXPECT_EQ(ErrorOf([&] { run["arm.pus"]; }),
            "the recording has no signal 'arm.pus'; did you mean 'arm.push'?");
  EXPECT_EQ(ErrorOf([&] { run["arm.push"]["force.z"]; }),
            "arm.push has no element 'force.z'; did you mean '.force[x]'?");
}

TEST(Recording, SaysWhatALogOfOthersHolds) {
  const std::string file = LogOf("foreign.mcap").string();
  EXPECT_EQ(ErrorOf([&] { Recording::Read(file); }),
            file +
                " is an MCAP file of '@mcap/core 2.2.2' and holds no recording of pliant\n"
                "its topics:\n"
                "  /arm/measured_velocity : pliant_msgs/msg/JointVelocity\n"
                "  /energy : std_msgs/msg/Float64\n"
                "  /robot_description : std_msgs/msg/String");
}

TEST(Recording, NamesAFileThatIsNone) {
  EXPECT_EQ(ErrorOf([] { Recording::Read("none.mcap"); }),
            "cannot read none.mcap: No such file or directory");
  EXPECT_THAT(ErrorOf([] { Recording::Read(LogOf("")); }), EndsWith(": it is not a file"));
  EXPECT_THAT(ErrorOf([] { Recording::Read(LogOf("README.md")); }),
              EndsWith(": not an MCAP file: it does not begin with \\x89MCAP0\\r\\n"));
}

class ReadRecording : public testing::Test {
 protected:
  Recording Read(const std::string& records) {
    std::ofstream(file_, std::ios::binary) << LogBytes(records);
    return Recording::Read(file_);
  }
  std::string FaultOf(const std::string& records) {
    const std::string fault = ErrorOf([&] { Read(records); });
    const std::string front = file_.string() + ": ";
    EXPECT_THAT(fault, testing::StartsWith(front));
    return fault.substr(std::min(fault.size(), front.size()));
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_.path() / "run.mcap";
};

using Words = std::map<std::string, std::string>;

Words Joint(const std::string& path = "v") {
  return {{"pliant.path", path},
          {"pliant.type", "joint velocity"},
          {"pliant.elements", R"(["[elbow]"])"},
          {"pliant.units", R"(["rad/s"])"}};
}

std::string Number(double x) { return std::string("\0\1\0\0", 4) + Packed(x); }

TEST_F(ReadRecording, OrdersRowsByTimeAndKeepsTheOrderOfEqualTimes) {
  const Recording run = Read(ChannelBytes(1, "/v", Joint()) + MessageBytes(1, 20, Number(1)) +
                             MessageBytes(1, 10, Number(2)) + MessageBytes(1, 20, Number(3)) +
                             MessageBytes(1, 5, Number(4)));
  EXPECT_EQ(run["v"].times, Eigen::Vector4d(5e-9, 10e-9, 20e-9, 20e-9));
  EXPECT_EQ(run["v"]["elbow"], Eigen::Vector4d(4, 2, 1, 3));
}

TEST_F(ReadRecording, JoinsChannelsOfOneValueAndRefusesAnotherUnit) {
  const std::string rows = MessageBytes(1, 1, Number(1)) + MessageBytes(2, 2, Number(2));
  EXPECT_EQ(
      Read(ChannelBytes(1, "/v", Joint()) + ChannelBytes(2, "/v", Joint()) + rows)["v"].numbers,
      Eigen::RowVector2d(1, 2));
  Words changed = Joint();
  changed["pliant.units"] = R"(["deg/s"])";
  EXPECT_EQ(FaultOf(ChannelBytes(1, "/v", Joint()) + ChannelBytes(2, "/v", changed) + rows),
            "v changes within the log\n"
            "  from  joint velocity of [elbow] (rad/s)\n"
            "  to    joint velocity of [elbow] (deg/s)");
}

TEST_F(ReadRecording, NamesTheChannelWhoseMetadataIsWrong) {
  const auto fault_with = [&](const std::string& key, const std::string& word) {
    Words words = Joint();
    words[key] = word;
    return FaultOf(ChannelBytes(1, "/v", words));
  };
  const std::string list = " must be a list of words in JSON, got ";
  EXPECT_EQ(fault_with("pliant.elements", "[elbow"),
            "/v: the channel's metadata pliant.elements" + list + "[elbow");
  EXPECT_EQ(fault_with("pliant.units", "[1]"),
            "/v: the channel's metadata pliant.units" + list + "[1]");
  EXPECT_EQ(fault_with("pliant.units", R"(["m", "m"])"),
            "/v: there must be a unit for each element, got 2 for 1");
  Words words = Joint();
  words.erase("pliant.units");
  EXPECT_EQ(FaultOf(ChannelBytes(1, "/v", words)),
            "/v: the channel's metadata pliant.units" + list + "none");
  EXPECT_EQ(FaultOf(ChannelBytes(1, "/v", Joint(), "json")),
            "/v: the messages must be cdr, got json");
}

TEST_F(ReadRecording, NamesTheMessageThatIsNoRow) {
  const std::string channel = ChannelBytes(1, "/v", Joint());
  const std::string what = "/v: the message at 0.5 s must be 1 numbers in little-endian CDR, got ";
  EXPECT_EQ(FaultOf(channel + MessageBytes(1, 500'000'000, Number(1) + "x")), what + "13 bytes");
  EXPECT_EQ(FaultOf(channel + MessageBytes(1, 500'000'000, "")), what + "0 bytes");
  EXPECT_EQ(FaultOf(channel + MessageBytes(1, 500'000'000, std::string(12, '\0'))),
            what + "12 bytes");  // of big-endian CDR
}

TEST_F(ReadRecording, NamesRecordsThatDoNotBelongTogether) {
  const std::string channel = ChannelBytes(1, "/v", Joint());
  EXPECT_THAT(FaultOf(channel + MessageBytes(2, 0, Number(1))),
              HasSubstr("a message of channel 2, which has not been met before it\n0 messages"));
  EXPECT_THAT(FaultOf(channel + ChannelBytes(1, "/w", Joint())),
              HasSubstr("two channels have the number 1: /v and /w\n"));
  EXPECT_THAT(FaultOf(channel + RecordBytes(2, std::string(20, '\0'))),
              HasSubstr("a footer does not belong between the data\n"));
  EXPECT_THAT(FaultOf(channel + RecordBytes(0, "")),
              HasSubstr("no record begins here: its opcode is 0\n"));
}

}  // namespace
}  // namespace pliant
