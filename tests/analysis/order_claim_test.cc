#include "pliant/analysis/order_claim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/analysis/repetitions.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

OrderClaim Rising() {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .basis = "basis",
          .runs = {"a", "b", "c"},
          .number = {.signal = "a.b"}};
}

Claim Judged(const OrderClaim& claim, const std::vector<double>& a, const std::vector<double>& b,
             const std::vector<double>& c) {
  return claim.Judge(Measured(claim, {{"a", a}, {"b", b}, {"c", c}}));
}

TEST(OrderClaim, HoldsOfNumbersThatRiseStrictly) {
  EXPECT_TRUE(Judged(Rising(), {1}, {2}, {3}).holds);
  EXPECT_FALSE(Judged(Rising(), {1}, {2}, {2}).holds);
  EXPECT_FALSE(Judged(Rising(), {1}, {3}, {2}).holds);
  EXPECT_FALSE(Judged(Rising(), {1}, {2}, {std::nan("")}).holds);
}

TEST(OrderClaim, HoldsOfNumbersThatFallStrictly) {
  OrderClaim falling = Rising();
  falling.direction = OrderDirection::Falling;
  EXPECT_TRUE(Judged(falling, {3}, {2}, {1}).holds);
  EXPECT_FALSE(Judged(falling, {1}, {2}, {3}).holds);
  EXPECT_TRUE(Judged(falling, {kUnbounded}, {2}, {1}).holds);  // what never settles
}

TEST(OrderClaim, AsksForItsMarginsAndMore) {
  OrderClaim claim = Rising();
  claim.margin = 1;
  EXPECT_FALSE(Judged(claim, {1}, {2}, {3.5}).holds);
  EXPECT_TRUE(Judged(claim, {1}, {2.5}, {4}).holds);
  claim.margin_part = 0.5;  // from 2.5 to more than 3.75
  EXPECT_TRUE(Judged(claim, {1}, {2.5}, {3.76}).holds);
  EXPECT_FALSE(Judged(claim, {1}, {2.5}, {3.75}).holds);
  EXPECT_EQ(Judged(claim, {1}, {2.5}, {4}).criterion,
            "rises from each to the next by more than 1.00 m and 50 %");
}

TEST(OrderClaim, HoldsInEveryRepetitionOrOfTheMedians) {
  const std::vector<double> a{1, 1, 1}, b{2, 0.5, 2}, c{3, 3, 3};
  const Claim each = Judged(Rising(), a, b, c);
  EXPECT_FALSE(each.holds);
  EXPECT_EQ(each.measured,
            "peak of a.b: ordered in 2 of 3 repetitions; in the first that is not: run a 1.00 m, "
            "run b 500 mm, run c 3.00 m");
  EXPECT_EQ(each.criterion, "rises from each to the next, in every repetition");
  OrderClaim medians = Rising();
  medians.of = OrderOf::Medians;
  const Claim of = Judged(medians, a, b, c);
  EXPECT_TRUE(of.holds);
  EXPECT_EQ(of.measured, "peak of a.b: run a 1.00 m, run b 2.00 m, run c 3.00 m (medians of 3)");
  EXPECT_EQ(of.criterion, "the median rises from each to the next");
  EXPECT_FALSE(Judged(medians, a, {2, std::nan(""), 2}, c).holds);
}

TEST(OrderClaim, RefusesWhatHasNoOrder) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  OrderClaim claim = Rising();
  const auto error = [&] { return ErrorOf([&] { claim.RequireFit(scenario); }); };
  EXPECT_EQ(error(), "no error");
  claim.runs = {"a"};
  EXPECT_EQ(error(), "an order is of 2 runs or more, got 1");
  claim.runs = {"a", "b", "a"};
  EXPECT_EQ(error(), "a run stands twice in the order");
}

}  // namespace
}  // namespace pliant
