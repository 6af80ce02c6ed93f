#include "pliant/analysis/row_ring.h"

#include <gtest/gtest.h>

#include <random>
#include <thread>

namespace pliant::internal {
namespace {

TEST(RowRing, HandsRowsOfAnySizeToAnotherThreadInOrder) {
  constexpr int kRows = 20'000;
  constexpr std::size_t kLongest = 40;
  const auto size = [](int k) { return 1 + static_cast<std::size_t>(k) * 7919 % kLongest; };
  RowRing ring(RowRing::CellsFor(kLongest) + 5);
  std::jthread writer([&] {
    for (int k = 0; k < kRows; ++k) {
      std::span<double> row;
      while ((row = ring.Begin(k % 3, k, 2 * k, size(k))).empty()) std::this_thread::yield();
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = k + 1e-3 * static_cast<double>(i);
      ring.Commit();
    }
  });
  for (int k = 0; k < kRows; ++k) {
    std::optional<RowRing::Row> row;
    while (!(row = ring.Front())) std::this_thread::yield();
    ASSERT_EQ(row->stream, k % 3);
    ASSERT_EQ(row->time_ns, k);
    ASSERT_EQ(row->dropped, 2 * k);
    ASSERT_EQ(row->numbers.size(), size(k));
    for (std::size_t i = 0; i < size(k); ++i)
      ASSERT_EQ(row->numbers[i], k + 1e-3 * static_cast<double>(i));
    ring.Pop();
  }
  EXPECT_FALSE(ring.Front());
}

TEST(RowRing, HasRoomForALongestRowWhereverItBegins) {
  constexpr std::size_t kLongest = 10;
  for (std::size_t offset = 1; offset < 30; ++offset) {
    RowRing ring(RowRing::CellsFor(kLongest));
    for (std::size_t k = 0; k < offset; ++k) {
      ASSERT_EQ(ring.Begin(0, 0, 0, 1 + k % kLongest).size(), 1 + k % kLongest);
      ring.Commit();
      ASSERT_TRUE(ring.Front());
      ring.Pop();
    }
    EXPECT_EQ(ring.Begin(0, 0, 0, kLongest).size(), kLongest);
  }
}

TEST(RowRing, HasNoRoomWhenItIsFull) {
  RowRing ring(RowRing::CellsFor(10));  // 26 cells
  EXPECT_EQ(ring.Begin(0, 0, 0, 10).size(), 10u);
  ring.Commit();
  EXPECT_EQ(ring.Begin(0, 1, 0, 10).size(), 10u);
  ring.Commit();
  EXPECT_TRUE(ring.Begin(0, 2, 0, 1).empty());
  ASSERT_TRUE(ring.Front());
  EXPECT_TRUE(ring.Begin(0, 2, 0, 1).empty());
  ring.Pop();
  EXPECT_EQ(ring.Begin(0, 2, 0, 1).size(), 1u);
}

}  // namespace
}  // namespace pliant::internal
