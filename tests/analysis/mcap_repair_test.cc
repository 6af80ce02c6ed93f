#include "pliant/analysis/mcap_repair.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "pliant/analysis/mcap_reader.h"
#include "pliant/analysis/recording.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/mcap_bytes.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMs = 1'000'000;
enum Op { Chunk = 6, DataEnd = 15 };

class RepairLogTest : public testing::Test {
 protected:
  LogRepair Repair(const std::string& bytes) {
    std::ofstream(from_, std::ios::binary) << bytes;
    const LogRepair repair = RepairLog(from_, to_, true);
    EXPECT_EQ(ReadText(from_), bytes);
    return repair;
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path from_ = directory_.path() / "cut.mcap";
  const std::filesystem::path to_ = directory_.path() / "whole.mcap";
};

std::size_t MessagesIn(const std::filesystem::path& log) {
  std::size_t count = 0;
  McapReader(log).ForEach({}, [&](const McapMessage&) { ++count; });
  return count;
}

TEST_F(RepairLogTest, CopiesAWholeLogOfAnyLayoutMessageByMessage) {
  for (const char* name :
       {"plain", "zstd", "lz4", "no_chunks", "no_index", "no_statistics", "mcap_log", "foreign"}) {
    SCOPED_TRACE(name);
    const std::string bytes = ReadText(LogOf(name + std::string(".mcap")));
    const LogRepair repair = Repair(bytes);
    EXPECT_TRUE(repair.whole()) << repair.text();
    EXPECT_EQ(repair.bytes_lost, 0u);

    const McapReader before(from_), after(to_);
    EXPECT_TRUE(after.indexed());
    EXPECT_EQ(after.metadata(), before.metadata());
    EXPECT_EQ(after.library(), before.library());
    const auto all = [](const McapReader& log) {
      std::string text;
      log.ForEach({}, [&](const McapMessage& m) {
        text += m.channel.topic + ' ' + m.channel.schema_name + ' ' + Text(m.sequence) + ' ' +
                Text(m.log_time) + ' ' + Text(m.publish_time) + ' ';
        text.append(reinterpret_cast<const char*>(m.data.data()), m.data.size());
      });
      return text;
    };
    EXPECT_EQ(all(after), all(before));
  }
}

TEST_F(RepairLogTest, KeepsTheChunksBeforeTheCut) {
  const std::string bytes = ReadText(LogOf("mcap_log.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk);
  const LogRepair none = Repair(bytes.substr(0, chunk.end() - 1));
  EXPECT_EQ(none.messages, 0u);
  EXPECT_EQ(none.chunks_lost, 0u);
  EXPECT_EQ(none.bytes_lost, chunk.length + 8);
  EXPECT_EQ(MessagesIn(to_), 0u);

  const LogRepair all = Repair(bytes.substr(0, chunk.end()));
  EXPECT_EQ(all.messages, 105u);
  EXPECT_EQ(all.text(),
            "kept 105 messages in 1 chunk\nlost 0 bytes after 0.049 s: " + from_.string() +
                ": at byte " + std::to_string(chunk.end()) + ": the file ends without a footer");
  const McapReader log(to_);
  EXPECT_EQ(log.metadata().at("pliant").at("seed"), "7");
  EXPECT_EQ(log.metadata().at("repair").at("messages kept"), "105");
}

TEST_F(RepairLogTest, SaysThatOnlyTheIndexIsLost) {
  const std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes data_end = RecordOf(bytes, DataEnd);
  EXPECT_THAT(
      Repair(bytes.substr(0, data_end.end() + 3)).text(),
      testing::EndsWith("within a record; all data come before it, only the index is lost"));
}

TEST_F(RepairLogTest, BelievesNoMessageWithoutCrcInADamagedLog) {
  std::string bytes = ReadText(LogOf("plain.mcap"));
  const McapBytes first = RecordOf(bytes, Chunk), second = RecordOf(bytes, Chunk, 1);
  Overwrite(bytes, first.at + 9 + 24, std::uint32_t{0});  // its CRC
  EXPECT_EQ(Repair(bytes).messages, 56u - 18u);  // the CRC of all data shows that there is damage
  bytes[second.end() - 1] ^= 1;
  const LogRepair repair = Repair(bytes);
  EXPECT_EQ(repair.chunks_lost, 2u);
  EXPECT_THAT(repair.text(), HasSubstr(": messages without a CRC in a damaged log"));
}

TEST_F(RepairLogTest, SkipsADamagedChunkAndSaysWhatIsLost) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk, 1);
  bytes[chunk.end() - 30] ^= 0x55;
  const LogRepair repair = Repair(bytes);
  EXPECT_EQ(repair.chunks, 2u);
  EXPECT_EQ(repair.chunks_lost, 1u);
  EXPECT_EQ(repair.messages, 26u);
  ASSERT_EQ(repair.lost.size(), 1u);
  const LostPart& lost = repair.lost[0];
  EXPECT_EQ(lost.at, chunk.at);
  EXPECT_EQ(lost.bytes, chunk.length + 9);
  EXPECT_EQ(lost.after, 14 * kMs);
  EXPECT_EQ(lost.before, 42 * kMs);
  EXPECT_THAT(lost.fault, HasSubstr("the chunk"));
  EXPECT_EQ(Recording::Read(to_).signals().size(), 2u);
}

TEST_F(RepairLogTest, FindsTheNextChunkBehindBytesThatAreNoRecords) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes first = RecordOf(bytes, Chunk), second = RecordOf(bytes, Chunk, 1);
  bytes.replace(first.at, second.at - first.at, std::string(1000, '\x06'));
  const LogRepair repair = Repair(bytes);
  EXPECT_EQ(repair.chunks, 2u);
  EXPECT_EQ(repair.bytes_lost, 1000u);
  EXPECT_EQ(repair.lost.at(0).after, std::nullopt);
  EXPECT_EQ(repair.lost.at(0).before, 15 * kMs);
  // The channels were in the chunk that is lost; the index has them too.
  EXPECT_EQ(Recording::Read(to_)["arm.measured_velocity"].times(0), 0.015);
}

