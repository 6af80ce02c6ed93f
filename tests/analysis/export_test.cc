#include "pliant/analysis/export.h"

#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Recording TwoJoints() {
  const RecordedSignal velocity{
      {"arm.velocity", "joint velocity", {"[shoulder]", "[elbow]"}, {"rad/s", "rad/s"}},
      Eigen::Vector3d(0, 0.1, 0.2),
      (Eigen::MatrixXd(2, 3) << 1.0 / 3, -0.0, 1e-310, 2, kInfinity, 1e300).finished()};
  const RecordedSignal mode{
      {"arm.mode", "int", {""}, {""}}, velocity.times, Eigen::RowVector3d(1, 2, 3)};
  const RecordedSignal slow{
      {"energy", "double", {""}, {"J"}}, Eigen::Vector2d(0, 0.2), Eigen::RowVector2d(5, 6)};
  const RecordedSignal empty{{"energy.torque", "double", {""}, {"N·m"}}, {}, Eigen::MatrixXd(1, 0)};
  const RecordedSignal nothing{
      {"arm.nothing", "table", {}, {}}, velocity.times, Eigen::MatrixXd(0, 3)};
  return {{velocity, mode, slow, empty, nothing},
          {{"pliant", {{"seed", "7"}}}},
          std::string(100'000, 'x')};
}

class Export : public testing::Test {
 protected:
  const TemporaryDirectory directory_;
  const std::filesystem::path csv_ = directory_.path() / "run.csv";
  const std::filesystem::path h5_ = directory_.path() / "run.h5";
};

TEST_F(Export, CsvHasTheShortestNumbersThatAreReadBackExactly) {
  ExportCsv(TwoJoints(), csv_, {"arm.velocity", "arm.mode"});
  EXPECT_EQ(ReadText(csv_),
            "time (s),arm.velocity[shoulder] (rad/s),arm.velocity[elbow] (rad/s),arm.mode\n"
            "0,0.3333333333333333,2,1\n"
            "0.1,-0,inf,2\n"
            "0.2,1e-310,1e+300,3\n");
}

TEST_F(Export, CsvQuotesNamesWithCommasAndQuotes) {
  ExportCsv(Recording({{{"a", "", {"[x, \"y\"]"}, {"m"}}, {}, Eigen::MatrixXd(1, 0)}}, {}), csv_);
  EXPECT_EQ(ReadText(csv_), "time (s),\"a[x, \"\"y\"\"] (m)\"\n");
}

TEST_F(Export, CsvOfDifferentTimesNamesBothSignals) {
  EXPECT_EQ(ErrorOf([&] { ExportCsv(TwoJoints(), csv_); }),
            "cannot export " + csv_.string() +
                ": the signals have different times\n"
                "  arm.velocity : 3 times, 0 s to 0.2 s\n"
                "  energy : 2 times, 0 s to 0.2 s\n"
                "export them to HDF5, or each to a file of its own");
  EXPECT_FALSE(std::filesystem::exists(csv_));
}

TEST_F(Export, CsvOfAnUnknownSignalNamesTheNearest) {
  EXPECT_EQ(ErrorOf([&] { ExportCsv(TwoJoints(), csv_, {"arm.velocit"}); }),
            "the recording has no signal 'arm.velocit'; did you mean 'arm.velocity'?");
  EXPECT_EQ(ErrorOf([&] { ExportCsv({}, csv_); }),
            "cannot export " + csv_.string() + ": there are no signals");
}

TEST_F(Export, AnOlderFileIsWrittenOverOnlyByForce) {
  std::ofstream(csv_) << "old";
  std::ofstream(h5_) << "old";
  const std::string way_out = " exists; give --force to write over it, or another place";
  EXPECT_EQ(ErrorOf([&] { ExportCsv(TwoJoints(), csv_, {"energy"}); }), csv_.string() + way_out);
  EXPECT_EQ(ErrorOf([&] { ExportHdf5(TwoJoints(), h5_); }), h5_.string() + way_out);
  EXPECT_EQ(ReadText(csv_) + ReadText(h5_), "oldold");

  ExportCsv(TwoJoints(), csv_, {"energy"}, true);
  ExportHdf5(TwoJoints(), h5_, true);
  EXPECT_THAT(ReadText(csv_), StartsWith("time"));
  EXPECT_THAT(ReadText(h5_), StartsWith("\x89HDF\r\n"));
}

TEST_F(Export, ADeviceIsNoPlaceForAFile) {
  const std::string what = "cannot write /dev/full: it is there and not a file";
  EXPECT_EQ(ErrorOf([] { ExportCsv(TwoJoints(), "/dev/full", {"energy"}, true); }), what);
  EXPECT_EQ(ErrorOf([] { ExportHdf5(TwoJoints(), "/dev/full", true); }), what);
}

TEST_F(Export, AFullDiskLeavesTheOlderFileAsItWas) {
  // A file of at most 64 KiB is as good as a full disk.
  Eigen::MatrixXd noise = Eigen::MatrixXd::Random(1, 100'000);
  const Recording run(
      {{{"noise", "double", {""}, {""}}, Eigen::VectorXd::LinSpaced(100'000, 0, 1), noise}}, {});
  std::ofstream(csv_) << "old";
  std::ofstream(h5_) << "old";
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit small = before;
  small.rlim_cur = 1 << 16;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string csv = ErrorOf([&] { ExportCsv(run, csv_, {}, true); });
  const std::string h5 = ErrorOf([&] { ExportHdf5(run, h5_, true); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  EXPECT_EQ(csv, "cannot write " + csv_.string() + ": File too large");
  EXPECT_EQ(h5, "cannot write " + h5_.string() + ": File too large");
  EXPECT_EQ(ReadText(csv_) + ReadText(h5_), "oldold");
  const std::filesystem::directory_iterator files(directory_.path()), end;
  EXPECT_EQ(std::distance(files, end), 2);  // and nothing half-written beside them

  ExportHdf5(run, h5_, true);  // the library has got over it
  EXPECT_THAT(ReadText(h5_), StartsWith("\x89HDF\r\n"));
}

TEST_F(Export, H5pyReadsNumbersNamesAndUnits) {
  ExportHdf5(TwoJoints(), h5_);
  const std::string command = PLIANT_PYTHON " -B " PLIANT_SOURCE_DIR
                                            "/tests/analysis/export_h5py.py " +
                              h5_.string() + " 2>&1";
  FILE* const python = popen(command.c_str(), "r");
  ASSERT_NE(python, nullptr);
  std::string said;
  for (int c; (c = std::fgetc(python)) != EOF;) said += static_cast<char>(c);
  EXPECT_EQ(pclose(python), 0) << said;
}

TEST_F(Export, AHundredFailedWritesKeepNoFileOpen) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  };
  std::filesystem::create_symlink("/dev/full", h5_.string() + ".part");
  const auto before = open_files();
  for (int i = 0; i < 100; ++i) {
    EXPECT_THAT(ErrorOf([&] { ExportHdf5(TwoJoints(), h5_); }),
                HasSubstr("No space left on device"));
    std::filesystem::create_symlink("/dev/full", h5_.string() + ".part");
  }
  EXPECT_EQ(open_files(), before);
}

TEST_F(Export, TheSameRecordingGivesTheSameBytes) {
  ExportHdf5(TwoJoints(), h5_);
  const std::string first = ReadText(h5_);
  ExportHdf5(TwoJoints(), h5_, true);
  EXPECT_EQ(ReadText(h5_), first);
}

TEST_F(Export, ASignalInThePlaceOfNumbersIsNamed) {
  const auto signal = [](const char* path) {
    return RecordedSignal{{path, "double", {""}, {""}}, {}, Eigen::MatrixXd(1, 0)};
  };
  for (const Recording& run : {Recording({signal("a"), signal("a.data.b")}, {}),
                               Recording({signal("a.data.b"), signal("a")}, {})})
    EXPECT_EQ(ErrorOf([&] { ExportHdf5(run, h5_); }),
              "cannot write " + h5_.string() +
                  ": the numbers of 'a' and the signal 'a.data.b' would both be /a/data");
  ExportHdf5(Recording({signal("a"), signal("a.database"), signal("b.a")}, {}), h5_);
}

TEST_F(Export, APathThatGivesNoGroupIsNamed) {
  const Recording run({{{"a..b", "double", {""}, {""}}, {}, Eigen::MatrixXd(1, 0)}}, {});
  EXPECT_EQ(ErrorOf([&] { ExportHdf5(run, h5_); }),
            "cannot write " + h5_.string() +
                ": a signal's path must be names with dots between them, got 'a..b'");
}

}  // namespace
}  // namespace pliant
