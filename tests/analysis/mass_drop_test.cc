#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/tests/analysis/compliance_experiment.h"

namespace pliant {
namespace {

// Four repetitions are the fewest that claims of differences can be judged by.
TEST(MassDrop, IsJudgedAndDrawn) {
  const Report report =
      ReportOn(ExperimentFile::Read(FindExperiment("ec-fig5").file, {{"repeat", "4"}}));
  EXPECT_EQ(report.claims.size(), 5u);
  EXPECT_EQ(report.figures.size(), 3u);
  const auto sensor = std::ranges::find(report.claims, "peak-below-residual", &Claim::id);
  ASSERT_NE(sensor, report.claims.end());
  // A catch lasts about π √(m/k) = 79 ms, over before an observer of 1/K_I = 100 ms has seen it.
  EXPECT_TRUE(sensor->holds) << sensor->measured;
}

}  // namespace
}  // namespace pliant