TEST_F(RepairLogTest, CountsMessagesWhoseChannelIsLost) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes first = RecordOf(bytes, Chunk), last = RecordOf(bytes, Chunk, 2);
  bytes.erase(last.at);  // and with it the index
  bytes.erase(first.at, 9 + first.length);
  const LogRepair repair = Repair(bytes);
  EXPECT_EQ(repair.messages, 0u);
  EXPECT_EQ(repair.messages_lost, 30u);
  EXPECT_THAT(repair.text(), HasSubstr("\nlost 30 messages of unknown channels\n"));
}

TEST_F(RepairLogTest, IsNotHeldUpByAGreatHole) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes second = RecordOf(bytes, Chunk, 1);
  bytes.insert(second.at, std::string(8 << 20, '\x06'));  // might each begin a chunk
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(Repair(bytes).chunks, 3u);
  // Most of a second, and minutes if at each byte something is thrown or a block is read.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(RepairLogTest, WritesOverAnotherFileOnlyByForceAndNeverOverItsOwn) {
  std::ofstream(to_) << "old";
  EXPECT_EQ(ErrorOf([&] { RepairLog(LogOf("zstd.mcap"), to_); }),
            to_.string() + " exists; give --force to write over it, or another place");
  EXPECT_EQ(ReadText(to_), "old");
  Repair(ReadText(LogOf("zstd.mcap")));
  EXPECT_EQ(ErrorOf([&] { RepairLog(to_, to_, true); }),
            "cannot repair " + to_.string() + " in its place; name another file to write");
  EXPECT_EQ(MessagesIn(to_), 56u);
}

TEST_F(RepairLogTest, AFullDiskLeavesTheOlderFileAsItWas) {
  std::ofstream(to_) << "old";
  std::filesystem::create_symlink("/dev/full", to_.string() + ".part");
  EXPECT_EQ(ErrorOf([&] { RepairLog(LogOf("zstd.mcap"), to_, true); }),
            "cannot write " + to_.string() + ": No space left on device");
  EXPECT_EQ(ReadText(to_), "old");
}

TEST_F(RepairLogTest, RefusesAFileThatIsNoLog) {
  std::ofstream(from_) << "no log";
  EXPECT_THAT(ErrorOf([&] { RepairLog(from_, to_); }), HasSubstr("not an MCAP file"));
  EXPECT_FALSE(std::filesystem::exists(to_));
}

}  // namespace
}  // namespace pliant
