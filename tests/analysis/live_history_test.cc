#include "pliant/analysis/live_history.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace pliant::internal {
namespace {

std::vector<double> Decoded(const std::string& message) {
  std::uint32_t count = 0;
  std::memcpy(&count, message.data() + 4, sizeof count);
  std::vector<double> numbers(count);
  EXPECT_EQ(message.size(), 12 + sizeof(double) * count);
  std::memcpy(numbers.data(), message.data() + 12, sizeof(double) * count);
  return numbers;
}

void AddRows(LiveHistory& history, int from, int to, std::int64_t period_ns = 1'000'000) {
  for (int k = from; k < to; ++k)
    history.Add(k * period_ns, std::array{static_cast<double>(k), -static_cast<double>(k)});
}

TEST(LiveHistory, KeepsARowInTenMilliseconds) {
  LiveHistory history(2);
  EXPECT_TRUE(history.empty());
  AddRows(history, 0, 100);
  ASSERT_EQ(history.columns().size(), 3u);
  EXPECT_EQ(history.columns()[0].size(), 10u);
  EXPECT_EQ(history.columns()[1][3], 30);
  EXPECT_EQ(history.columns()[2][3], -30);
}

TEST(LiveHistory, TellsEachRowOnceAndTheLastTenSecondsToWhoComesLater) {
  LiveHistory history(2);
  EXPECT_EQ(history.Fresh(), "");
  EXPECT_EQ(history.Tail(), "");
  AddRows(history, 0, 31);
  EXPECT_EQ(Decoded(history.Fresh()),
            (std::vector<double>{0, 0, -0.0, 1e-9 * 10e6, 10, -10, 1e-9 * 20e6, 20, -20,
                                 1e-9 * 30e6, 30, -30}));
  EXPECT_EQ(history.Fresh(), "");
  AddRows(history, 31, 41);
  EXPECT_EQ(Decoded(history.Fresh()), (std::vector<double>{1e-9 * 40e6, 40, -40}));
  AddRows(history, 41, 15'001);
  const std::vector<double> tail = Decoded(history.Tail());
  EXPECT_EQ(tail.size() / 3, 1001u);
  EXPECT_DOUBLE_EQ(tail.front(), 5);
}

TEST(LiveHistory, HoldsALongRunInABoundedNumberOfRowsFromItsStart) {
  LiveHistory history(2);
  AddRows(history, 0, 100'000, 10'000'000);
  EXPECT_LT(history.columns()[0].size(), 20'000u);
  EXPECT_GE(history.columns()[0].size(), 10'000u);
  EXPECT_EQ(history.columns()[0].front(), 0);
  EXPECT_NEAR(history.columns()[0].back(), 1000, 0.25);  // within a bin of Decimate
  const auto& values = history.columns()[1];
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), 99'999);
}

}  // namespace
}  // namespace pliant::internal
