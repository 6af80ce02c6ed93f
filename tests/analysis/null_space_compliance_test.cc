#include "pliant/analysis/null_space_compliance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

std::string MessageOf(const NullSpaceComplianceOptions& options) {
  try {
    NullSpaceCompliance(options, {});
  } catch (const Error& e) {
    return e.what();
  }
  return "no Error";
}

void ExpectAllToHold(const NullSpaceComplianceOptions& options) {
  double last = 0;
  const Report report = NullSpaceCompliance(
      options, [&](const std::string&, double done, double, double) { last = done; });
  EXPECT_EQ(last, 6);  // the progress reaches the end
  EXPECT_EQ(report.claims.size(), 5u);
  for (const Claim& claim : report.claims)
    EXPECT_TRUE(claim.holds) << claim.id << ": " << claim.measured;
  EXPECT_EQ(report.figures.size(), 3u);
  EXPECT_EQ(report.tables.size(), 3u);
  EXPECT_NEAR(report.timing->simulated_s, 4 * 6, 1e-9);
}

TEST(NullSpaceCompliance, HoldsEveryClaimOfThePaperWithEitherEngine) {
  for (const auto engine : {SimbodyPlant::Engine::Simbody, SimbodyPlant::Engine::Recursive})
    ExpectAllToHold({.ideal = true, .engine = engine});
}

TEST(NullSpaceCompliance, HoldsEveryClaimOnTheRealStationWhateverTheSensorsAreOffBy) {
  for (const std::uint64_t seed : {1, 2})
    ExpectAllToHold({.seed = seed, .engine = SimbodyPlant::Engine::Recursive});
}

// Pushes of ten times the strength drive the arm into its limits: the claims are computed, not
// stated.
TEST(NullSpaceCompliance, FailsItsClaimsWhereTheyDoNotHold) {
  const Report report = NullSpaceCompliance(
      {.push_N = 200, .ideal = true, .engine = SimbodyPlant::Engine::Recursive}, {});
  EXPECT_TRUE(std::ranges::any_of(report.claims, [](const Claim& c) { return !c.holds; }));
}

TEST(NullSpaceCompliance, RefusesARunThatEndsBeforeThePushes) {
  EXPECT_EQ(MessageOf({.duration_s = 5}),
            "duration_s must be >= 5.2, when the last push has ended, got 5");
  EXPECT_EQ(MessageOf({.push_N = 0}), "push_N must be > 0, got 0");
}

TEST(Experiments, AreFoundByNameOrWithTheNearestOne) {
  EXPECT_EQ(FindExperiment("null-space-compliance").name, "null-space-compliance");
  try {
    FindExperiment("nul-space-compliance");
    FAIL() << "no Error";
  } catch (const Error& e) {
    EXPECT_STREQ(
        e.what(),
        "there is no experiment 'nul-space-compliance'; did you mean 'null-space-compliance'?\n"
        "`pliant experiment list` names them");
  }
}

}  // namespace
}  // namespace pliant
