#include "pliant/analysis/number_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Cells = std::vector<std::string>;

/// A force that stays as it is for a second.
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

NumberTable Forces() {
  return {.title = "Forces",
          .caption = "In brackets: the paper.",
          .runs = {"one", "two"},
          .rows = {{.title = "largest", .number = {.signal = "a.b"}, .paper = {"29 / 26", ""}},
                   {.title = "of 10 N",
                    .number = {.signal = "a.b"},
                    .factor = 10,
                    .unit = "%",
                    .digits = 2}}};
}

std::vector<RepeatedNumber> Measured(const NumberTable& table,
                                     const std::vector<std::pair<double, double>>& repetitions) {
  std::vector<RepeatedNumber> numbers = table.Wanted();
  for (const auto& [first, second] : repetitions) {
    const RunData one = Constantly("one", first), two = Constantly("two", second);
    for (RepeatedNumber& number : numbers) number.Add(Runs({&one, &two}));
  }
  return numbers;
}

TEST(NumberTable, HasARowForEachNumberAndAColumnForEachRun) {
  const NumberTable forces = Forces();
  const Table table = forces.Show(Measured(forces, {{29.26, 5}}));
  EXPECT_EQ(table.title, "Forces");
  EXPECT_EQ(table.caption, "In brackets: the paper.");
  EXPECT_EQ(table.columns, (Cells{"", "one's", "two's"}));
  EXPECT_EQ(table.rows, (std::vector<Cells>{{"largest [N]", "29.3 (29 / 26)", "5"},
                                            {"of 10 N [%]", "2.9e+02", "50"}}));
}

TEST(NumberTable, HasOnePrefixForARow) {
  const NumberTable forces = Forces();
  EXPECT_EQ(forces.Show(Measured(forces, {{0.0123, 0.001}})).rows[0],
            (Cells{"largest [mN]", "12.3 (29 / 26)", "1"}));
}

// The sample standard deviation of 1 and 3 is √2.
TEST(NumberTable, HasMeansAndDeviationsOfRepetitions) {
  const NumberTable forces = Forces();
  EXPECT_EQ(forces.Show(Measured(forces, {{1, 5}, {3, 5}})).rows[0],
            (Cells{"largest [N]", "2 ± 1.4 (29 / 26)", "5 ± 0"}));
}

TEST(NumberTable, SaysWhatIsNoNumber) {
  const NumberTable forces = Forces();
  EXPECT_EQ(forces.Show(Measured(forces, {{std::nan(""), 5}})).rows[0][1], "not finite (29 / 26)");
}

TEST(NumberTable, RefusesWhatDoesNotFit) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  const auto error = [&](const auto& change) {
    NumberTable table = Forces();
    change(table);
    return ErrorOf([&] { table.RequireFit(scenario); });
  };
  EXPECT_EQ(error([](NumberTable& t) { t.title.clear(); }), "title is missing");
  EXPECT_EQ(error([](NumberTable& t) { t.rows.clear(); }), "it shows no number");
  EXPECT_EQ(error([](NumberTable& t) { t.rows[0].paper.pop_back(); }),
            "row 'largest': paper has what the paper says of each of the 2 runs, got 1");
  EXPECT_EQ(error([](NumberTable& t) { t.rows[1].unit.reset(); }),
            "row 'of 10 N': unit is missing: what a number has that is multiplied by 10");
}

}  // namespace
}  // namespace pliant
