#include "pliant/analysis/integrator_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

IntegratorStudyOptions Short() {
  return {.methods = {Method::kBogackiShampine, Method::kAdams},
          .relative_tolerances = {1e-5, 1e-6, 1e-7},
          .compared_s = 0.05,
          .balanced_s = 0.5,
          .repetitions = 1};
}

const Claim& Find(const Report& report, const std::string& id) {
  return *std::ranges::find(report.claims, id, &Claim::id);
}

TEST(IntegratorStudy, HoldsItsClaimsInAShortRunToo) {
  double done = 0;
  const Report report =
      IntegratorStudy(Short(), [&](const std::string&, double now, double, double) { done = now; });
  EXPECT_EQ(done, 0.5);
  for (const char* id : {"completes", "default", "smooth", "sampled", "energy-bogacki_shampine"})
    EXPECT_TRUE(Find(report, id).holds) << id << ": " << Find(report, id).measured;
  EXPECT_EQ(report.figures.size(), 3u);
  EXPECT_EQ(report.tables.size(), 3u);
  for (const Table& table : report.tables) {
    EXPECT_EQ(table.rows.size(), 2u);
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  }
  EXPECT_NEAR(report.timing->simulated_s, 2 * 0.5, 1e-9);
}

TEST(IntegratorStudy, RefusesMethodsOfOneFamily) {
  IntegratorStudyOptions options = Short();
  options.methods = {Method::kBogackiShampine, Method::kSdirk};
  EXPECT_EQ(ErrorOf([&] { IntegratorStudy(options, {}); }),
            "methods has a multistep and a Runge–Kutta method");
}

}  // namespace
}  // namespace pliant
