#include "pliant/analysis/least_claim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// A number that stays as it is for a second.
RunData Constantly(const std::string& name, double value) {
  RunData run;
  run.name = name;
  run.title = name + "'s";
  run.log = Recording({{{"a.b", "force", {""}, {"N"}},
                        Eigen::VectorXd::LinSpaced(11, 0, 1),
                        Eigen::MatrixXd::Constant(1, 11, value)}},
                      {});
  return run;
}

LeastClaim Of(double factor) {
  return {.claim = {.id = "id", .source = "s", .paper = "p"},
          .basis = "basis",
          .run = "one",
          .others = {"two", "three"},
          .number = {.signal = "a.b"},
          .factor = factor};
}

TEST(LeastClaim, ComparesWithEachOfTheOthers) {
  const RunData one = Constantly("one", 2), two = Constantly("two", 5),
                three = Constantly("three", 4);
  const Runs runs({&one, &two, &three});
  EXPECT_TRUE(Of(1).Check(runs).holds);
  EXPECT_TRUE(Of(2).Check(runs).holds);
  EXPECT_FALSE(Of(2.01).Check(runs).holds);
  const Claim said = Of(2).Check(runs);
  EXPECT_EQ(said.measured, "peak of a.b: one's 2.00 N; two's 5.00 N; three's 4.00 N");
  EXPECT_EQ(said.criterion, "2 times it is at most each of the others");
  EXPECT_EQ(Of(1).Check(runs).criterion, "at most each of the others");
}

TEST(LeastClaim, DoesNotHoldOfANegativeNumberThatIsLarger) {
  const RunData one = Constantly("one", -1), two = Constantly("two", -1.5),
                three = Constantly("three", 4);
  LeastClaim claim = Of(2);
  claim.number.statistic = Statistic::Last;
  EXPECT_FALSE(claim.Check(Runs({&one, &two, &three})).holds);
}

TEST(LeastClaim, DoesNotHoldOfWhatIsNoNumber) {
  const RunData one = Constantly("one", 2), two = Constantly("two", std::nan("")),
                three = Constantly("three", 4);
  EXPECT_FALSE(Of(1).Check(Runs({&one, &two, &three})).holds);
}

TEST(LeastClaim, RefusesToCompareWithItselfAndWithNone) {
  Scenario scenario;
  scenario.duration_s = 1;
  LeastClaim claim = Of(1);
  claim.others.push_back("one");
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }),
            "a run cannot be compared with itself, 'one'");
  claim.others.clear();
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }), "it compares with no other run");
}

}  // namespace
}  // namespace pliant
