#include "pliant/analysis/repeated_number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/analysis/order_claim.h"
#include "pliant/tests/analysis/repetitions.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::ElementsAre;

RepeatedNumber Of(const std::vector<double>& a, const std::vector<double>& b) {
  OrderClaim claim;
  claim.runs = {"a", "b"};
  claim.number = {.signal = "a.b"};
  return Measured(claim, {{"a", a}, {"b", b}});
}

TEST(RepeatedNumber, KeepsANumberOfEachRunAndRepetition) {
  const RepeatedNumber number = Of({1, 2, 3}, {4, 5, 6});
  EXPECT_EQ(number.text(), "peak of a.b");
  EXPECT_EQ(number.unit(), "m");
  EXPECT_EQ(number.repetitions(), 3u);
  EXPECT_THAT(number["a"].values, ElementsAre(1, 2, 3));
  EXPECT_THAT(number["b"].values, ElementsAre(4, 5, 6));
  EXPECT_EQ(number["b"].title, "run b");
  EXPECT_EQ(ErrorOf([&] { number["bb"]; }), "there is no run 'bb'; did you mean 'b'?");
}

TEST(NumbersTable, HasEachNumberOfEachRunOnce) {
  const RepeatedNumber number = Of({2, 2, 2}, {0.001, 0.002, 0.003});
  const Table table = NumbersTable({number, number});
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_THAT(table.rows[0],
              ElementsAre("peak of a.b", "run a", "3", "2.00 m", "0 m", "–", "2.00 m"));
  EXPECT_THAT(table.rows[1], ElementsAre("peak of a.b", "run b", "3", "2.00 mm", "1.00 mm",
                                         testing::HasSubstr(" … "), "2.00 mm"));
}

TEST(NumbersTable, GivesTheMedianOnlyWhereANumberIsNotFinite) {
  const Table table = NumbersTable({Of({kUnbounded, 2, 1}, {kUnbounded, kUnbounded, 1})});
  EXPECT_THAT(table.rows[0], ElementsAre("peak of a.b", "run a", "3", "–", "–", "–", "2.00 m"));
  EXPECT_THAT(table.rows[1], ElementsAre("peak of a.b", "run b", "3", "–", "–", "–", "∞ m"));
}

TEST(PText, HasTwoDigits) {
  EXPECT_EQ(PText(0.0123), "p = 0.012");
  EXPECT_EQ(PText(2.345e-11), "p = 2.3e-11");
  EXPECT_EQ(PText(0), "p < 1e-300");
}

}  // namespace
}  // namespace pliant
