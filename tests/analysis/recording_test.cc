#include "pliant/analysis/recording.h"

#include <filesystem>
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

}  // namespace
}  // namespace pliant
