#include "pliant/plants/kortex_frame.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "pliant/tests/support/error_of.h"

namespace pliant::kortex {
namespace {

using Bytes = std::vector<std::byte>;

Bytes Of(std::initializer_list<int> numbers) {
  Bytes bytes;
  for (const int n : numbers) bytes.push_back(static_cast<std::byte>(n));
  return bytes;
}

Bytes Written(const Header& header, const Bytes& payload) {
  Bytes out(payload.size() + kEnvelope);
  out.resize(WriteFrame(header, payload, out));
  return out;
}

Bytes Payload(const Frame& frame) { return {frame.payload.begin(), frame.payload.end()}; }

// By hand, from the bits and protobuf's rules: tags 0A and 12 with lengths, 0D 15 1D 25 with words
// of four bytes, the lowest first.
const Header kRequest{.device = 3, .session = 0x1234, .id = 0x0102, .function = Function(0xa0007)};
const Bytes kRequestBytes = Of({0x0A, 0x14,                    //
                                0x0D, 0x00, 0x00, 0x03, 0x11,  // 0x11030000
                                0x15, 0x02, 0x01, 0x34, 0x12,  // 0x12340102
                                0x1D, 0x07, 0x00, 0x0A, 0x10,  // 0x100a0007
                                0x25, 0x02, 0x00, 0x00, 0x00,  // two bytes
                                0x12, 0x02, 0x08, 0x03});      // TORQUE

TEST(KortexFrame, IsWhatTheProtocolSaysByteForByte) {
  EXPECT_EQ(Written(kRequest, Of({0x08, 0x03})), kRequestBytes);
  const auto frame = ReadFrame(kRequestBytes);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header, kRequest);
  EXPECT_EQ(Payload(*frame), Of({0x08, 0x03}));
}

TEST(KortexFrame, WithoutAPayloadEndsBehindItsHeader) {
  const Header refused{.type = FrameType::Response,
                       .error = 3,
                       .error_code = 75,
                       .session = 7,
                       .id = 65535,
                       .function = Function::SetServoingMode};
  const Bytes bytes = Of({0x0A, 0x14,                    //
                          0x0D, 0x4B, 0x30, 0x00, 0x13,  // 0x1300304b
                          0x15, 0xFF, 0xFF, 0x07, 0x00,  //
                          0x1D, 0x98, 0x00, 0x02, 0x10,  //
                          0x25, 0x00, 0x00, 0x00, 0x00});
  EXPECT_EQ(Written(refused, {}), bytes);
  ASSERT_TRUE(ReadFrame(bytes));
  EXPECT_EQ(ReadFrame(bytes)->header, refused);
}

TEST(KortexFrame, InAStreamFollowsAMarkAndItsLength) {
  Bytes expected = Of({7, 'x', 'E', 't', 'R', 'o', 'K', 7, 0, 0, 0, 26});
  expected.insert(expected.end(), kRequestBytes.begin(), kRequestBytes.end());
  EXPECT_EQ(InStream(kRequest, Of({0x08, 0x03})), expected);
}

TEST(KortexFrame, IsReadThoughItHasFieldsThatNobodyKnows) {
  Bytes bytes = kRequestBytes;
  const Bytes more = Of({0x18, 0x96, 0x01, 0x22, 0x01, 0x00, 0x2D, 1, 2, 3, 4});
  bytes.insert(bytes.end(), more.begin(), more.end());
  ASSERT_TRUE(ReadFrame(bytes));
  EXPECT_EQ(ReadFrame(bytes)->header, kRequest);
}

TEST(KortexFrame, IsNoneOfAnotherVersionOrLength) {
  Bytes version = kRequestBytes;
  version[6] = std::byte(0x21);
  EXPECT_FALSE(ReadFrame(version));
  for (const int wrong : {0, 1, 3, 255}) {
    Bytes length = kRequestBytes;
    length[18] = static_cast<std::byte>(wrong);
    EXPECT_FALSE(ReadFrame(length)) << wrong;
  }
  EXPECT_FALSE(ReadFrame({}));
  for (std::size_t size = 0; size < kRequestBytes.size(); ++size)
    EXPECT_FALSE(ReadFrame(std::span(kRequestBytes).first(size))) << size;
}

TEST(KortexFrame, IsNotWrittenWhereThereIsNoRoom) {
  Bytes out(kEnvelope + 1);
  EXPECT_EQ(WriteFrame(kRequest, Of({1, 2}), out), 0U);
  Bytes large(70000);
  EXPECT_EQ(WriteFrame(kRequest, std::span(large).first(kLargestFrame - kEnvelope + 1), large), 0U);
}

class Dice {
 public:
  explicit Dice(unsigned seed) : random_{seed} {}
  std::size_t To(std::size_t most) {
    return std::uniform_int_distribution<std::size_t>(0, most)(random_);
  }
  std::byte Byte() { return static_cast<std::byte>(To(255)); }
  Bytes Some(std::size_t most) {
    Bytes bytes(To(most));
    for (std::byte& b : bytes) b = Byte();
    return bytes;
  }
  Header AnyHeader() {
    return {.type = static_cast<FrameType>(To(15)),
            .device = static_cast<std::uint8_t>(To(255)),
            .error = static_cast<std::uint8_t>(To(15)),
            .error_code = static_cast<std::uint16_t>(To(4095)),
            .session = static_cast<std::uint16_t>(To(65535)),
            .id = static_cast<std::uint16_t>(To(65535)),
            .function = static_cast<Function>(To((1 << 28) - 1))};
  }

