#include "pliant/analysis/run_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/repeated_number.h"
#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

ExperimentFile Short(const Overrides& set = {}) {
  return ExperimentFile::ReadText(kShort, "short.yaml", set);
}

/// A real station: its sensors have noise.
ExperimentFile Noisy(int repeat = 2) {
  return Short({{"station.ideal", "false"},
                {"integrator.method", "dormand_prince"},
                {"duration_s", "0.02"},
                {"repeat", std::to_string(repeat)}});
}

std::string NumbersOf(const RunData& run) {
  std::string all;
  for (const RecordedSignal& signal : run.log.signals())
    all += signal.path + std::string(reinterpret_cast<const char*>(signal.numbers.data()),
                                     static_cast<std::size_t>(signal.numbers.size()) * 8);
  return all;
}

TEST(RunExperiment, LeavesAWholeLogOfEachRun) {
  const TemporaryDirectory out;
  double done = 0;
  const auto logs = RunExperiment(
      Short(), {.out = out.path() / "a/b",
                .progress = [&](const std::string&, double now, double, double) { done = now; }});
  EXPECT_DOUBLE_EQ(done, 0.1);
  const fs::path folder = out.path() / "a/b/logs";
  EXPECT_THAT(logs, ElementsAre(folder / "stiff.mcap", folder / "full.mcap"));
  for (const RunData& run : ReadRuns(logs)) {
    EXPECT_TRUE(run.whole);
    EXPECT_EQ(run.times().size(), 101);  // every millisecond, both ends
    EXPECT_DOUBLE_EQ(run.timing.simulated_s, 0.1);
    EXPECT_EQ(run.timing.ticks, 101);
    EXPECT_GT(run.timing.integrator_steps, 0);
    EXPECT_EQ(run.title, run.name);
    EXPECT_EQ(run.experiment, Short().text());
  }
}

TEST(RunExperiment, SaysWhichBlockHasEndedARun) {
  const TemporaryDirectory out;
  ExperimentFile file = Short();
  file.scenarios[1].stop_when = {{.number = "arm.measured_position[joint_4]", .below = 0}};
  const auto logs = RunExperiment(file, {.out = out.path()});
  EXPECT_EQ(RunHeading::Read(logs[0]).ended, "");
  const RunData run = RunData::Read(logs[1]);
  EXPECT_TRUE(run.whole) << "it came to its end";
  EXPECT_EQ(run.ended,
            "stop_when_1 ended the run at t = 0 s: arm.measured_position[joint_4] is below 0");
  EXPECT_EQ(run.times().size(), 1);
  EXPECT_EQ(run.timing.ticks, 1);
  EXPECT_EQ(run.timing.simulated_s, 0);
  EXPECT_THAT(RunHeading::Read(logs[0]).integrator, testing::HasSubstr(" on average, "));
}

TEST(RunExperiment, GivesEachRepetitionItsSeedAndItsLog) {
  const TemporaryDirectory out;
  const auto logs = RunExperiment(Noisy(), {.out = out.path()});
  const fs::path folder = out.path() / "logs";
  EXPECT_THAT(logs, ElementsAre(folder / "stiff-0.mcap", folder / "full-0.mcap",
                                folder / "stiff-1.mcap", folder / "full-1.mcap"));
  const std::vector<RunData> runs = ReadRuns(logs);
  for (const std::size_t i : {0, 1, 2, 3}) {
    EXPECT_EQ(runs[i].scenario.seed, 1 + i / 2);
    EXPECT_EQ(runs[i].repetition, static_cast<int>(i / 2));
  }
  EXPECT_NE(NumbersOf(runs[0]), NumbersOf(runs[2]));
}

TEST(RunExperiment, RecordsTheSameWithSeveralJobs) {
  const TemporaryDirectory one, two;
  const auto first = RunExperiment(Noisy(), {.out = one.path()});
  const auto second = RunExperiment(Noisy(), {.out = two.path(), .jobs = 3});
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_EQ(NumbersOf(RunData::Read(first[i])), NumbersOf(RunData::Read(second[i])));
}

