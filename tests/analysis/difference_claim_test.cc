#include "pliant/analysis/difference_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/analysis/repetitions.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

DifferenceClaim Less() {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .run = "a",
          .than = "b",
          .number = {.signal = "a.b"}};
}

Claim Judged(const DifferenceClaim& claim, const std::vector<double>& a,
             const std::vector<double>& b) {
  return claim.Judge(Measured(claim, {{"a", a}, {"b", b}}));
}

// p of the least U of 4 and 4, two-sided: 2/70.
TEST(DifferenceClaim, HoldsOfGroupsThatLieApartInTheStatedDirection) {
  const std::vector<double> low{1, 2, 3, 4.5}, high{5, 6, 7, 8};
  const Claim claim = Judged(Less(), low, high);
  EXPECT_TRUE(claim.holds);
  EXPECT_THAT(claim.measured, HasSubstr("U = 0, p = 0.029 (exact), r = -1.00; Shapiro–Wilk: W = "));
  EXPECT_THAT(claim.measured, HasSubstr("run a 2.62 m ± 1.49 m, run b 6.50 m ± 1.29 m"));
  EXPECT_THAT(claim.measured, HasSubstr("(mean ± SD of 4); difference -3.88 m, 95 % -"));
  EXPECT_EQ(claim.criterion, "two-sided p < 0.05, and run a is less (r < 0)");
  EXPECT_FALSE(Judged(Less(), high, low).holds);
  DifferenceClaim greater = Less();
  greater.direction = DifferenceDirection::Greater;
  EXPECT_TRUE(Judged(greater, high, low).holds);
  EXPECT_FALSE(Judged(greater, low, high).holds);
  DifferenceClaim strict = Less();
  strict.alpha = 0.02;
  EXPECT_FALSE(Judged(strict, low, high).holds);
}

// The second least U: 2 · 2/70 = 0.057.
TEST(DifferenceClaim, DoesNotHoldOfGroupsThatOverlap) {
  EXPECT_FALSE(Judged(Less(), {1, 2, 3, 5.5}, {5, 6, 7, 8}).holds);
}

TEST(DifferenceClaim, IsJudgedWhereNothingScatters) {
  const Claim claim = Judged(Less(), {1, 1, 1, 1}, {2, 2, 2, 2});
  EXPECT_TRUE(claim.holds);
  EXPECT_THAT(claim.measured, HasSubstr("difference -1.00 m; U = 0"));
  EXPECT_THAT(claim.measured, HasSubstr("Shapiro–Wilk: cannot be said and cannot be said"));
  EXPECT_FALSE(Judged(Less(), {1, 1, 1, 1}, {1, 1, 1, 1}).holds);
}

TEST(DifferenceClaim, DoesNotHoldOfNumbersThatAreNotFinite) {
  const Claim claim = Judged(Less(), {1, 1, 1, 1}, {2, kUnbounded, kUnbounded, 2});
  EXPECT_FALSE(claim.holds);
  EXPECT_EQ(claim.measured,
            "cannot be judged: peak of a.b is not finite in 2 of 4 repetitions of run b");
}

TEST(DifferenceClaim, RefusesFewerRepetitionsThanItsTestNeeds) {
  const auto error = [](double alpha, int repetitions) {
    DifferenceClaim claim = Less();
    claim.alpha = alpha;
    return ErrorOf([&] { claim.RequireRepetitions(repetitions); });
  };
  EXPECT_EQ(error(0.05, 1),
            "p of 1 repetition is never below 1, and alpha is 0.05; give --repeat 4 or more");
  EXPECT_EQ(error(0.05, 3),  // 2/20
            "p of 3 repetitions is never below 0.1, and alpha is 0.05; give --repeat 4 or more");
  EXPECT_EQ(error(0.05, 4), "no error");
  EXPECT_EQ(error(0.001, 6),  // 2/924, and 2/3432
            "p of 6 repetitions is never below 0.0022, and alpha is 0.001; give --repeat 7 or "
            "more");
  EXPECT_EQ(error(0.001, 7), "no error");
}

TEST(DifferenceClaim, RefusesToCompareARunWithItself) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  DifferenceClaim claim = Less();
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }), "no error");
  claim.than = "a";
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }), "a run is compared with itself, got a");
}

}  // namespace
}  // namespace pliant
