#include "pliant/analysis/mcap_reader.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/mcap_bytes.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::uint64_t kMs = 1'000'000;
enum Op { Header = 1, Footer, Schema, Channel, Message, Chunk, MessageIndex, Metadata = 12 };

class McapReaderTest : public testing::Test {
 protected:
  McapReader Open(const std::string& bytes) {
    std::ofstream(file_, std::ios::binary) << bytes;
    return McapReader(file_);
  }

  /// The fault that is seen when the file is opened or, if none, when it is read.
  std::string FaultOf(const std::string& bytes) {
    const McapReader log = Open(bytes);
    return log.fault().empty() ? ErrorOf([&] { log.ForEach({}, [](const McapMessage&) {}); })
                               : log.fault();
  }

  std::string At(std::size_t at) const {
    return file_.string() + ": at byte " + std::to_string(at) + ": ";
  }
  std::string WayOut() const {
    return "`pliant log repair " + file_.string() + "` makes a whole log of what is readable";
  }

  const TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_.path() / "run.mcap";
};

std::vector<std::uint64_t> TimesOf(const McapReader& log, const McapReader::Filter& filter) {
  std::vector<std::uint64_t> times;
  log.ForEach(filter, [&](const McapMessage& message) { times.push_back(message.log_time); });
  return times;
}

TEST(McapReader, KnowsTheSameOfALogWithAndWithoutIndex) {
  for (const char* name : {"plain", "zstd", "lz4", "no_chunks", "no_index", "no_statistics"}) {
    SCOPED_TRACE(name);
    const McapReader log(LogOf(name + std::string(".mcap")));
    EXPECT_EQ(log.fault(), "");
    EXPECT_EQ(log.indexed(),
              !std::string(name).starts_with("no_") || name == std::string("no_chunks"));
    EXPECT_EQ(log.profile(), "ros2");
    EXPECT_EQ(log.library(), "@mcap/core 2.2.2");
    EXPECT_EQ(log.messages(), 56u);
    EXPECT_EQ(log.from(), 0u);
    EXPECT_EQ(log.to(), 49 * kMs);
    EXPECT_EQ(log.metadata().at("pliant").at("seed"), "7");
    ASSERT_EQ(log.channels().size(), 3u);
    const McapChannel& velocity = log.channels()[0];
    EXPECT_EQ(velocity.topic, "/arm/measured_velocity");
    EXPECT_EQ(velocity.message_encoding, "cdr");
    EXPECT_EQ(velocity.schema_name, "pliant_msgs/msg/JointVelocity");
    EXPECT_EQ(velocity.schema_encoding, "ros2msg");
    EXPECT_EQ(velocity.schema, "float64 shoulder\nfloat64 elbow\n");
    EXPECT_EQ(velocity.messages, 50u);
    EXPECT_EQ(log.channels()[1].messages, 5u);
    EXPECT_EQ(log.channels()[2].messages, 1u);
  }
}

TEST(McapReader, GivesTheMessagesThatPass) {
  for (const char* name : {"zstd.mcap", "no_chunks.mcap", "no_index.mcap"}) {
    const McapReader log(LogOf(name));
    EXPECT_EQ(TimesOf(log, {}).size(), 56u);
    EXPECT_THAT(TimesOf(log, {.topics = {"/energy"}}),
                testing::ElementsAre(0, 10 * kMs, 20 * kMs, 30 * kMs, 40 * kMs));
    EXPECT_THAT(TimesOf(log, {.topics = {"/energy"}, .from = 10 * kMs, .to = 30 * kMs - 1}),
                testing::ElementsAre(10 * kMs, 20 * kMs));
    EXPECT_THAT(TimesOf(log, {.topics = {"/none"}}), testing::IsEmpty());
  }
}

TEST(McapReader, GivesTheErrorsOfItsUserAsTheyAre) {
  const McapReader log(LogOf("zstd.mcap"));
  EXPECT_EQ(ErrorOf([&] { log.ForEach({}, [](const McapMessage&) { throw Error("enough"); }); }),
            "enough");
}

TEST_F(McapReaderTest, SaysHowMuchOfACutLogCanBeRead) {
  const std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk, 1);
  const McapReader log = Open(bytes.substr(0, chunk.end() - 5));
  EXPECT_FALSE(log.indexed());
  EXPECT_EQ(log.messages(), 18u);
  EXPECT_EQ(log.fault(), At(chunk.at) + "the chunk has " + std::to_string(chunk.length) +
                             " bytes, but the file ends after " + std::to_string(chunk.length - 5) +
                             "\n18 messages, from 0 s to 0.014 s, can be read before it; " +
                             WayOut());
  EXPECT_EQ(ErrorOf([&] { log.ForEach({}, [](const McapMessage&) {}); }), log.fault());
}