TEST(RunExperiment, LeavesLogsThatCanBeReadWhenItIsStopped) {
  const TemporaryDirectory out;
  std::atomic<bool> stop = false;
  const auto logs = RunExperiment(Short({{"duration_s", "100"}}),
                                  {.out = out.path(),
                                   .progress = [&](const std::string&, double now, double,
                                                   double) { stop = stop || now > 0.25; },
                                   .stop = &stop});
  ASSERT_EQ(logs.size(), 1u);  // the other was not begun
  const std::vector<RunData> runs = ReadRuns(logs);
  EXPECT_FALSE(runs[0].whole);
  EXPECT_NEAR(runs[0].timing.simulated_s, 0.3, 1e-9);  // the flag is looked at each tenth
  EXPECT_NEAR(runs[0].times().tail<1>()(0), 0.299, 1e-9);
  EXPECT_EQ(ErrorOf([&] { ReportOf(runs); }),
            logs[0].string() + ": the run ended at 0.299 s of 100 s; a report needs whole runs");

  EXPECT_EQ(ErrorOf([&] { ReportOf(logs); }), ErrorOf([&] { ReportOf(runs); }));

  std::vector<RunData> empty = runs;
  empty[0].log = Recording({{{"arm.measured_position", "joint position", {}, {}}, {}, {}}}, {});
  EXPECT_EQ(ErrorOf([&] { ReportOf(empty); }),
            logs[0].string() + ": the log has no row; a report needs whole runs");
}

TEST(RunExperiment, RunsNothingOnceItIsStopped) {
  const TemporaryDirectory out;
  const std::atomic<bool> stop = true;
  EXPECT_TRUE(RunExperiment(Short(), {.out = out.path(), .stop = &stop}).empty());
}

TEST(RunExperiment, RefusesToWriteOverLogsBeforeItRunsAny) {
  const TemporaryDirectory out;
  fs::create_directory(out.path() / "logs");
  const fs::path there = out.path() / "logs/full.mcap";
  std::ofstream(there) << "mine";
  EXPECT_EQ(ErrorOf([&] { RunExperiment(Short(), {.out = out.path()}); }),
            there.string() + " exists; give --force to write over it, or another --out");
  EXPECT_FALSE(fs::exists(out.path() / "logs/stiff.mcap"));
  EXPECT_EQ(ReadText(there), "mine");
  EXPECT_EQ(RunExperiment(Short(), {.out = out.path(), .force = true}).size(), 2u);
  EXPECT_TRUE(RunData::Read(there).whole);
}

TEST(RunExperiment, RefusesAPlaceItCannotWriteTo) {
  const TemporaryDirectory out;
  std::ofstream(out.path() / "file") << "mine";
  EXPECT_EQ(
      ErrorOf([&] { RunExperiment(Short(), {.out = out.path() / "file"}); }),
      "cannot make the directory " + (out.path() / "file/logs").string() + ": Not a directory");
  EXPECT_THAT(ErrorOf([] { RunExperiment(Short(), {.out = "/proc/none"}); }),
              StartsWith("cannot make the directory /proc/none/logs: "));
}

TEST(RunExperiment, RefusesCountsBelowOne) {
  ExperimentFile never = Short();
  never.experiment.repeat = 0;
  EXPECT_EQ(ErrorOf([&] { RunExperiment(never, {.out = "none"}); }), "repeat must be >= 1, got 0");
  EXPECT_EQ(ErrorOf([] { RunExperiment(Short(), {.out = "none", .jobs = 0}); }),
            "jobs must be >= 1, got 0");
}

// One step for each millisecond is too few for tolerances that tight.
TEST(RunExperiment, SaysWhyARunCouldNotGoOnAndKeepsWhatItHas) {
  const TemporaryDirectory out;
  const ExperimentFile file =
      Short({{"runs.0.set",
              "{integrator.max_steps_between_events: 1, integrator.relative_tolerance: 1e-14, "
              "integrator.absolute_tolerance: 1e-14}"}});
  const std::string error = ErrorOf([&] { RunExperiment(file, {.out = out.path()}); });
  EXPECT_THAT(error, StartsWith((out.path() / "logs/stiff.mcap").string() + ": "));
  const RunData run = RunData::Read(out.path() / "logs/stiff.mcap");
  EXPECT_FALSE(run.whole);
}

