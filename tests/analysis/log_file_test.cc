#include "pliant/analysis/log_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <thread>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant::internal {
namespace {

TEST(LogFile, SaysThatHalfARecordStaysInAPipe) {
  const TemporaryDirectory directory;
  const std::filesystem::path pipe = directory.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  LogFile file(pipe, true);
  file.Write("whole");
  std::string error;
  {
    const std::jthread writer(
        [&] { error = ErrorOf([&] { file.Write(std::string(1 << 20, 'x')); }); });
    // More than the first record: the second has begun, and a pipe does not hold it all.
    for (int waiting = 0; waiting <= 5;) ioctl(reader, FIONREAD, &waiting);
    close(reader);
  }
  std::signal(SIGPIPE, handler);
  EXPECT_EQ(error, "cannot write " + pipe.string() +
                       ": Broken pipe; half a record stays at its end, from byte 5 on");
  EXPECT_EQ(file.size(), 5);
}

}  // namespace
}  // namespace pliant::internal
