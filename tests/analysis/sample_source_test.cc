#include "pliant/analysis/sample_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "pliant/analysis/mcap_log.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SampleSourceTest : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text, const std::string& name = "log.csv") const {
    std::ofstream(directory_.path() / name) << text;
    return directory_.path() / name;
  }
  /// Of a file with columns t, v, a, i, m.
  static SampleSource Whole(const std::filesystem::path& file) {
    return {.files = {file},
            .velocity = {{"v"}},
            .acceleration = {{"a"}},
            .current = {{"i"}},
            .torque = {{"m"}}};
  }
  std::string ErrorOfText(const std::string& text) const {
    return ErrorOf([&] { ReadSamples(Whole(Write(text))); });
  }
  const TemporaryDirectory directory_;
};

TEST_F(SampleSourceTest, ReadsNamedColumnsWithAnyDelimiter) {
  for (const std::string delimiter : {",", ";", "\t", " ", ", "}) {
    std::string text = "t,v,a,i,m\n0,1,2,3,4\n1,5,6,7,8\n";
    for (std::size_t at = 0; (at = text.find(',', at)) != std::string::npos; at += delimiter.size())
      text.replace(at, 1, delimiter);
    const Samples samples = ReadSamples(Whole(Write(text)));
    EXPECT_THAT(samples.joints, ElementsAre("joint_1")) << delimiter;
    EXPECT_EQ(samples.time, Eigen::Vector2d(0, 1)) << delimiter;
    EXPECT_EQ(samples.velocity, Eigen::RowVector2d(1, 5));
    EXPECT_EQ(samples.acceleration, Eigen::RowVector2d(2, 6));
    EXPECT_EQ(samples.current, Eigen::RowVector2d(3, 7));
    EXPECT_EQ(samples.torque, Eigen::RowVector2d(4, 8));
    EXPECT_EQ(samples.read, 2);
  }
}

TEST_F(SampleSourceTest, ReadsWhatNumPyAndSpreadsheetsWrite) {
  for (const char* text : {"# t v a i m\n0 1 2 3 4\n", "\xEF\xBB\xBFt;v;a;i;m\r\n0;1;2;3;4\r\n",
                           "\"t\",\"v\",\"a\",\"i\",\"m\"\n0,+1,2.0e0,3,4\n\n# end\n",
                           "# a remark\nt,v,a,i,m\n0,1,2,3,4\n"}) {
    const Samples samples = ReadSamples(Whole(Write(text)));
    ASSERT_EQ(samples.time.size(), 1) << text;
    EXPECT_EQ(samples.velocity(0), 1) << text;
    EXPECT_EQ(samples.acceleration(0), 2) << text;
  }
}

TEST_F(SampleSourceTest, ARemarkIsOneWhateverTheDelimiter) {
  SampleSource source = Whole(Write("# a remark\nt;v;a;i;m\n0;1;2;3;4\n"));
  source.delimiter = ';';
  EXPECT_EQ(ReadSamples(source).velocity(0), 1);
  source.files = {Write("# t;v;a;i;m\n0;1;2;3;4\n")};
  EXPECT_EQ(ReadSamples(source).velocity(0), 1);
}

TEST_F(SampleSourceTest, AnIndexNeedsNoName) {
  for (const char* text : {"\tt\tv\ta\ti\tm\n7\t0\t1\t2\t3\t4\n", ",t,v,a,i,m\n7,0,1,2,3,4\n"})
    EXPECT_EQ(ReadSamples(Whole(Write(text))).velocity(0), 1) << text;
}

TEST_F(SampleSourceTest, NamesACellOfOtherLetters) {
  EXPECT_THAT(ErrorOfText("t,v,a,i,m\n0,1,2,3,4\n1,µ,2,3,4\n"),
              HasSubstr("log.csv:3: expected a number in column 'v'"));
}