TEST(RunExperiment, TakesAwayLogsThatWouldPassForItsOwn) {
  const TemporaryDirectory out;
  RunExperiment(Short({{"repeat", "2"}}), {.out = out.path()});
  const fs::path folder = out.path() / "logs";
  for (const char* other : {"stiff-.mcap", "stiff-1a.mcap", "stiff-1.txt", "stiffer-1.mcap"})
    std::ofstream(folder / other) << "of somebody else";
  const auto logs = RunExperiment(Short(), {.out = out.path(), .force = true});
  EXPECT_EQ(ReadRuns(logs).size(), 2u);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  EXPECT_THAT(names,
              testing::UnorderedElementsAre("stiff.mcap", "full.mcap", "stiff-.mcap",
                                            "stiff-1a.mcap", "stiff-1.txt", "stiffer-1.mcap"));
}

TEST(RunExperiment, NamesAnOlderLogThatCannotBeTakenAway) {
  const TemporaryDirectory out;
  const fs::path log = out.path() / "logs/stiff-7.mcap";
  fs::create_directories(log / "full");
  EXPECT_EQ(ErrorOf([&] { RunExperiment(Short(), {.out = out.path(), .force = true}); }),
            "cannot take away the older log " + log.string() +
                ": Directory not empty\nmove it, or give another --out");
}

TEST(ReadRuns, OrdersLogsAsTheExperimentDoes) {
  const TemporaryDirectory out;
  const auto logs = RunExperiment(Short({{"repeat", "2"}}), {.out = out.path()});
  std::vector<std::string> names;
  for (const RunData& run : ReadRuns({logs[3], logs[1], logs[2], logs[0]}))
    names.push_back(run.name + Text(run.repetition));
  EXPECT_THAT(names, ElementsAre("stiff0", "full0", "stiff1", "full1"));
}

TEST(ReportOf, RefusesLogsThatDoNotFitTogether) {
  const TemporaryDirectory out, other;
  const auto logs = RunExperiment(Short(), {.out = out.path()});
  const auto others = RunExperiment(Short({{"seed", "2"}}), {.out = other.path()});
  const auto error = [](const std::vector<fs::path>& of) {
    const std::string in_memory = ErrorOf([&] { ReportOf(ReadRuns(of)); });
    EXPECT_EQ(ErrorOf([&] { ReportOf(of); }), in_memory);  // one repetition at a time
    return in_memory;
  };
  EXPECT_EQ(error(logs), "no error");
  EXPECT_EQ(error({logs[1], logs[0]}), "no error");
  EXPECT_EQ(error({}), "a report needs the log of a run");
  EXPECT_EQ(error({logs[0]}),
            "repetition 0 has no log of run 'full'; a report needs one of each run");
  EXPECT_EQ(error({logs[0], logs[1], logs[0]}),
            "repetition 0 has 2 logs of run 'stiff'; a report needs one of each run");
  EXPECT_EQ(error({logs[0], others[1]}),
            others[1].string() + ": the log is of another experiment than " + logs[0].string());
}

TEST(RunData, RefusesWhatIsNoLogOfARun) {
  const TemporaryDirectory out;
  const auto error = [](const fs::path& file) { return ErrorOf([&] { RunData::Read(file); }); };
  const fs::path text = out.path() / "text.mcap", bare = out.path() / "bare.mcap",
                 partly = out.path() / "partly.mcap";
  std::ofstream(text) << "no log";
  const auto write = [](McapLog::Options options) {
    McapLog log(std::move(options));
    log.Begin(log.Open({{"a", "number", {""}, {""}}}), 0)[0] = 1;
    log.Commit();
    log.Close();
  };
  write({.file = bare});
  write({.file = partly, .metadata = {{"pliant", {{"version", "1"}}}}});
  EXPECT_THAT(error(out.path() / "none.mcap"), HasSubstr("none.mcap"));
  EXPECT_THAT(error(text), StartsWith(text.string() + ": "));
  EXPECT_EQ(error(bare),
            bare.string() + ": it has no record 'pliant'; expected a log that `pliant run` wrote");
  EXPECT_EQ(error(partly),
            partly.string() +
                ": its record 'pliant' says nothing under 'run'; expected a log that "
                "`pliant run` wrote");
}

