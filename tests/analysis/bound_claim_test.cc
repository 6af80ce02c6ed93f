#include "pliant/analysis/bound_claim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// x = 3 t, y = 4 t, z = −1 at t = 0, 0.25, …, 1 s.
RunData Ramps() {
  RunData run;
  run.name = "ramps";
  RecordedSignal signal{{"a.ramp", "force", {"[x]", "[y]", "[z]"}, {"N", "N", "N"}}, {}, {}};
  signal.times = Eigen::VectorXd::LinSpaced(5, 0, 1);
  signal.numbers.resize(3, 5);
  signal.numbers << 3 * signal.times.transpose(), 4 * signal.times.transpose(),
      Eigen::RowVectorXd::Constant(5, -1);
  run.log = Recording({signal}, {});
  return run;
}

BoundClaim Of(std::vector<std::string> elements, Statistic statistic, double from, double to) {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .basis = "basis",
          .run = "ramps",
          .number = {.signal = "a.ramp",
                     .elements = std::move(elements),
                     .statistic = statistic,
                     .from_s = from,
                     .to_s = to}};
}

bool IsBetween(BoundClaim claim, double least, double most) {
  const RunData run = Ramps();
  claim.least = least;
  claim.most = most;
  return claim.Check(Runs({&run})).holds;
}

/// Whether the claim's number is `value`, to round-off.
void ExpectValue(const BoundClaim& claim, double value) {
  EXPECT_TRUE(IsBetween(claim, value - 1e-14, value + 1e-14)) << value;
  EXPECT_FALSE(IsBetween(claim, value + 1e-14, kUnbounded)) << value;
  EXPECT_FALSE(IsBetween(claim, -kUnbounded, value - 1e-14)) << value;
}

TEST(BoundClaim, ComputesEachStatisticOfTheNorm) {
  const std::vector<std::string> plane{"x", "y"};  // ‖(3 t, 4 t)‖ = 5 t
  ExpectValue(Of(plane, Statistic::Peak, 0, kUnbounded), 5);
  ExpectValue(Of(plane, Statistic::Mean, 0, kUnbounded), 2.5);
  ExpectValue(Of(plane, Statistic::Last, 0, kUnbounded), 5);
  // √(25 (0 + 1 + 4 + 9 + 16)/16/5)
  ExpectValue(Of(plane, Statistic::Rms, 0, kUnbounded), 5 * std::sqrt(30.0 / 80));
}

TEST(BoundClaim, TakesAllElementsIfNoneAreNamed) {
  ExpectValue(Of({}, Statistic::Peak, 0, kUnbounded), std::sqrt(26));
  ExpectValue(Of({"z"}, Statistic::Last, 0, kUnbounded), -1);  // an element has its sign
}

TEST(BoundClaim, TakesTheRowsFromOneTimeToAnother) {
  const std::vector<std::string> x{"x"};
  ExpectValue(Of(x, Statistic::Last, 0, 0.5), 1.5);
  ExpectValue(Of(x, Statistic::Last, 0, 0.6), 1.5);
  ExpectValue(Of(x, Statistic::Mean, 0.25, 0.75), 1.5);
  ExpectValue(Of(x, Statistic::Mean, 0.3, 0.75), (1.5 + 2.25) / 2);
  ExpectValue(Of(x, Statistic::Peak, 1, 1), 3);
}

TEST(BoundClaim, SaysWhatItMeasuredAndWhatItAsksFor) {
  const RunData run = Ramps();
  BoundClaim claim = Of({"x", "y"}, Statistic::Peak, 0, kUnbounded);
  claim.most = 4;
  const Claim upper = claim.Check(Runs({&run}));
  EXPECT_EQ(upper.measured, "peak norm of a.ramp[x, y] is 5.00 N");
  EXPECT_EQ(upper.criterion, "at most 4.00 N");
  EXPECT_EQ(upper.basis, "basis");
  EXPECT_FALSE(upper.holds);
  claim.least = 1;
  EXPECT_EQ(claim.Check(Runs({&run})).criterion, "at least 1.00 N, at most 4.00 N");
}

TEST(BoundClaim, DoesNotHoldOfNumbersThatAreNone) {
  RunData run = Ramps();
  std::vector<RecordedSignal> signals = run.log.signals();
  signals[0].numbers(0, 2) = std::nan("");
  run.log = Recording(signals, {});
  for (const Statistic statistic : {Statistic::Peak, Statistic::Rms, Statistic::Mean}) {
    BoundClaim claim = Of({}, statistic, 0, kUnbounded);
    claim.most = 1e9;
    EXPECT_FALSE(claim.Check(Runs({&run})).holds) << static_cast<int>(statistic);
  }
}

TEST(BoundClaim, RefusesTimesWithoutARow) {
  const RunData run = Ramps();
  BoundClaim claim = Of({}, Statistic::Peak, 0.3, 0.4);
  claim.most = 1;
  EXPECT_EQ(ErrorOf([&] { claim.Check(Runs({&run})); }),
            "no row of a.ramp lies between from_s and to_s, got 0.3 and 0.4");
}

TEST(BoundClaim, RefusesBoundsThatCannotBeMet) {
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.duration_s = 1;
  const auto error = [&](const BoundClaim& claim) {
    return ErrorOf([&] { claim.RequireFit(scenario); });
  };
  BoundClaim claim = Of({}, Statistic::Peak, 0, kUnbounded);
  EXPECT_EQ(error(claim), "least or most must be given");
  claim.most = 1;
  EXPECT_EQ(error(claim), "no error");
  claim.least = 2;
  EXPECT_EQ(error(claim), "least must be <= most, got 2 and 1");
  claim.least = 0;
  claim.number.from_s = 2;
  EXPECT_EQ(error(claim), "from_s must be <= duration_s, 1, got 2");
  claim.number.to_s = 1;
  EXPECT_EQ(error(claim), "from_s must be <= to_s, got 2 and 1");
  claim.number.from_s = 0.0201;
  claim.number.to_s = 0.0205;
  EXPECT_EQ(
      error(claim),
      "no row of the log, one each 1 ms, lies between from_s and to_s, got 0.0201 and 0.0205");
  claim.number.from_s = 0.02;
  EXPECT_EQ(error(claim), "no error");
}

}  // namespace
}  // namespace pliant
