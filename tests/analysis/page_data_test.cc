#include "pliant/analysis/page_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "pliant/systems/random.h"
#include "pliant/tests/support/error_of.h"

// That a page reads what PageData writes is tested by web/test/page_data_test.mjs.

namespace pliant::internal {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<double> Times(std::size_t rows) {
  std::vector<double> times;
  for (std::size_t i = 0; i < rows; ++i) times.push_back(1e-3 * static_cast<double>(i));
  return times;
}

std::vector<double> Noise(std::size_t rows, std::uint64_t seed) {
  const RandomStream noise{seed};
  std::vector<double> values;
  for (std::size_t i = 0; i < rows; ++i) values.push_back(noise.Normal(i));
  return values;
}

TEST(PageData, ASmoothCurveTakesAByteOfEach) {
  std::vector<double> sine;
  for (const double t : Times(10000)) sine.push_back(std::sin(2 * std::numbers::pi * 0.1 * t));
  // Second differences of (1 kHz, 0.1 Hz, 24 bits) are below 2²³ (2π 1e-4)² + 2 = 5.3 codes: less
  // than 4 bits, and base64 writes 8 for 6.
  EXPECT_LT(PageData({Times(10000), sine}).size(), 10000 * 4.0 / 6.0 + 500);
}

TEST(PageData, AUniformTimeTakesAlmostNothing) {
  EXPECT_LT(PageData({Times(60000)}).size(), 800u);  // 480 000 zeros, deflated 1000 to 1
}

TEST(PageData, IsTheSameForTheSameColumns) {
  EXPECT_EQ(PageData({Times(100), Noise(100, 1)}), PageData({Times(100), Noise(100, 1)}));
}

TEST(PageData, RefusesColumnsThatDifferInLength) {
  EXPECT_EQ(ErrorOf([] {
              PageData({{0, 1}, {0, 1}, {0}});
            }),
            "page data: column 2 must have as many rows as the time, 2, got 1");
  EXPECT_EQ(ErrorOf([] { PageData({}); }),
            "page data: the first column must be the time; there is no column");
}

TEST(PageData, RefusesATimeThatIsNone) {
  EXPECT_EQ(ErrorOf([] {
              PageData({{0, kNone}});
            }),
            "page data: the time of row 1 must be finite and within 104 days, got nan");
  EXPECT_EQ(ErrorOf([] {
              PageData({{0, 1e8}});
            }),
            "page data: the time of row 1 must be finite and within 104 days, got 100000000");
  EXPECT_EQ(ErrorOf([] {
              PageData({{0, 2, 1}});
            }),
            "page data: the time of row 2 must be ≥ the one before, 2, got 1");
}

TEST(PageData, RefusesAnotherNumberOfBits) {
  EXPECT_EQ(ErrorOf([] { PageData({{0, 1}}, 12); }), "page data: bits must be 16 or 24, got 12");
}

TEST(Decimate, KeepsWhatFits) {
  const PageColumns columns{Times(10), Noise(10, 1)};
  const Decimated same = Decimate(columns, 10);
  EXPECT_EQ(same.columns, columns);
  EXPECT_EQ(same.sentence, "every value is shown");
}

TEST(Decimate, KeepsLeastAndGreatestInTheirOrder) {
  const PageColumns columns{{0.000, 0.001, 0.002, 0.003, 0.004, 0.005, 0.006, 0.007, 0.008},
                            {0, 1, 2, 3, 7, 6, 5, 4, 9},
                            {0, 5, -5, 0, 1, 1, 1, 1, 2}};
  const Decimated fewer = Decimate(columns, 6);
  EXPECT_THAT(fewer.columns[0], ElementsAre(0, 0.001, 0.003, 0.004, 0.006, 0.007));
  EXPECT_THAT(fewer.columns[1], ElementsAre(0, 2, 3, 7, 4, 9));
  EXPECT_THAT(fewer.columns[2], ElementsAre(5, -5, 0, 1, 1, 2));
  EXPECT_EQ(fewer.sentence, "plots show the least and greatest of every 3 ms");
}

TEST(Decimate, LosesNoPeakOfRandomColumns) {
  for (const std::size_t rows : {2, 3, 10, 97, 500, 999}) {
    const PageColumns columns{Times(1000), Noise(1000, rows)};
    const Decimated fewer = Decimate(columns, rows);
    EXPECT_LE(fewer.columns[0].size(), rows);
    EXPECT_EQ(fewer.columns[1].size(), fewer.columns[0].size());
    EXPECT_TRUE(std::ranges::is_sorted(fewer.columns[0]));
    EXPECT_EQ(std::ranges::max(fewer.columns[1]), std::ranges::max(columns[1]));
    EXPECT_EQ(std::ranges::min(fewer.columns[1]), std::ranges::min(columns[1]));
  }
}

TEST(Decimate, ShowsAGapOnlyWhereThereIsNothingElse) {
  const Decimated fewer =
      Decimate({{0, 1, 2, 3, 4, 5, 6, 7}, {kNone, 1, 2, kNone, kNone, kNone, kNone, kNone}}, 4);
  EXPECT_EQ(fewer.columns[1][0], 1);
  EXPECT_EQ(fewer.columns[1][1], 2);
  EXPECT_TRUE(std::isnan(fewer.columns[1][2]));
  EXPECT_TRUE(std::isnan(fewer.columns[1][3]));
  EXPECT_EQ(fewer.sentence, "plots show the least and greatest of every 4 s");
}

TEST(Decimate, CountsRowsWhenTheTimeIsNotUniform) {
  EXPECT_EQ(Decimate({{0, 1, 1.5, 7, 8, 9}}, 4).sentence,
            "plots show the least and greatest of every 3 rows");
}

TEST(Decimate, RefusesLessThanOneBin) {
  EXPECT_EQ(ErrorOf([] {
              Decimate({{0, 1, 2}}, 1);
            }),
            "page data: there must be room for 2 rows, got 1");
}

TEST(FitPageData, KeepsAllThatFits) {
  const PageColumns columns{Times(1000), Noise(1000, 1)};
  const FittedData fitted = FitPageData(columns, 100000);
  EXPECT_EQ(fitted.text, PageData(columns, 24));
  EXPECT_EQ(fitted.rows, 1000u);
  EXPECT_EQ(fitted.decimation, "every value is shown");
}

TEST(FitPageData, RoundsBeforeItDecimates) {
  const PageColumns columns{Times(1000), Noise(1000, 1)};
  const FittedData fitted = FitPageData(columns, PageData(columns, 16).size());
  EXPECT_EQ(fitted.text, PageData(columns, 16));
  EXPECT_EQ(fitted.rows, 1000u);
}

TEST(FitPageData, KeepsWithinItsCharactersAndUsesMostOfThem) {
  const PageColumns columns{Times(20000), Noise(20000, 1), Noise(20000, 2), Noise(20000, 3)};
  for (const std::size_t characters : {5000, 20000, 60000}) {
    const FittedData fitted = FitPageData(columns, characters);
    EXPECT_LE(fitted.text.size(), characters);
    EXPECT_GT(fitted.text.size(), characters / 2);
    EXPECT_LT(fitted.rows, 20000u);
    EXPECT_THAT(fitted.decimation, testing::StartsWith("plots show the least and greatest"));
  }
}

TEST(FitPageData, HoldsAMinuteOfSixtyNoisyColumnsInFourMegabytes) {
  PageColumns columns{Times(60000)};
  for (std::uint64_t c = 0; c < 60; ++c) columns.push_back(Noise(60000, c));
  const FittedData fitted = FitPageData(columns, 4'000'000);
  EXPECT_LE(fitted.text.size(), 4'000'000u);
  EXPECT_GE(fitted.rows, 20000u);  // 50 bins of two rows in 300 ms: finer than a plot's pixels
}

TEST(FitPageData, LeavesTwoRowsHoweverLittleThereIs) {
  EXPECT_EQ(FitPageData({Times(1000), Noise(1000, 1)}, 1).rows, 2u);
}

}  // namespace
}  // namespace pliant::internal