TEST(ReportOf, HoldsAClaimOnlyIfItHoldsInEveryRepetition) {
  const TemporaryDirectory out;
  ExperimentFile file = Noisy();
  BoundClaim bound{.claim = {.id = "a", .source = "s", .paper = "p"},
                   .basis = "b",
                   .run = "stiff",
                   .number = {.signal = "arm.measured_position",
                              .elements = {"joint_1"},
                              .statistic = Statistic::Last}};
  bound.most = 10;
  file.experiment.claims = {bound};
  std::vector<RunData> runs = ReadRuns(RunExperiment(file, {.out = out.path()}));
  const Report holds = ReportOf(runs);
  EXPECT_TRUE(holds.claims.at(0).holds);
  EXPECT_THAT(holds.claims[0].measured,
              StartsWith("holds in 2 of 2 repetitions; in the first: last of "));
  EXPECT_THAT(holds.claims[0].criterion, HasSubstr("; in every repetition"));

  // A bound between what the two repetitions measured.
  const auto last = [&](std::size_t i) {
    return runs[i].log["arm.measured_position"]["joint_1"].tail<1>()(0);
  };
  bound.most = (last(0) + last(2)) / 2;
  file.experiment.claims = {bound};
  for (RunData& run : runs) run.experiment = file.text();
  const Report fails = ReportOf(runs);
  EXPECT_FALSE(fails.claims.at(0).holds);
  EXPECT_THAT(fails.claims[0].measured,
              StartsWith("holds in 1 of 2 repetitions; in the first that fails: last of "));
}

// A log may have 12 MB, and there may be a hundred: what is measured is dropped.
TEST(ReportOf, HoldsTwoRepetitionsInMemoryHoweverManyThereAre) {
  const TemporaryDirectory out;
  const ExperimentFile file = Short({{"repeat", "6"}, {"duration_s", "0.01"}});
  const auto logs = RunExperiment(file, {.out = out.path()});
  ASSERT_EQ(logs.size(), 12u);
  std::vector<std::weak_ptr<const RunData>> all;
  std::ptrdiff_t most = 0;
  const RunsReport of = ReportOf(logs, [&](const fs::path& log) {
    const std::shared_ptr<const RunData> run = ReadWhole(log);
    all.push_back(run);
    most = std::max(most, std::ranges::count_if(all, [](const auto& r) { return !r.expired(); }));
    return run;
  });
  EXPECT_EQ(all.size(), 12u);  // each is read once
  EXPECT_EQ(most, 4);          // the first repetition, and the one that is measured
  ASSERT_EQ(of.kept.size(), 2u);
  EXPECT_EQ(std::ranges::count_if(all, [](const auto& r) { return !r.expired(); }), 2);
  for (const auto& run : of.kept) EXPECT_EQ(run->repetition, 0);
  EXPECT_EQ(of.runs()["full"].name, "full");
  EXPECT_NEAR(of.report.timing->simulated_s, 12 * 0.01, 1e-9);
}

TEST(ReportOf, SaysTheSameOfLogsAsOfRunsInMemory) {
  const TemporaryDirectory out;
  ExperimentFile file = Noisy();
  file.experiment.figures = {LimitFigure{.run = "full"}};
  file.experiment.claims = {KeepsLimits{{.id = "a", .source = "s", .paper = "p"}}};
  const auto logs = RunExperiment(file, {.out = out.path()});
  const Report one = ReportOf(ReadRuns(logs)), other = ReportOf(logs).report;
  EXPECT_EQ(one.claims, other.claims);
  EXPECT_EQ(one.tables.size(), other.tables.size());
  for (std::size_t i = 0; i < one.tables.size(); ++i)
    EXPECT_EQ(one.tables[i].rows, other.tables[i].rows);
  EXPECT_EQ(one.figures.at(0).panels.at(0).curves.at(0).y,
            other.figures.at(0).panels.at(0).curves.at(0).y);
}

