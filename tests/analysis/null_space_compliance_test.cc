#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

ExperimentFile NullSpaceCompliance(Overrides set) {
  return ExperimentFile::Read(FindExperiment("null-space-compliance").file, set);
}

Overrides Ideal(const std::string& engine) {
  return {{"station.ideal", "true"}, {"station.engine", engine}};
}

void ExpectAllToHold(const Overrides& set) {
  const Report report = ReportOn(NullSpaceCompliance(set));
  EXPECT_EQ(report.claims.size(), 5u);
  for (const Claim& claim : report.claims)
    EXPECT_TRUE(claim.holds) << claim.id << ": " << claim.measured;
  EXPECT_EQ(report.figures.size(), 3u);
  EXPECT_EQ(report.tables.size(), 3u);
  EXPECT_NEAR(report.timing->simulated_s, 4 * 6, 1e-9);
}

TEST(NullSpaceCompliance, HoldsEveryClaimOfThePaperWithEitherEngine) {
  for (const char* engine : {"simbody", "recursive"}) ExpectAllToHold(Ideal(engine));
}

TEST(NullSpaceCompliance, HoldsEveryClaimOnTheRealStationWhateverTheSensorsAreOffBy) {
  for (const char* seed : {"1", "2"})
    ExpectAllToHold({{"station.engine", "recursive"}, {"seed", seed}});
}

// Pushes of ten times the strength drive the arm into its limits: the claims are computed, not
// stated.
TEST(NullSpaceCompliance, FailsItsClaimsWhereTheyDoNotHold) {
  Overrides set = Ideal("recursive");
  set.emplace_back("environment.0.force", "[0, 300, 0]");
  set.emplace_back("environment.1.force", "[0, 0, -300]");
  const Report report = ReportOn(NullSpaceCompliance(set));
  EXPECT_TRUE(std::ranges::any_of(report.claims, [](const Claim& c) { return !c.holds; }));
}

TEST(NullSpaceCompliance, RefusesARunThatEndsBeforeThePushes) {
  EXPECT_TRUE(ErrorOf([] {
                NullSpaceCompliance({{"duration_s", "4.7"}});
              })
                  .ends_with("claim 'full': duration_s must be >= 4.8, when its last push has "
                             "lasted, got 4.7"));
}

TEST(Experiments, AreFoundByNameOrWithTheNearestOne) {
  EXPECT_EQ(FindExperiment("null-space-compliance").name, "null-space-compliance");
  EXPECT_EQ(ErrorOf([] { FindExperiment("nul-space-compliance"); }),
            "there is no experiment 'nul-space-compliance'; did you mean 'null-space-compliance'?\n"
            "`pliant experiment list` names them");
}

}  // namespace
}  // namespace pliant