TEST_F(McapReaderTest, SaysThatTheEndIsMissing) {
  const std::string bytes = ReadText(LogOf("zstd.mcap"));
  EXPECT_THAT(FaultOf(bytes.substr(0, RecordOf(bytes, Footer).at)),
              HasSubstr("the file ends without an index and a footer\n56 messages"));
  EXPECT_THAT(FaultOf(bytes.substr(0, 8)),
              StartsWith(At(8) + "the records end without a data end\n0 messages can be read"));
}

TEST_F(McapReaderTest, NamesTheChunkWhoseCrcIsWrong) {
  std::string bytes = ReadText(LogOf("plain.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk, 1);
  bytes[chunk.end() - 1] ^= 1;
  const McapReader log = Open(bytes);
  EXPECT_EQ(log.fault(), "");  // the index is whole
  EXPECT_THAT(FaultOf(bytes),
              testing::MatchesRegex(".*: at byte " + std::to_string(chunk.at) +
                                    ": the chunk is damaged: its CRC is 0x[0-9a-f]+,"
                                    " not 0x[0-9a-f]+\n.*pliant log repair.*"));
}

TEST_F(McapReaderTest, NamesTheChunkThatCannotBeUnpacked) {
  for (const char* name : {"zstd.mcap", "lz4.mcap"}) {
    std::string bytes = ReadText(LogOf(name));
    const McapBytes chunk = RecordOf(bytes, Chunk);
    bytes[chunk.end() - 40] ^= 0x55;
    EXPECT_THAT(FaultOf(bytes), StartsWith(At(chunk.at) + "the chunk ")) << name;

    bytes = ReadText(LogOf(name));
    Overwrite(bytes, chunk.at + 9 + 16, std::uint64_t{7});  // of the records, unpacked
    EXPECT_THAT(FaultOf(bytes), StartsWith(At(chunk.at) + "the chunk cannot be unpacked: "))
        << name;
  }
}

TEST_F(McapReaderTest, NamesAnUnknownCompression) {
  std::string bytes = ReadText(LogOf("lz4.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk);
  bytes.replace(chunk.at + 9 + 8 + 8 + 8 + 4 + 4, 3, "br\n");
  EXPECT_THAT(FaultOf(bytes),
              StartsWith(At(chunk.at) + "the chunk cannot be unpacked: its compression "
                                        "must be zstd, lz4 or empty, got 'br\\x0a'"));
}

TEST_F(McapReaderTest, RefusesAChunkOfMoreThanAGigabyte) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes chunk = RecordOf(bytes, Chunk);
  Overwrite(bytes, chunk.at + 9 + 16, std::uint64_t{1} << 40);
  EXPECT_THAT(FaultOf(bytes), StartsWith(At(chunk.at) + "the records of a chunk must have at most "
                                                        "1073741824 bytes, got 1099511627776"));
}

TEST_F(McapReaderTest, NamesTheRecordWhoseWordsAreTooLong) {
  std::string bytes = ReadText(LogOf("no_index.mcap"));
  const McapBytes metadata = RecordOf(bytes, Metadata);
  Overwrite(bytes, metadata.at + 9, std::uint32_t{5000});
  EXPECT_THAT(FaultOf(bytes), StartsWith(At(metadata.at + 13) +
                                         "the name of metadata has 5000 bytes, but its record ends "
                                         "after " +
                                         std::to_string(metadata.length - 4)));
}

TEST_F(McapReaderTest, FindsDamageInTheIndexAndOutsideOfChunks) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes footer = RecordOf(bytes, Footer);
  std::string index = bytes;
  index[footer.at - 20] ^= 1;
  EXPECT_THAT(FaultOf(index), HasSubstr("the index is damaged: wrong CRC\n56 messages"));

  const McapBytes metadata = RecordOf(bytes, Metadata);
  bytes[metadata.end() - 1] ^= 1;
  EXPECT_THAT(FaultOf(bytes), HasSubstr("the data before it are damaged: wrong CRC\n"));
}

TEST_F(McapReaderTest, RefusesAnIndexOutOfTheFile) {
  std::string bytes = ReadText(LogOf("zstd.mcap"));
  const McapBytes footer = RecordOf(bytes, Footer);
  Overwrite(bytes, footer.at + 9, ~std::uint64_t{0});
  EXPECT_THAT(FaultOf(bytes), HasSubstr("the file says byte 18446744073709551615"));
}

TEST_F(McapReaderTest, RefusesAFileThatIsNoLog) {
  EXPECT_EQ(ErrorOf([&] { Open(""); }), file_.string() + ": not an MCAP file: it is empty");
  EXPECT_THAT(ErrorOf([&] { Open("\x89MCAP1\r\n"); }), HasSubstr("it does not begin with"));
  EXPECT_EQ(ErrorOf([] { McapReader{"/dev/null"}; }), "cannot read /dev/null: it is not a file");
}

}  // namespace
}  // namespace pliant