// Claims and bars over five repetitions: numbers of all of them, in the order of their seeds.
TEST(ReportOf, JudgesAllRepetitionsTogether) {
  const TemporaryDirectory out;
  ExperimentFile file = Noisy(5);
  const SignalNumber peak{.signal = "control.pose_error", .elements = {"x", "y", "z"}};
  const ClaimSource stated{.id = "a", .source = "s", .paper = "p"};
  DifferenceClaim differs{.claim = stated, .run = "stiff", .than = "full", .number = peak};
  file.experiment.claims = {differs};
  BarFigure bars{.name = "bars", .caption = "c", .runs = {"stiff", "full"}};
  bars.numbers = {{.title = "peak", .number = peak}};
  file.experiment.figures = {bars};
  const auto logs = RunExperiment(file, {.out = out.path()});
  const Report report = ReportOf(logs).report;

  RepeatedNumber expected(peak, {"stiff", "full"});
  const std::vector<RunData> runs = ReadRuns(logs);
  for (std::size_t k = 0; k < 10; k += 2) expected.Add(Runs({&runs[k], &runs[k + 1]}));
  EXPECT_EQ(report.claims.at(0), differs.Judge(expected));
  ASSERT_EQ(report.tables.size(), 4u);
  EXPECT_EQ(report.tables[0].rows, NumbersTable({expected}).rows);  // once for claim and bars
  EXPECT_EQ(report.tables[0].rows.size(), 2u);
  const Panel& panel = report.figures.at(0).panels.at(0);
  EXPECT_THAT(panel.title, StartsWith("peak ["));
  EXPECT_EQ(panel.bars.size(), 2u);
  EXPECT_EQ(panel.brackets.size(), 1u);

  // Three of the five can never support the claim.
  EXPECT_EQ(ErrorOf([&] { ReportOf(std::vector<fs::path>(logs.begin(), logs.begin() + 6)); }),
            "claim 'a': p of 3 repetitions is never below 0.1, and alpha is 0.05; give --repeat 4 "
            "or more");
}

TEST(ReportOf, SaysWhichClaimALogDoesNotFit) {
  const TemporaryDirectory out;
  ExperimentFile file = Short();
  BoundClaim bound{.claim = {.id = "a", .source = "s", .paper = "p"},
                   .basis = "b",
                   .run = "stiff",
                   .number = {.signal = "arm.energy", .from_s = 5}};
  bound.most = 1;
  file.experiment.claims = {bound};
  const auto logs = RunExperiment(file, {.out = out.path()});
  EXPECT_EQ(ErrorOf([&] { ReportOf(logs); }),
            "claim 'a': no row of arm.energy lies between from_s and to_s, got 5 and inf");
}

TEST(ReportOf, HoldsARunOfAMinuteInLessThanFiveMegabytes) {
  const TemporaryDirectory out;
  std::vector<RunData> runs =
      ReadRuns(RunExperiment(Short({{"runs", "~"}, {"duration_s", "1 ms"}}), {.out = out.path()}));
  // What the report and its plots show, with a minute of made-up numbers at 1 kHz.
  for (RunData& run : runs) {
    std::vector<RecordedSignal> signals;
    for (const char* path :
         {"arm.measured_position", "arm.measured_velocity", "control.torque", "control.pose_error"})
      signals.push_back(run.log[path]);
    for (RecordedSignal& signal : signals) {
      signal.times = Eigen::VectorXd::LinSpaced(60'001, 0, 60);
      const Eigen::Index rows = signal.numbers.rows();
      signal.numbers.resize(rows, signal.times.size());
      for (Eigen::Index i = 0; i < rows; ++i)
        signal.numbers.row(i) =
            (signal.times.array() * (1 + 0.1 * static_cast<double>(i))).sin().transpose();
    }
    run.log = Recording(signals, run.log.metadata(), run.log.robot_description());
  }
  const fs::path page = out.path() / "report/report.html";
  WriteReport(ReportOf(runs), Runs({&runs.front()}), page.parent_path());
  EXPECT_LT(fs::file_size(page), 5'000'000u);
  const std::string html = ReadText(page);
  EXPECT_THAT(html, HasSubstr("<section id=\"replay\">"));
  EXPECT_THAT(html, HasSubstr("id=\"data-0\""));
}

}  // namespace
}  // namespace pliant
