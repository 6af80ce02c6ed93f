#include "pliant/plants/bota_frame.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

namespace pliant {
namespace {

using Bytes = std::vector<std::uint8_t>;

void Append(Bytes& stream, const BotaFrame& frame) {
  const auto bytes = Encode(frame);
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}

/// What a parser finds in a stream.
struct Found {
  explicit Found(const Bytes& stream) {
    for (const std::uint8_t byte : stream)
      if (const auto frame = parser.Next(byte)) frames.push_back(*frame);
  }
  BotaParser parser;
  std::vector<BotaFrame> frames;
};

BotaFrame Numbered(std::uint32_t k) {
  return {.status = 0,
          .force = {1.5F, -2, static_cast<float>(k)},
          .torque = {0.25F, 0.5F, -0.125F},
          .timestamp_us = 1250 * k,
          .temperature = 31.5F};
}

TEST(BotaFrame, CrcIsThePublishedOne) {
  constexpr std::string_view check = "123456789";
  EXPECT_EQ(Crc16X25(Bytes(check.begin(), check.end())), 0x906E);
  EXPECT_EQ(Crc16X25({}), 0);
}

// 1.0F is 0x3f800000, −2.0F is 0xc0000000, 0.5F is 0x3f000000, 25.0F is 0x41c80000. Bit by bit the
// CRC of the 34 bytes behind the header, which this test computes on its own, is the last two.
TEST(BotaFrame, IsLittleEndianAndTheCrcIsOfWhatStandsBehindTheHeader) {
  const BotaFrame frame{.status = 0x0102,
                        .force = {1, -2, 0},
                        .torque = {0.5F, 0, 1},
                        .timestamp_us = 0x0A0B0C0D,
                        .temperature = 25};
  Bytes expected{0xAA, 0x02, 0x01, 0,    0,    0x80, 0x3f, 0, 0, 0,    0xc0, 0,
                 0,    0,    0,    0,    0,    0,    0x3f, 0, 0, 0,    0,    0,
                 0,    0x80, 0x3f, 0x0D, 0x0C, 0x0B, 0x0A, 0, 0, 0xc8, 0x41};
  ASSERT_EQ(expected.size(), 35U);
  unsigned crc = 0xFFFF;
  for (std::size_t i = 1; i < 35; ++i)
    for (int bit = 0; bit < 8; ++bit) {
      const unsigned feedback = (crc ^ static_cast<unsigned>(expected[i]) >> bit) & 1;
      crc = crc >> 1 ^ (feedback ? 0x8408U : 0U);
    }
  crc ^= 0xFFFF;
  expected.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  expected.push_back(static_cast<std::uint8_t>(crc >> 8));
  const auto bytes = Encode(frame);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), expected);
}

TEST(BotaFrame, WhatIsEncodedIsParsed) {
  std::mt19937 random(11);
  const auto word = [&] { return static_cast<std::uint32_t>(random()); };
  for (int k = 0; k < 10000; ++k) {
    BotaFrame frame;
    frame.status = static_cast<std::uint16_t>(word());
    // Any bits but those of NaN, which is not equal to itself.
    const auto number = [&] { return std::bit_cast<float>(word() & 0xbfffffff); };
    for (float& x : frame.force) x = number();
    for (float& x : frame.torque) x = number();
    frame.timestamp_us = word();
    frame.temperature = number();
    Bytes stream;
    Append(stream, frame);
    const Found found(stream);
    ASSERT_EQ(found.frames, std::vector{frame});
    ASSERT_EQ(found.parser.corrupted(), 0U);
  }
}

// A CRC of 16 bits finds every single wrong bit, and a header with one is no header.
TEST(BotaFrame, EverySingleWrongBitIsRefusedAndCostsNoOtherFrame) {
  const auto whole = Encode(Numbered(2));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes stream;
    Append(stream, Numbered(1));
    const std::size_t at = stream.size();
    Append(stream, Numbered(2));
    stream[at + bit / 8] = static_cast<std::uint8_t>(stream[at + bit / 8] ^ 1U << bit % 8);
    Append(stream, Numbered(3));
    const Found found(stream);
    ASSERT_EQ(found.frames, (std::vector{Numbered(1), Numbered(3)})) << "bit " << bit;
    ASSERT_EQ(found.parser.corrupted(), 1U) << "bit " << bit;
  }
}

TEST(BotaFrame, IsFoundWhereverTheStreamBegins) {
  Bytes stream;
  for (std::uint32_t k = 0; k < 4; ++k) Append(stream, Numbered(k));
  for (std::size_t cut = 0; cut <= kBotaFrameBytes; ++cut) {
    const Found found(Bytes(stream.begin() + static_cast<std::ptrdiff_t>(cut), stream.end()));
    ASSERT_EQ(found.frames.size(), cut == 0 ? 4U : 3U) << cut;
    ASSERT_EQ(found.frames.back(), Numbered(3));
    ASSERT_EQ(found.parser.corrupted(), 0U) << "the rest of a frame is none that is corrupted";
  }
}

// Junk without a header can hide nothing. Junk with headers could by chance, once in 2¹⁶ headers;
// with this seed it does not.
TEST(BotaFrame, IsFoundBetweenJunk) {
  std::mt19937 random(17);
  Bytes stream;
  std::vector<BotaFrame> sent;
  for (std::uint32_t k = 0; k < 1000; ++k) {
    const std::size_t junk = random() % 100;
    for (std::size_t i = 0; i < junk; ++i) {
      const auto byte = static_cast<std::uint8_t>(random());
      stream.push_back(random() % 4 == 0 ? kBotaHeader : byte);
    }
    sent.push_back(Numbered(k));
    Append(stream, sent.back());
  }
  EXPECT_EQ(Found(stream).frames, sent);
}

TEST(BotaFrame, CountsStretchesOfJunkByTheFrame) {
  Bytes stream;
  Append(stream, Numbered(1));
  stream.resize(stream.size() + 1);  // one byte: part of a frame
  Append(stream, Numbered(2));
  stream.resize(stream.size() + 37);  // one frame
  Append(stream, Numbered(3));
  stream.resize(stream.size() + 75);  // two, and one begun
  Append(stream, Numbered(4));
  const Found found(stream);
  EXPECT_EQ(found.frames.size(), 4U);
  EXPECT_EQ(found.parser.corrupted(), 1U + 1U + 3U);
}

TEST(BotaFrame, AFaultIsOverRangeInvalidOrRaw) {
  EXPECT_FALSE(IsBotaFault(0));
  EXPECT_FALSE(IsBotaFault(kBotaTooLate)) << "one was skipped; this one is good";
  for (const std::uint16_t bit : {kBotaOverRange, kBotaInvalid, kBotaRaw})
    EXPECT_TRUE(IsBotaFault(bit)) << bit;
}

TEST(BotaFrame, AnyBytesDoNoHarm) {
  std::mt19937 random(23);
  BotaParser parser;
  for (int k = 0; k < 100000; ++k) {
    const auto word = random();
    parser.Next(word % 8 == 0 ? kBotaHeader : static_cast<std::uint8_t>(word >> 8));
  }
  // Every byte is skipped, but for those held and the 36 at the start that do not count.
  EXPECT_NEAR(parser.corrupted(), 100000 / 37, 2);
}

}  // namespace
}  // namespace pliant
