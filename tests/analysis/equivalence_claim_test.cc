#include "pliant/analysis/equivalence_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/tests/analysis/repetitions.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

EquivalenceClaim Within(double margin, double margin_part) {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .basis = "basis",
          .run = "a",
          .to = "b",
          .number = {.signal = "a.b"},
          .margin = margin,
          .margin_part = margin_part};
}

Claim Judged(const EquivalenceClaim& claim, const std::vector<double>& a,
             const std::vector<double>& b) {
  return claim.Judge(Measured(claim, {{"a", a}, {"b", b}}));
}

const std::vector<double> kFirst{9, 10, 11}, kSecond{10, 11, 12};

// d = −1, e² = 2/3, ν = 4: the interval d ± t₀.₉₅ e with t₀.₉₅ = 2.132 (Student's table) ends at
// −2.741.
TEST(EquivalenceClaim, HoldsIfTheIntervalLiesWithinTheMargin) {
  EXPECT_TRUE(Judged(Within(2.75, 0), kFirst, kSecond).holds);
  const Claim claim = Judged(Within(2.73, 0), kFirst, kSecond);
  EXPECT_FALSE(claim.holds);
  EXPECT_THAT(claim.measured, HasSubstr("difference -1.00 m, 90 % -2.74 m … 741 mm; p = 0.051"));
  EXPECT_EQ(claim.criterion, "p < 0.05 that the means differ by less than 2.73 m");
}

TEST(EquivalenceClaim, TakesItsMarginFromTheOtherRunsMean) {
  EXPECT_TRUE(Judged(Within(0, 0.25), kFirst, kSecond).holds);  // 2.75
  const Claim claim = Judged(Within(0, 0.248), kFirst, kSecond);
  EXPECT_FALSE(claim.holds);
  EXPECT_EQ(claim.criterion,
            "p < 0.05 that the means differ by less than 24.8 % of that of run b, 2.73 m");
  EXPECT_EQ(Judged(Within(0, 0.5), {1, 2, 3}, {-1, 0, 1}).measured,
            "cannot be judged: the mean of run b is 0");
}

TEST(EquivalenceClaim, DoesNotHoldOfWhatCannotBeJudged) {
  EXPECT_EQ(Judged(Within(1, 0), {1, 1, 1}, {1, 1, 1}).measured,
            "cannot be judged: peak of a.b is the same in every repetition");
  const Claim claim = Judged(Within(1, 0), {1, kUnbounded, 1}, {1, 1, 1});
  EXPECT_FALSE(claim.holds);
  EXPECT_EQ(claim.measured,
            "cannot be judged: peak of a.b is not finite in 1 of 3 repetitions of run a");
}

TEST(EquivalenceClaim, RefusesWhatSaysNothing) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  const auto error = [&](const EquivalenceClaim& claim) {
    return ErrorOf([&] { claim.RequireFit(scenario); });
  };
  EXPECT_EQ(error(Within(1, 0)), "no error");
  EXPECT_EQ(error(Within(0, 0)), "margin or margin_part must be > 0, one of them, got 0 and 0");
  EXPECT_EQ(error(Within(1, 0.1)), "margin or margin_part must be > 0, one of them, got 1 and 0.1");
  EquivalenceClaim claim = Within(1, 0);
  claim.to = "a";
  EXPECT_EQ(error(claim), "a run is compared with itself, got a");
  EXPECT_EQ(ErrorOf([&] { claim.RequireRepetitions(1); }),
            "one repetition says nothing of how numbers scatter; give --repeat 2 or more");
  EXPECT_EQ(ErrorOf([&] { claim.RequireRepetitions(2); }), "no error");
}

}  // namespace
}  // namespace pliant
