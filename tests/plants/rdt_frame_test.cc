#include "pliant/plants/rdt_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace pliant {
namespace {

std::vector<std::uint8_t> Bytes(std::initializer_list<int> numbers) {
  std::vector<std::uint8_t> bytes;
  for (const int number : numbers) bytes.push_back(static_cast<std::uint8_t>(number));
  return bytes;
}

template <std::size_t N>
std::vector<std::uint8_t> Bytes(const std::array<std::uint8_t, N>& bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(RdtFrame, RequestsAreTheManuals) {
  EXPECT_EQ(Bytes(Encode(RdtRequest{})), Bytes({0x12, 0x34, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(Bytes(Encode(RdtRequest{RdtCommand::Stop, 0})), Bytes({0x12, 0x34, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(Bytes(Encode(RdtRequest{RdtCommand::Bias, 0x01020304})),
            Bytes({0x12, 0x34, 0, 0x42, 1, 2, 3, 4}));
}

// 1 000 000 is 0x000f4240 and −2 is 0xfffffffe.
TEST(RdtFrame, RecordsAreBigEndian) {
  const RdtRecord record{0x01020304, 5, 0x80020000, {1000000, -2, 0, 256, -1, 1}};
  const std::vector<std::uint8_t> bytes =
      Bytes({1,    2,    3, 4, 0, 0, 0, 5, 0x80, 2, 0,    0,    0,    0x0f, 0x42, 0x40, 0xff, 0xff,
             0xff, 0xfe, 0, 0, 0, 0, 0, 0, 1,    0, 0xff, 0xff, 0xff, 0xff, 0,    0,    0,    1});
  EXPECT_EQ(Bytes(Encode(record)), bytes);
  EXPECT_EQ(DecodeRdtRecord(bytes), record);
}

TEST(RdtFrame, WhatIsEncodedIsDecoded) {
  std::mt19937 random(3);
  const auto number = [&] { return static_cast<std::uint32_t>(random()); };
  for (int k = 0; k < 10000; ++k) {
    RdtRecord record{number(), number(), number(), {}};
    for (std::int32_t& count : record.counts) count = static_cast<std::int32_t>(number());
    ASSERT_EQ(DecodeRdtRecord(Encode(record)), record);
    const RdtRequest request{static_cast<RdtCommand>(number() & 0xffff), number()};
    ASSERT_EQ(DecodeRdtRequest(Encode(request)), request);
  }
}

TEST(RdtFrame, BytesThatAreNoneAreRefused) {
  const auto record = Encode(RdtRecord{});
  const auto request = Encode(RdtRequest{});
  for (std::size_t size = 0; size < record.size(); ++size)
    EXPECT_FALSE(DecodeRdtRecord(std::span(record).first(size))) << size;
  EXPECT_FALSE(DecodeRdtRecord(std::vector<std::uint8_t>(37)));
  for (std::size_t size = 0; size < request.size(); ++size)
    EXPECT_FALSE(DecodeRdtRequest(std::span(request).first(size))) << size;
  EXPECT_FALSE(DecodeRdtRequest(std::vector<std::uint8_t>(9)));
  EXPECT_FALSE(DecodeRdtRequest(Bytes({0x12, 0x35, 0, 2, 0, 0, 0, 0})));
}

TEST(RdtFrame, CountsAreForcesAndTorquesAsTheSensorIsSet) {
  const RdtScale scale{.counts_per_newton = 1000, .counts_per_newton_meter = 20};
  EXPECT_EQ(scale.WrenchOf({1000, -2000, 500, 20, -40, 10}), Wrench({1, -2, 0.5, 1, -2, 0.5}));
  EXPECT_EQ(scale.CountsOf({1, -2, 0.5, 1, -2, 0.5}),
            (std::array<std::int32_t, 6>{1000, -2000, 500, 20, -40, 10}));
  // To the nearest: half a count is the most that is lost.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> newtons(-500, 500);
  for (int k = 0; k < 1000; ++k) {
    Wrench W;
    for (int i = 0; i < 6; ++i) W(i) = newtons(random);
    const Wrench back = scale.WrenchOf(scale.CountsOf(W));
    ASSERT_LE((back - W).tail<3>().cwiseAbs().maxCoeff(), 0.5 / 1000 + 1e-12);
    ASSERT_LE((back - W).head<3>().cwiseAbs().maxCoeff(), 0.5 / 20 + 1e-12);
  }
}

TEST(RdtFrame, CountsEndWhereTheirNumbersDo) {
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max(), least = -most - 1;
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(RdtScale{}.CountsOf({0, 0, 0, 3000, -3000, std::nan("")}),
            (std::array<std::int32_t, 6>{most, least, most, 0, 0, 0}));
  EXPECT_EQ(RdtScale{}.CountsOf({inf, -inf, 0, 0, 0, 0}),
            (std::array<std::int32_t, 6>{0, 0, 0, most, least, 0}));
}

TEST(RdtFrame, AFaultIsAnyBitButThatOfAThreshold) {
  EXPECT_FALSE(IsRdtFault(0));
  EXPECT_FALSE(IsRdtFault(0x80010000)) << "a threshold was passed";
  EXPECT_FALSE(IsRdtFault(0x00010000));
  EXPECT_TRUE(IsRdtFault(0x80000000)) << "an error that has no bit of its own";
  for (int bit = 0; bit < 31; ++bit)
    EXPECT_EQ(IsRdtFault(0x80000000 | 1U << bit), bit != 16) << bit;
}

}  // namespace
}  // namespace pliant