TEST_F(SampleSourceTest, FindsColumnsByNumber) {
  SampleSource source = Whole(Write("0,1,2,3,4\n1,5,6,7,8\n"));
  source.time = {{"1"}};
  source.velocity = {{"2"}};
  source.acceleration = {{"3"}};
  source.current = {{"4"}};
  source.torque = {{"5"}};
  EXPECT_EQ(ReadSamples(source).torque, Eigen::RowVector2d(4, 8));
  source.torque = {{"6"}};
  EXPECT_EQ(ErrorOf([&] { ReadSamples(source); }),
            source.files[0].string() +
                ": there is no column '6' for the torque\n"
                "it names no columns and has 5, called 1 to 5");
}

TEST_F(SampleSourceTest, FindsColumnsOfAllJointsByAPattern) {
  const auto file = Write("time,v1,v2,v3,c0,c1,c2,f1,f2,f3\n0,1,2,3,4,5,6,7,8,9\n");
  SampleSource source{.files = {file},
                      .velocity = {{"v{}"}},
                      .current = {{"c{-1}"}},
                      .torque = {{"f{}"}},
                      .need_acceleration = false};
  EXPECT_THAT(ReadSamples(source).joints, ElementsAre("joint_1", "joint_2", "joint_3"));
  EXPECT_EQ(ReadSamples(source).current, Eigen::Vector3d(4, 5, 6));
  source.joints = {"3", "joint_1"};
  EXPECT_THAT(ReadSamples(source).joints, ElementsAre("joint_3", "joint_1"));
  EXPECT_EQ(ReadSamples(source).torque, Eigen::Vector2d(9, 7));
  source.joints = {"4"};
  EXPECT_THAT(ErrorOf([&] { ReadSamples(source); }),
              HasSubstr("there is no column 'v4' for the velocity; did you mean 'v1'?\n"
                        "its columns: time, v1, v2, v3, c0, c1, c2, f1, f2, f3"));
  source.joints = {"elbow"};
  EXPECT_EQ(ErrorOf([&] { ReadSamples(source); }),
            "'elbow' is no number of a joint; the columns 'v{}' have numbers");
  source.joints = {};
  for (const char* pattern : {"v{+2147483647}", "v{-1001}", "v{+99999999999999999999}"}) {
    source.velocity = {{pattern}};
    EXPECT_EQ(ErrorOf([&] { ReadSamples(source); }),
              "'" + std::string(pattern) +
                  "': expected {}, {+N} or {-N} for the number of the joint, N ≤ 1000");
  }
}

TEST_F(SampleSourceTest, KnowsTheColumnsOfOurOwnCsv) {
  const auto file = Write(
      "time (s),arm.measured_velocity[shoulder] (rad/s),arm.measured_velocity[elbow] (rad/s),"
      "arm.measured_current[shoulder] (A),arm.measured_current[elbow] (A),"
      "arm.measured_torque[shoulder] (N·m),arm.measured_torque[elbow] (N·m)\n0,1,2,3,4,5,6\n");
  SampleSource source{.files = {file}, .need_acceleration = false};
  EXPECT_THAT(ReadSamples(source).joints, ElementsAre("shoulder", "elbow"));
  EXPECT_EQ(ReadSamples(source).torque, Eigen::Vector2d(5, 6));
  source.joints = {"elbow"};
  EXPECT_EQ(ReadSamples(source).torque.rows(), 1);
  EXPECT_EQ(ReadSamples(source).torque(0), 6);
  source.joints = {"elbw"};
  EXPECT_THAT(ErrorOf([&] { ReadSamples(source); }),
              HasSubstr("there is no joint 'elbw' among the columns of the velocity; did you mean "
                        "'elbow'?"));
}