 private:
  std::mt19937 random_;
};

TEST(KortexFrame, ComesBackAsItWas) {
  Dice dice(1);
  for (int i = 0; i < 10'000; ++i) {
    const Header header = dice.AnyHeader();
    const Bytes payload = dice.Some(300);
    const Bytes bytes = Written(header, payload);
    const auto frame = ReadFrame(bytes);
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->header, header);
    ASSERT_EQ(Payload(*frame), payload);
  }
}

TEST(KortexFrame, OfAStreamComesBackHoweverItIsCut) {
  Dice dice(2);
  FrameStream stream;
  Bytes sent;
  std::vector<Bytes> frames;
  for (int i = 0; i < 300; ++i) {
    const Header header = dice.AnyHeader();
    const Bytes payload = dice.Some(2000);
    frames.push_back(Written(header, payload));
    const Bytes bytes = InStream(header, payload);
    sent.insert(sent.end(), bytes.begin(), bytes.end());
  }
  std::size_t found = 0;
  for (std::size_t at = 0; at < sent.size();) {
    const std::span<std::byte> room = stream.Room();
    const std::size_t size = std::min({dice.To(1500), room.size(), sent.size() - at});
    std::memcpy(room.data(), sent.data() + at, size);
    stream.Filled(size);
    at += size;
    while (const auto frame = stream.Next()) {
      ASSERT_LT(found, frames.size());
      ASSERT_TRUE(std::ranges::equal(*frame, frames[found++]));
    }
  }
  EXPECT_EQ(found, frames.size());
}

std::string FaultOf(const Bytes& bytes) {
  FrameStream stream;
  const std::span<std::byte> room = stream.Room();
  std::memcpy(room.data(), bytes.data(), bytes.size());
  stream.Filled(bytes.size());
  return ErrorOf([&] { stream.Next(); });
}

TEST(KortexFrame, OfAStreamOutOfStepIsAnError) {
  EXPECT_EQ(FaultOf(Of({7, 'x', 'X'})),
            "the stream of frames is out of step: expected 07 \"xEtRoK\" 07 before a frame");
  EXPECT_EQ(FaultOf(Of({7, 'x', 'E', 't', 'R', 'o', 'K', 7, 0xFF, 0xFF, 0xFF, 0xFF})),
            "a frame must be no longer than 65507 bytes, got 4294967295");
  EXPECT_EQ(FaultOf(Of({7, 'x', 'E'})), "no error");
}

/// Changes, adds or takes away some of the bytes.
Bytes Mutated(Bytes bytes, Dice& dice) {
  for (std::size_t n = 1 + dice.To(3); n > 0; --n) {
    const std::size_t at = bytes.empty() ? 0 : dice.To(bytes.size() - 1);
    const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (dice.To(3)) {
      case 0:
        bytes.insert(place, dice.Byte());
        break;
      case 1:
        if (!bytes.empty()) bytes.erase(place);
        break;
      case 2:
        bytes.resize(at);
        break;
      default:
        if (!bytes.empty()) bytes[at] = dice.Byte();
    }
  }
  return bytes;
}

/// The length in the fourth word of a header, wherever it stands, is the payload's, or it is none.
void ReadsNoLie(const Bytes& bytes) {
  const auto frame = ReadFrame(bytes);
  if (!frame) return;
  if (!frame->payload.empty()) {
    ASSERT_GE(frame->payload.data(), bytes.data());
    ASSERT_LE(frame->payload.data() + frame->payload.size(), bytes.data() + bytes.size());
  }
  // What was understood is a frame that says the same.
  const Bytes payload = Payload(*frame);
  const Bytes again = Written(frame->header, payload);
  const auto same = ReadFrame(again);
  ASSERT_TRUE(same);
  ASSERT_EQ(same->header, frame->header);
  ASSERT_EQ(Payload(*same), payload);
}

TEST(KortexFrame, SurvivesAnyBytes) {
  Dice dice(3);
  for (int i = 0; i < 100'000; ++i) {
    const Bytes bytes =
        i % 4 == 0 ? dice.Some(80) : Mutated(Written(dice.AnyHeader(), dice.Some(40)), dice);
    ReadsNoLie(bytes);
    if (HasFatalFailure()) FAIL() << "string " << i;
  }
}

TEST(KortexFrame, OfAStreamSurvivesAnyBytes) {
  Dice dice(4);
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes;
    for (int n = 0; n < 2; ++n) {
      const Bytes more = InStream(dice.AnyHeader(), dice.Some(20));
      bytes.insert(bytes.end(), more.begin(), more.end());
    }
    bytes = i % 4 == 0 ? dice.Some(80) : Mutated(bytes, dice);
    FrameStream stream;
    const std::span<std::byte> room = stream.Room();
    ASSERT_LE(bytes.size(), room.size());
    std::copy(bytes.begin(), bytes.end(), room.begin());
    stream.Filled(bytes.size());
    std::size_t told = 0;
    try {
      while (const auto frame = stream.Next()) {
        told += frame->size() + 12;  // the mark and the length
        ReadsNoLie({frame->begin(), frame->end()});
      }
    } catch (const Error&) {
      continue;
    }
    ASSERT_LE(told, bytes.size());
  }
}

}  // namespace
}  // namespace pliant::kortex
