// What can be read of a log on a disk that cannot be read everywhere.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <random>
#include <string>

#include "pliant/analysis/mcap_file.h"
#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/mcap_repair.h"
#include "pliant/analysis/mcap_writer.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/mcap_bytes.h"

namespace {

off_t bad_begin = 0, bad_end = 0;

}  // namespace

/// That of the system, but for bytes that no file can be read at.
extern "C" ssize_t pread(int file, void* to, std::size_t n, off_t at) {
  if (at >= bad_begin && at < bad_end) {
    errno = EIO;
    return -1;
  }
  if (at < bad_begin) n = std::min(n, static_cast<std::size_t>(bad_begin - at));
  return syscall(SYS_pread64, file, to, n, at);
}

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr std::size_t kSector = 512;
constexpr int kChunks = 10, kMessages = 20;  // of each chunk
enum Op { Chunk = 6 };

class BadSector : public testing::Test {
 protected:
  BadSector() {
    std::mt19937_64 random(1);
    internal::McapWriter log([&](std::string_view more) { bytes_ += more; }, "", "");
    const std::uint16_t channel = log.AddChannel(0, "/noise", "", {});
    for (int chunk = 0; chunk < kChunks; ++chunk, log.WriteChunk())
      for (int k = 0; k < kMessages; ++k)
        std::generate_n(log.AddMessage(channel, kMessages * chunk + k, 1000), 1000,
                        [&] { return static_cast<char>(random()); });
    log.Finish();
    std::ofstream(from_, std::ios::binary) << bytes_;
  }
  ~BadSector() override { bad_end = 0; }

  void Spoil(std::size_t at) {
    bad_begin = static_cast<off_t>(at);
    bad_end = static_cast<off_t>(at + kSector);
  }
  LogRepair Repair() {
    LogRepair repair = RepairLog(from_, to_);
    bad_end = 0;
    std::size_t messages = 0;
    McapReader(to_).ForEach({}, [&](const McapMessage&) { ++messages; });
    EXPECT_EQ(messages, repair.messages);
    return repair;
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path from_ = directory_.path() / "bad.mcap";
  const std::filesystem::path to_ = directory_.path() / "whole.mcap";
  std::string bytes_;
};

TEST_F(BadSector, GivesNoBytesThatWereNotRead) {
  const internal::McapFile file(from_);
  internal::McapWindow window(file);
  const auto is_there = [&](std::size_t at, std::size_t n) {
    return internal::TextOf(window.At(at, n)) == std::string_view(bytes_).substr(at, n);
  };
  EXPECT_TRUE(is_there(1000, 100));
  Spoil(100'000);
  for (int tries = 0; tries < 2; ++tries)
    EXPECT_EQ(ErrorOf([&] { window.At(99'990, 20); }),
              from_.string() + ": at byte 100000: cannot read: Input/output error");
  EXPECT_TRUE(is_there(99'990, 10));
  EXPECT_TRUE(is_there(1000, 100));
}

TEST_F(BadSector, WithinAChunkLosesTheChunk) {
  const McapBytes chunk = RecordOf(bytes_, Chunk, 4);
  Spoil(chunk.at + 5000);
  const LogRepair repair = Repair();
  EXPECT_EQ(repair.chunks, kChunks - 1u);
  EXPECT_EQ(repair.chunks_lost, 1u);
  ASSERT_EQ(repair.lost.size(), 1u);
  EXPECT_EQ(repair.lost[0].at, chunk.at);
  EXPECT_EQ(repair.lost[0].bytes, chunk.end() - chunk.at);
  EXPECT_THAT(repair.lost[0].fault, HasSubstr("cannot read: Input/output error"));
}

TEST_F(BadSector, AtTheFrontOfAChunkLosesAllToTheNext) {
  const McapBytes chunk = RecordOf(bytes_, Chunk, 4), next = RecordOf(bytes_, Chunk, 5);
  Spoil(chunk.at);
  const LogRepair repair = Repair();
  EXPECT_EQ(repair.chunks, kChunks - 1u);
  ASSERT_EQ(repair.lost.size(), 1u);
  EXPECT_EQ(repair.lost[0].at, chunk.at);
  EXPECT_EQ(repair.lost[0].bytes, next.at - chunk.at);
  EXPECT_EQ(repair.lost[0].after, 4u * kMessages - 1);
  EXPECT_EQ(repair.lost[0].before, 5u * kMessages);
}

TEST_F(BadSector, InTheIndexLosesNoMessage) {
  Spoil(bytes_.size() - 600);
  EXPECT_EQ(Repair().messages, static_cast<std::uint64_t>(kChunks * kMessages));
}

}  // namespace
}  // namespace pliant
