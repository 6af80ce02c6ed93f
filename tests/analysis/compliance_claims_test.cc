#include "pliant/analysis/compliance_claims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/tests/analysis/compliance_experiment.h"

namespace pliant {
namespace {

ClaimSource Stated() { return {.id = "id", .source = "source", .paper = "paper"}; }

/// One push at the tool, long enough for the transients of its pose: with a double pole at 20 1/s
/// they have gone to 13 e⁻¹² = 0.01 % after 0.6 s.
class ComplianceClaims : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const TemporaryDirectory out;
    runs_ = new std::vector<RunData>(ReadRuns(RunExperiment(
        ExperimentFile::ReadText(
            kShort, "short.yaml",
            {{"environment.0.duration_s", "0.9"},
             {"duration_s", "1"},
             {"runs",
              "[{name: known, title: k, set: {controller.estimate: 'true'}}, {name: stiff, title: "
              "s}, {name: null_space, title: n, set: {controller.posture.compliance: 1}}, {name: "
              "full, title: f, set: {controller.pose.compliance: 1, "
              "controller.posture.compliance: 1}}]"}}),
        {.out = out.path()})));
  }
  static void TearDownTestSuite() { delete runs_; }

  static Runs All() {
    std::vector<const RunData*> all;
    for (const RunData& run : *runs_) all.push_back(&run);
    return Runs(all);
  }

  static std::vector<RunData>* runs_;
};

std::vector<RunData>* ComplianceClaims::runs_ = nullptr;

TEST_F(ComplianceClaims, StandsStillHoldsOnlyWhereThePushIsKnown) {
  EXPECT_TRUE((StandsStill{Stated(), "known"}.Check(All()).holds));
  for (const char* run : {"stiff", "null_space", "full"})
    EXPECT_FALSE((StandsStill{Stated(), run}.Check(All()).holds)) << run;
}

TEST_F(ComplianceClaims, HoldsToolHoldsWhereThePoseGivesNoWay) {
  EXPECT_TRUE((HoldsTool{Stated(), "stiff"}.Check(All()).holds));
  EXPECT_TRUE((HoldsTool{Stated(), "null_space"}.Check(All()).holds));
  EXPECT_FALSE((HoldsTool{Stated(), "full"}.Check(All()).holds));
  EXPECT_FALSE((HoldsTool{.claim = Stated(), .run = "stiff", .factor = 0.5}.Check(All()).holds));
  EXPECT_FALSE((
      HoldsTool{.claim = Stated(), .run = "stiff", .joints_more_than_deg = 90}.Check(All()).holds));
}

TEST_F(ComplianceClaims, YieldsAsInertiaHoldsWhereEverythingGivesWay) {
  const Claim full = YieldsAsInertia{Stated(), "full"}.Check(All());
  EXPECT_TRUE(full.holds) << full.measured;
  for (const char* run : {"known", "stiff", "null_space"})
    EXPECT_FALSE((YieldsAsInertia{Stated(), run}.Check(All()).holds)) << run;
}

/// A run with one number of a signal replaced.
RunData With(const RunData& run, const std::string& path, Eigen::Index row, double value) {
  std::vector<RecordedSignal> signals = run.log.signals();
  for (RecordedSignal& signal : signals)
    if (signal.path == path) signal.numbers(row, 500) = value;
  RunData changed = run;
  changed.log = Recording(signals, run.log.metadata());
  return changed;
}

TEST_F(ComplianceClaims, KeepsLimitsFailsWhereOneTickOfOneRunDoesNot) {
  const RunData& run = runs_->back();
  const auto holds = [&](const RunData& changed) {
    return KeepsLimits{Stated()}.Check(Runs({&runs_->front(), &changed, &run})).holds;
  };
  EXPECT_TRUE(holds(run));
  const Joint& joint = run.arm.model.joint(1);
  EXPECT_FALSE(holds(With(run, "arm.measured_velocity", 1, -joint.velocity)));
  EXPECT_FALSE(holds(With(run, "arm.measured_position", 1, joint.upper)));
  EXPECT_FALSE(holds(With(run, "control.torque", 1, joint.effort)));
  EXPECT_TRUE(holds(With(run, "control.torque", 1, 0.99 * joint.effort)));
  EXPECT_FALSE(holds(With(run, "control.torque", 1, std::nan(""))));
  // Limits that the controller left out.
  const RecordedSignal& report = run.log["control.report"];
  const auto outcome = std::ranges::find(report.elements, ".outcome") - report.elements.begin();
  EXPECT_FALSE(holds(With(run, "control.report", outcome, 1)));
}

// The prediction is made of rows, whatever their period.
TEST_F(ComplianceClaims, HoldsToolOfALogWithFewerRows) {
  const TemporaryDirectory out;
  const std::vector<RunData> runs =
      ReadRuns(RunExperiment(ExperimentFile::ReadText(kShort, "short.yaml",
                                                      {{"environment.0.duration_s", "0.9"},
                                                       {"duration_s", "1"},
                                                       {"runs", "[{name: stiff, title: s}]"},
                                                       {"log_period", "5 ms"}}),
                             {.out = out.path()}));
  const Eigen::MatrixXd few = PredictedError(runs[0]), all = PredictedError((*runs_)[1]);
  // Holding the push for 5 ms instead of 1 shifts it by 2 ms of its 20 ms edge.
  EXPECT_NEAR(few.cwiseAbs().maxCoeff(), all.cwiseAbs().maxCoeff(),
              0.1 * all.cwiseAbs().maxCoeff());
  EXPECT_TRUE((HoldsTool{Stated(), "stiff"}.Check(Runs({&runs[0]})).holds));
}

}  // namespace
}  // namespace pliant
