#include "pliant/systems/time_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

std::filesystem::path File(const std::string& contents) {
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / "pliant_time_table.csv";
  std::ofstream(file, std::ios::binary) << contents;
  return file;
}
TimeTable Read(const std::string& contents) { return ReadTimeTable(File(contents)); }

/// The message behind the name of the file.
std::string Fault(const std::string& contents) {
  const std::filesystem::path file = File(contents);
  const std::string message = ErrorOf([&] { ReadTimeTable(file); });
  return message.starts_with(file.string()) ? message.substr(file.string().size()) : message;
}

TEST(ReadTimeTable, ReadsNamesTimesAndNumbers) {
  const TimeTable expected{.columns = {"tau (N·m)", "q[0,1]"},
                           .times = {0, 0.5},
                           .cells = {1, -2, 3e2, 4},
                           .time_column = "time (s)",
                           .header_line = 1};
  EXPECT_EQ(Read("time (s),tau (N·m),\"q[0,1]\"\n0,1,-2\n0.5,3e2,4\n"), expected);
}

TEST(ReadTimeTable, NumbersColumnsWithoutNames) {
  const TimeTable expected{.columns = {"1", "2"}, .times = {0, 1}, .cells = {1, 2, 3, 4}};
  EXPECT_EQ(Read("0,1,2\n1,3,4"), expected);
}

TEST(ReadTimeTable, PassesOverBlanksEmptyLinesAndLineEndsOfWindows) {
  const TimeTable expected{
      .columns = {"a"}, .times = {0, 1}, .cells = {1, 2}, .time_column = "t", .header_line = 1};
  EXPECT_EQ(Read("\xEF\xBB\xBFt, a\r\n\r\n 0 ,\t+1\r\n1,2\r\n\r\n"), expected);
}

TEST(ReadTimeTable, NamesAMissingFile) {
  EXPECT_EQ(ErrorOf([] { ReadTimeTable("no/such.csv"); }),
            "no/such.csv:1:1: cannot read the file: No such file or directory");
}

TEST(ReadTimeTable, RefusesAFolder) {
  const std::string folder = ::testing::TempDir();
  EXPECT_EQ(ErrorOf([&] { ReadTimeTable(folder); }),
            folder + ":1:1: cannot read on: Is a directory");
}

TEST(ReadTimeTable, RefusesAFileWithoutRows) {
  EXPECT_EQ(Fault(""), ":1:1: expected a row of numbers, got the end of the file");
  EXPECT_EQ(Fault("t,a\n"), ":2:1: expected a row of numbers, got the end of the file");
}

TEST(ReadTimeTable, RefusesARowOfATimeAlone) {
  EXPECT_EQ(Fault("1\n2\n"), ":1:1: a row has a time and at least one number, got one field");
}

TEST(ReadTimeTable, RefusesRaggedRows) {
  EXPECT_EQ(Fault("t,a,b\n0,1,2\n1,2\n"), ":3:3: expected 3 fields as in the first row, got 2");
  EXPECT_EQ(Fault("0,1\n1,2,3\n"), ":2:3: expected 2 fields as in the first row, got 3");
}

TEST(ReadTimeTable, RefusesWhatIsNoNumber) {
  EXPECT_EQ(Fault("t,a\n0,one\n"), ":2:2: expected a number, got 'one'");
  EXPECT_EQ(Fault("t,a\n0,1\nx,1\n"), ":3:1: expected a number, got 'x'");
  EXPECT_EQ(Fault("0,1.5.2\n"), ":1:2: expected a number, got '1.5.2'");
  EXPECT_EQ(Fault("0,\n"), ":1:2: expected a number, got ''");
  EXPECT_EQ(Fault("0,1e999\n"), ":1:2: expected a number, got '1e999'");
}

TEST(ReadTimeTable, RefusesWhatIsNotFinite) {
  EXPECT_EQ(Fault("t,a\n0,nan\n"), ":2:2: expected a finite number, got 'nan'");
  EXPECT_EQ(Fault("t,a\n0,-inf\n"), ":2:2: expected a finite number, got '-inf'");
  EXPECT_EQ(Fault("t,a\nnan,1\n"), ":2:1: expected a finite number, got 'nan'");
}

TEST(ReadTimeTable, RefusesTimesThatDoNotIncrease) {
  EXPECT_EQ(Fault("0,1\n0.5,2\n0.5,3\n"), ":3:1: times must increase, got 0.5 after 0.5");
  EXPECT_EQ(Fault("0,1\n-1,2\n"), ":2:1: times must increase, got -1 after 0");
}

}  // namespace
}  // namespace pliant