TEST_F(SampleSourceTest, RefusesColumnsOfOtherJoints) {
  const auto file = Write(
      "time (s),arm.measured_velocity[shoulder] (rad/s),arm.measured_velocity[elbow] (rad/s),"
      "arm.measured_current[elbow] (A),arm.measured_current[shoulder] (A),"
      "arm.measured_torque[shoulder] (N·m),arm.measured_torque[elbow] (N·m)\n0,1,2,3,4,5,6\n");
  SampleSource source{.files = {file}, .need_acceleration = false};
  EXPECT_EQ(ErrorOf([&] { ReadSamples(source); }),
            file.string() +
                ": the columns of the current must be of the same joints in the same order as "
                "those of the velocity (shoulder, elbow), got (elbow, shoulder); name them in one "
                "order with --joints, or say each column");
  source.joints = {"elbow", "shoulder"};
  EXPECT_EQ(ReadSamples(source).current, Eigen::Vector2d(3, 4));
  EXPECT_EQ(ReadSamples(source).velocity, Eigen::Vector2d(2, 1));
  // Columns that are listed name no joint.
  source.joints = {};
  source.current = {{"4", "5"}};
  EXPECT_EQ(ReadSamples(source).current, Eigen::Vector2d(3, 4));
}

TEST_F(SampleSourceTest, TurnsUnitsIntoSi) {
  SampleSource source = Whole(Write("t,v (deg/s),a,i,m\n5,180,360,2000,3\n"));
  source.time.unit = "ms";
  source.acceleration.unit = "deg/s²";
  source.current.unit = "mA";
  source.torque.unit = "Nm";
  const Samples samples = ReadSamples(source);
  EXPECT_DOUBLE_EQ(samples.time(0), 5e-3);
  EXPECT_DOUBLE_EQ(samples.velocity(0), std::numbers::pi);
  EXPECT_DOUBLE_EQ(samples.acceleration(0), 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(samples.current(0), 2);
  source.current.unit = "amp";
  EXPECT_EQ(ErrorOf([&] { ReadSamples(source); }),
            "'amp' is no unit of a current; known are A, mA");
}

TEST_F(SampleSourceTest, SkipsAndCountsRowsWithoutANumber) {
  const Samples samples = ReadSamples(
      Whole(Write("t,v,a,i,m\n0,1,2,3,4\n1,nan,2,3,4\n2,1,,3,4\n3,1,2,inf,4\n4,1,2,3,NA\n"
                  "5,1,2,3,4\n")));
  EXPECT_EQ(samples.time, Eigen::Vector2d(0, 5));
  EXPECT_EQ(samples.skipped, 4);
  EXPECT_THAT(samples.text(), HasSubstr("6 rows, 4 skipped for a number that is none (first "));
  EXPECT_THAT(samples.first_skipped, HasSubstr("log.csv:3"));
}

TEST_F(SampleSourceTest, RefusesFilesThatAreNone) {
  const std::string at = (directory_.path() / "log.csv").string();
  EXPECT_EQ(ErrorOfText(""), at + " is empty");
  EXPECT_EQ(ErrorOfText("t,v,a,i,m\n"), at + ": there are names of columns and no row below them");
  EXPECT_EQ(ErrorOfText("t,v,a,i,m\n0,1,2,nan,4\n"),
            at + ": no number of the current of joint_1 is finite; leave the joint out with "
                 "--joints, or say another column");
  EXPECT_EQ(ErrorOfText("t,v,a,i,m\n0,1,2,3\n1,1,2,3,4\n"),
            at + ":2: expected 5 cells as in the first line, got 4");
  EXPECT_EQ(ErrorOfText("t,v,a,i,m\n0,1,2,3,4\n1,1,x7,3,4\n"),
            at + ":3: expected a number in column 'a', got 'x7'");
  EXPECT_EQ(ErrorOfText("t,v,a,i,m\n1,1,2,3,4\n0.5,1,2,3,4\n"),
            at + ":3: the time goes back, from 1 s to 0.5 s; sort the rows, or give each run a "
                 "file of its own");
  EXPECT_EQ(ErrorOfText("t,vel,a,i,m\n0,1,2,3,4\n"),
            at + ": there is no column 'v' for the velocity; did you mean 't'?\n"
                 "its columns: t, vel, a, i, m");
  EXPECT_EQ(ErrorOf([&] { ReadSamples({.files = {Write("t,v\n0,1\n")}}); }),
            at + ": which column is the current? Say it with --current\nits columns: t, v");
  EXPECT_EQ(ErrorOfText(std::string("t,v,a,i,m\n0,1,2\0,3,4\n", 22)),
            at + ":2: there is a zero byte; is it a CSV file?");
  EXPECT_THAT(ErrorOf([&] { ReadSamples(Whole(directory_.path() / "none.csv")); }),
              HasSubstr("none.csv: No such file or directory"));
  EXPECT_THAT(ErrorOf([&] { ReadSamples(Whole(directory_.path())); }), HasSubstr("is a directory"));
}

TEST_F(SampleSourceTest, ALastRowThatIsCutIsLeftOut) {
  const Samples samples = ReadSamples(Whole(Write("t,v,a,i,m\n0,1,2,3,4\n1,1,2")));
  EXPECT_EQ(samples.time.size(), 1);
  EXPECT_EQ(samples.cut, 1);
}

TEST_F(SampleSourceTest, DerivesExactlyFromAParabolaAtAnyStamps) {
  // v = 1 + 2 t + 3 t² has the acceleration 2 + 6 t, and q = t + t² + t³ up to its parabola's
  // error, j w² h²/10 with the jerk j.
  std::string text = "t,q,v,i,m\n";
  for (int k = 0; k < 200; ++k) {
    const double t = 0.001 * (k + 0.4 * std::sin(7.0 * k));
    text += Text(t) + "," + Text(t + t * t) + "," + Text(1 + 2 * t + 3 * t * t) + ",0,0\n";
  }
  SampleSource source{
      .files = {Write(text)}, .velocity = {{"v"}}, .current = {{"i"}}, .torque = {{"m"}}};
  const Samples of_velocity = ReadSamples(source);
  EXPECT_EQ(of_velocity.time.size(), 180);
  EXPECT_TRUE(of_velocity.derived_acceleration);
  // The text has ten digits; a slope over ±10 ms divides their error by 3e-3.
  for (Eigen::Index k = 0; k < 180; ++k)
    EXPECT_NEAR(of_velocity.acceleration(k), 2 + 6 * of_velocity.time(k), 1e-6);
  source.velocity = {};
  source.position = {{"q"}};
  const Samples of_position = ReadSamples(source);
  for (Eigen::Index k = 0; k < 180; ++k) {
    EXPECT_NEAR(of_position.velocity(k), 1 + 2 * of_position.time(k), 1e-7);
    EXPECT_NEAR(of_position.acceleration(k), 2, 1e-4);
  }
}

TEST_F(SampleSourceTest, TakesNoDerivativeAcrossAGap) {
  std::string text = "t,v,i,m\n";
  for (int k = 0; k < 100; ++k) text += Text(k < 50 ? 0.01 * k : 10 + 0.01 * k) + ",1,0,0\n";
  const Samples samples = ReadSamples({.files = {Write(text)},
                                       .velocity = {{"v"}},
                                       .current = {{"i"}},
                                       .torque = {{"m"}},
                                       .half_window = 5});
  EXPECT_EQ(samples.time.size(), 80);  // 5 at either end of either half
  EXPECT_EQ(ErrorOf([&] {
              ReadSamples({.files = {Write("t,v,i,m\n0,1,1,1\n1,1,1,1\n")},
                           .velocity = {{"v"}},
                           .current = {{"i"}},
                           .torque = {{"m"}}});
            }),
            (directory_.path() / "log.csv").string() +
                ": a derivative needs 21 samples without a gap, got 2; make --window smaller, or "
                "say the column of the acceleration");
}

TEST_F(SampleSourceTest, NamesStampsThatAreTooCoarse) {
  const auto rounded = [&](int of, int rows) {
    std::string text = "t,v,i,m\n";
    for (int k = 0; k < rows; ++k)
      text += Text(0.001 * (k / of * of)) + "," + Text(0.001 * k) + ",0,0\n";
    return SampleSource{
        .files = {Write(text)}, .velocity = {{"v"}}, .current = {{"i"}}, .torque = {{"m"}}};
  };
  EXPECT_EQ(ErrorOf([&] { ReadSamples(rounded(20, 200)); }),
            (directory_.path() / "log.csv").string() +
                " at 0 s: of 21 samples in a row the stamps show two times, 0.02 s apart, which is "
                "their resolution: too coarse for a derivative, which needs three; make --window "
                "greater, or say --sample-period instead of --time");
  EXPECT_THAT(ErrorOf([&] { ReadSamples(rounded(100, 200)); }),
              HasSubstr("the stamps show one time: too coarse"));
  // Five times tell a slope; their mean error of 2 ms takes little of it over 20 ms.
  const Samples samples = ReadSamples(rounded(5, 200));
  EXPECT_EQ(samples.time.size(), 180);
  EXPECT_NEAR(samples.acceleration.mean(), 1, 0.1);
}

TEST_F(SampleSourceTest, KeepsAnEvenShareOfWhatIsTooMuch) {
  std::string text = "t,v,a,i,m\n";
  for (int k = 0; k < 10'000; ++k) text += Text(k) + ",1,2,3,4\n";
  SampleSource source = Whole(Write(text));
  source.most = 1000;
  const Samples samples = ReadSamples(source);
  EXPECT_EQ(samples.read, 10'000);
  EXPECT_EQ(samples.stride, 16);  // 10 000/8 > 1000
  ASSERT_EQ(samples.time.size(), 625);
  for (Eigen::Index k = 0; k < 625; ++k) EXPECT_EQ(samples.time(k), 16 * k);
  EXPECT_THAT(samples.text(), HasSubstr("one in 16 kept"));
}

TEST_F(SampleSourceTest, ReadsSeveralFilesEachFromItsOwnTime) {
  SampleSource source = Whole(Write("t,v,a,i,m\n5,1,2,3,4\n6,1,2,3,4\n", "a.csv"));
  source.files.push_back(Write("m,t,v,a,i\n8,0,5,6,7\n", "b.csv"));
  const Samples samples = ReadSamples(source);
  EXPECT_EQ(samples.time, Eigen::Vector3d(5, 6, 0));
  EXPECT_EQ(samples.torque, Eigen::RowVector3d(4, 4, 8));
  EXPECT_THAT(samples.begin, ElementsAre(0, 2));
}

TEST_F(SampleSourceTest, ReadsOurOwnLogs) {
  const auto file = directory_.path() / "run.mcap";
  {
    McapLog log({.file = file});
    const std::vector<std::string> elements{"[shoulder]", "[elbow]"};
    const int stream = log.Open({{"arm.measured_velocity", "", elements, {"rad/s", "rad/s"}},
                                 {"arm.measured_current", "", elements, {"A", "A"}},
                                 {"other", "", {""}, {"s"}},
                                 {"arm.measured_torque", "", elements, {"N·m", "N·m"}}});
    for (int k = 0; k < 5000; ++k) {
      std::span<double> row;
      while ((row = log.Begin(stream, k * 1'000'000LL)).empty()) {
      }
      for (int i = 0; i < 7; ++i) row[static_cast<std::size_t>(i)] = k + 0.1 * i;
      log.Commit();
    }
    log.Close();
  }
  const Samples samples = ReadSamples({.files = {file}, .need_acceleration = false});
  EXPECT_THAT(samples.joints, ElementsAre("shoulder", "elbow"));
  ASSERT_EQ(samples.time.size(), 5000);
  EXPECT_EQ(samples.velocity.col(4999), Eigen::Vector2d(4999, 4999 + 0.1));
  EXPECT_EQ(samples.torque.col(7), Eigen::Vector2d(7 + 0.1 * 5, 7 + 0.1 * 6));
  EXPECT_DOUBLE_EQ(samples.time(7), 7e-3);
  EXPECT_THAT(ErrorOf([&] { ReadSamples({.files = {file}, .torque = {{"arm.torque"}}}); }),
              HasSubstr("there is no column 'arm.torque' for the torque; did you mean"));
}

}  // namespace
}  // namespace pliant
