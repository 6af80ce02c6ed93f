#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <map>

#include "pliant/analysis/run_sweep.h"
#include "pliant/analysis/sweep_part.h"
#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

const std::string kNumbers = R"(numbers:
  - {name: peak, title: peak, signal: control.pose_error, elements: [x, y, z]}
  - {name: last, title: at the end, signal: arm.measured_velocity, elements: [joint_4], statistic: last}
)";

const std::vector<std::string> kOver{"controller.pose.compliance=0,1",
                                     "environment.0.force.2=uniform(-30,-10)"};

ExperimentFile File() { return ExperimentFile::ReadText(kShort + kNumbers, "short.yaml"); }

Sweep Short(const std::vector<std::string>& over = kOver, std::uint64_t runs = 6) {
  return {File(), "stiff", over, runs};
}

void Write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(SweptValues, AreListsSpacedNumbersOrRandom) {
  EXPECT_THAT(SweptValue("a=1, [2, 3],{b: 4},\"x,y\"").values(),
              ElementsAre("1", "[2, 3]", "{b: 4}", "\"x,y\""));
  EXPECT_THAT(SweptValue("a=0:1:5").values(), ElementsAre("0", "0.25", "0.5", "0.75", "1"));
  EXPECT_THAT(SweptValue("a=0:0.6:3").values(), ElementsAre("0", "0.3", "0.6"));
  EXPECT_THAT(SweptValue("a=1:100:3:log").values(), ElementsAre("1", "10", "100"));
  const SweptValue uniform("a=uniform(-1, 3)"), normal("a=normal(5,2)");
  EXPECT_TRUE(uniform.is_random() && normal.is_random());
  EXPECT_EQ(uniform.mean(), 1);
  EXPECT_EQ(normal.mean(), 5);
  // 4 σ of the mean of n draws: 2/√3 and 2 are their standard deviations.
  double u = 0, n = 0;
  constexpr int kDraws = 10'000;
  for (int k = 0; k < kDraws; ++k) {
    const RandomStream stream = RandomStream(1).Part(static_cast<std::uint64_t>(k));
    u += uniform.Draw(stream) / kDraws;
    n += normal.Draw(stream) / kDraws;
  }
  EXPECT_NEAR(u, 1, 4 * 2 / std::sqrt(3.0 * kDraws));
  EXPECT_NEAR(n, 5, 4 * 2 / std::sqrt(1.0 * kDraws));
}

TEST(SweptValues, RefuseWhatSaysNothing) {
  const std::map<std::string, std::string> wrong{
      {"a", "expected path=values, such as payload.mass=0.5,1,2"},
      {"=1", "expected path=values, such as payload.mass=0.5,1,2"},
      {"a=1,,2", "a value is empty"},
      {"a=1:2:x", "expected from:to:count or from:to:count:log, with a count from 2 to 10000"},
      {"a=1:2:1", "expected from:to:count or from:to:count:log, with a count from 2 to 10000"},
      {"a=1:2:3:lin", "expected from:to:count or from:to:count:log, with a count from 2 to 10000"},
      {"a=0:2:3:log",
       "expected from:to:count or from:to:count:log, with a count from 2 to 10000, "
       "and of logarithms from and to > 0"},
      {"a=uniform(2,1)", "expected uniform(a,b) with a < b"},
      {"a=uniform(", "expected uniform(a,b) with a < b"},
      {"a=normal(1,0)", "expected normal(mean,sigma) with sigma > 0"},
      {"a=gauss(1,2)",
       "expected values, from:to:count, from:to:count:log, uniform(a,b) or normal(mean,sigma)"}};
  for (const auto& [text, message] : wrong)
    EXPECT_EQ(ErrorOf([&, &of = text] { SweptValue{of}; }), "swept " + text + ": " + message);
  std::string many = "a=0";
  for (int i = 0; i < 10'000; ++i) many += ",0";
  EXPECT_THAT(ErrorOf([&] { SweptValue{many}; }),
              HasSubstr("expected at most 10000 values, got 10001"));
}

TEST(Sweep, GivesEachRunItsCellItsSeedAndItsRandomValues) {
  const Sweep sweep = Short({"controller.pose.compliance=0,1", "duration_s=0.05,0.06,0.1",
                             "environment.0.force.2=uniform(-30,-10)"},
                            12);
  EXPECT_EQ(sweep.cells(), 6u);
  EXPECT_THAT(sweep.IndicesOf(0), ElementsAre(0, 0, 0));
  EXPECT_THAT(sweep.IndicesOf(1), ElementsAre(0, 1, 0));
  EXPECT_THAT(sweep.IndicesOf(3), ElementsAre(1, 0, 0));
  EXPECT_EQ(sweep.IndicesOf(9), sweep.IndicesOf(3));
  EXPECT_NE(sweep.SeedOf(9), sweep.SeedOf(3));
  EXPECT_NE(sweep.RandomValuesOf(9), sweep.RandomValuesOf(3));
  const Scenario scenario = sweep.ScenarioOf(4);
  EXPECT_EQ(scenario.duration_s, 0.06);
  EXPECT_EQ(ComplianceOf(scenario.controller).pose.compliance(0, 0), 1);
  EXPECT_EQ(scenario.seed, sweep.SeedOf(4));
  EXPECT_THAT(sweep.RandomValuesOf(4),
              ElementsAre(std::get<Push::Options>(scenario.environment[0]).force(2)));
  EXPECT_EQ(Short({"seed=5:6:2"}, 0).ScenarioOf(1).seed, 6u);
}

TEST(Sweep, RefusesBeforeAnyRunWhatCannotBeSwept) {
  const auto refusal = [](const std::vector<std::string>& over) {
    return ErrorOf([&] { Short(over); });
  };
  EXPECT_THAT(
      refusal({"controller.pose.compliancy=1"}),
      HasSubstr("swept controller.pose.compliancy=1: there is no 'compliancy' here; did you "
                "mean 'compliance'?"));
  EXPECT_THAT(refusal({"duration_s=0.1,-1"}), HasSubstr("swept duration_s=-1: "));
  EXPECT_THAT(refusal({"duration_s=uniform(-3,-2)"}), HasSubstr("swept duration_s=-2.5: "));
  EXPECT_EQ(refusal({"runs=1"}),
            "swept runs=1: a scenario has no key 'runs'; did you mean 'robot'?");
  EXPECT_EQ(refusal({"robot=gen3,lwr"}),
            "swept robot=gen3,lwr: all runs of a sweep have one robot");
  EXPECT_EQ(refusal({"seed=1", "seed=2"}),
            "swept seed=2: seed is swept too, and one would hide the other");
  EXPECT_EQ(refusal({"environment.0.force.1=5,6", "environment.00.force=[0,1,0],[0,2,0]"}),
            "swept environment.00.force=[0,1,0],[0,2,0]: environment.0.force.1 is swept too, and "
            "one would hide the other");
  EXPECT_EQ(ErrorOf([] {
              Short({"environment.0.force.1=5,6",
                     "environment." + std::string(60'000, '0') + ".force.2=5,6"});
            }),
            "no error");
  EXPECT_THAT(refusal({"seed=uniform(0,100)"}), HasSubstr("expected a whole number"));
  EXPECT_THAT(refusal({"environment.0.link=forearm_link,no_link"}),
              HasSubstr("has no link \"no_link\""));
  EXPECT_EQ(ErrorOf([] { Short({}, 1'000'000'001); }),
            "a sweep has at most 1000000000 runs, got 1000000001");
  EXPECT_THAT(ErrorOf([] {
                Sweep(ExperimentFile::ReadText(kShort + "repeat: 2\n", "s.yaml"), "stiff", {}, 0);
              }),
              HasSubstr("expected no 'repeat', and as many runs as are wanted, got 2"));
  EXPECT_EQ(ErrorOf([] { Sweep(File(), "", {}, 0); }),
            "the file has 2 runs; name the one to sweep: stiff, full");
  EXPECT_EQ(ErrorOf([] { Sweep(File(), "stif", {}, 0); }),
            "there is no run 'stif'; did you mean 'stiff'?");
  EXPECT_THAT(ErrorOf([] { Sweep(ExperimentFile::ReadText(kShort, "s.yaml"), "stiff", {}, 0); }),
              HasSubstr("there is no number to measure"));
  const auto of_numbers = [](const std::string& numbers) {
    return ErrorOf([&] { ExperimentFile::ReadText(kShort + "numbers:\n" + numbers, "s.yaml"); });
  };
  const std::string peak = "  - {name: peak, title: peak, signal: control.pose_error}\n";
  EXPECT_EQ(of_numbers(peak),
            "s.yaml: number 'peak': the elements of control.pose_error are in "
            "[rad] and in [m]; name elements of one unit");
  const std::string x = "  - {name: x, title: x, signal: arm.velocity}\n";
  EXPECT_EQ(of_numbers(x + x), "s.yaml: number 'x': there are two of that name");
  EXPECT_THAT(of_numbers("  - {name: a b, title: x, signal: arm.velocity}\n"),
              HasSubstr("number 'a b': the name of a number, which names its column, has letters"));
}

TEST(Sweep, RefusesWhatItsPartsCannotSay) {
  std::string over = "environment.0.force.2=-1";
  while (over.size() < Sweep::kMostText) over += ",-1." + std::string(1000, '0');
  EXPECT_THAT(ErrorOf([&] { Short({over}); }),
              testing::MatchesRegex("what is swept may take 524288 bytes to say; sweep fewer "
                                    "values, or from:to:count, got 5[0-9]+"));
}

TEST(Sweep, ReadsBackFromItsText) {
  const Sweep sweep = Short();
  const Sweep again = Sweep::ReadText(sweep.text(), "part");
  EXPECT_EQ(again.text(), sweep.text());
  EXPECT_EQ(again.ScenarioOf(3).seed, sweep.ScenarioOf(3).seed);
  EXPECT_THAT(sweep.units(), ElementsAre("m", "rad/s"));
}

TEST(RunSweep, MeasuresWhatTheLogOfTheSameRunSays) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  const SweepResults results = RunSweep(sweep);
  ASSERT_THAT(results.rows, SizeIs(6));
  EXPECT_NE(results.rows[0].numbers, results.rows[2].numbers);
  for (const std::uint64_t run : {0, 3}) {
    const auto logs = RunExperiment(sweep.FileOf(run), {.out = out.path() / std::to_string(run)});
    SweepRow row{.run = run, .random = sweep.RandomValuesOf(run)};
    sweep.Measure(RunData::Read(logs.front()).log, row);
    EXPECT_EQ(row, results.rows[run]);
  }
}

TEST(RunSweep, GivesAMatrixOfTheNumbersOfAFile) {
  const fs::path file = fs::path(PLIANT_SOURCE_DIR) / "examples/swept_arm.yaml";
  // shown: begin run
  const Sweep sweep(ExperimentFile::Read(file), "", {"controller.posture.compliance=0:1:3"}, 6);
  const SweepResults results = RunSweep(sweep, {.jobs = 2});
  const Eigen::MatrixXd numbers = results.numbers();  // a row for each run
  // shown: end run
  std::vector<std::string> names;
  for (const SweepColumn& column : results.columns()) names.push_back(column.name);
  EXPECT_THAT(names, ElementsAre("run", "controller.posture.compliance", "seed", "farthest",
                                 "fastest", "ended", "failed"));
  EXPECT_THAT(std::get<std::vector<std::string>>(results.columns().back().cells),
              testing::Each(""));
  ASSERT_EQ(numbers.rows(), 6);
  // Without noise only the values matter; the more the joints give way, the faster they are.
  EXPECT_EQ(numbers.topRows<3>(), numbers.bottomRows<3>());
  EXPECT_LT(numbers(0, 1), numbers(1, 1));
  EXPECT_LT(numbers(1, 1), numbers(2, 1));
}

TEST(RunSweep, LeavesTheSameTableHoweverItWasMade) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  const std::string table = CsvOf(RunSweep(sweep));
  EXPECT_EQ(CsvOf(RunSweep(sweep, {.out = out.path() / "jobs", .jobs = 2})), table);
  for (std::uint32_t i = 1; i <= 3; ++i)
    RunSweep(sweep, {.out = out.path() / "shards", .shard = {i, 3}});
  EXPECT_EQ(CsvOf(ReadSweep({out.path() / "shards"})), table);
  // With other shards than it was begun with nothing is made again.
  const auto size = [&] { return fs::file_size(out.path() / "shards/part-1-of-3"); };
  const auto before = size();
  std::uint64_t made = 0;
  RunSweep(sweep,
           {.out = out.path() / "shards",
            .progress = [&](std::uint64_t m, std::uint64_t, std::uint64_t, double) { made = m; }});
  EXPECT_EQ(made, 0u);
  EXPECT_EQ(size(), before);
}

TEST(RunSweep, GoesOnAfterAnEndInTheMiddleOfARow) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  const std::string table = CsvOf(RunSweep(sweep, {.out = out.path()}));
  const fs::path part = out.path() / "part-1-of-1";
  const std::string whole = ReadText(part);
  // Anywhere, in its head too.
  for (const std::size_t size : {whole.size() - 1, whole.size() - 290, whole.size() / 2,
                                 std::size_t{20}, std::size_t{3}, std::size_t{0}}) {
    Write(part, whole.substr(0, size));
    std::vector<std::string> said;
    const auto say = [&](const std::string& line) { said.push_back(line); };
    EXPECT_EQ(CsvOf(RunSweep(sweep, {.out = out.path(), .say = say})), table) << size;
    EXPECT_EQ(ReadText(part), whole) << size;
    EXPECT_EQ(said.size(), size > whole.size() / 2 ? 1u : 0u) << size;
  }
}

TEST(RunSweep, StopsAndGoesOn) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  std::atomic<bool> stop{false};
  const SweepResults some =
      RunSweep(sweep, {.out = out.path(),
                       .progress = [&](std::uint64_t made, std::uint64_t, std::uint64_t,
                                       double) { stop = made == 2; },
                       .stop = &stop});
  EXPECT_THAT(some.rows, SizeIs(2));
  EXPECT_THAT(some.missing(), ElementsAre(Pair(2u, 5u)));
  EXPECT_EQ(CsvOf(RunSweep(sweep, {.out = out.path()})), CsvOf(RunSweep(sweep)));
}

TEST(RunSweep, HasARowWithTheCauseOfARunThatFails) {
  // Half of the draws are below 0, which no duration is; a run of 0.02 s has no row from 0.05 s.
  const Sweep sweep{ExperimentFile::ReadText(kShort + R"(numbers:
  - {name: peak, title: peak, signal: arm.velocity, from_s: 0.05}
)",
                                             "short.yaml"),
                    "stiff",
                    {"duration_s=0.1,0.02", "controller.pose.weight=normal(0.5,10)"},
                    12};
  const SweepResults results = RunSweep(sweep);
  ASSERT_THAT(results.rows, SizeIs(12));
  for (const SweepRow& row : results.rows) {
    if (row.random[0] < 0)
      EXPECT_THAT(row.failed, HasSubstr("weight must be >= 0, got "));
    else if (row.run % 2 == 1)
      EXPECT_EQ(row.failed,
                "peak: no row of arm.velocity lies between from_s and to_s, got 0.05 "
                "and inf");
    else
      EXPECT_EQ(row.failed, "");
    EXPECT_EQ(std::isnan(row.numbers[0]), !row.failed.empty());
  }
  EXPECT_GE(results.failures(), 6u);
  const Report report = ReportOf(results);
  ASSERT_THAT(report.results, SizeIs(2));
  EXPECT_THAT(report.results[1].rows, SizeIs(2)) << "two kinds of causes";
}

TEST(ReportOfASweep, HasNoMeanOfNumbersWhoseSquaresOverflow) {
  SweepResults results = RunSweep(Short());
  results.rows[1].numbers[0] = 1e300;
  const TemporaryDirectory out;
  const Report report = ReportOf(results);
  WriteReport(report, out.path());
  const std::vector<std::string>& cells = report.results[0].rows[0];
  EXPECT_THAT((std::vector{cells[2], cells[3], cells[8], cells[9]}),
              ElementsAre("–", "–", "1e+300", "1"));
}

/// A file of an experiment in a folder, swept whole, and one byte of it changed.
TEST(SweepPart, PassesOverARowThatIsDamagedAndSaysSo) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  const std::string table = CsvOf(RunSweep(sweep, {.out = out.path()}));
  const fs::path part = out.path() / "part-1-of-1";
  std::string bytes = ReadText(part);
  const std::size_t second = bytes.find("row\n", bytes.find("row\n", sweep.text().size()) + 1);
  bytes[second + 20] ^= 1;
  Write(part, bytes);
  const std::size_t third = bytes.find("row\n", second + 1);
  const SweepResults damaged = ReadSweep({out.path()});
  EXPECT_THAT(damaged.told, ElementsAre(part.string() + ": bytes " + std::to_string(second) +
                                        " to " + std::to_string(third) + " are no row"));
  EXPECT_THAT(damaged.missing(), ElementsAre(Pair(1u, 1u)));
  EXPECT_EQ(CsvOf(RunSweep(sweep, {.out = out.path()})), table);
  EXPECT_THAT(ReadSweep({out.path()}).missing(), IsEmpty());

  // Of any length that a row claims to have nothing is believed.
  for (const char size : {'\xff', '\x7f', '\x01'}) {
    bytes = ReadText(part);
    for (const std::size_t at : {second + 4, second + 5, second + 6, second + 7}) bytes[at] = size;
    Write(part, bytes);
    EXPECT_THAT(ReadSweep({out.path()}).told, SizeIs(1));
  }
}

TEST(SweepPart, IsRefusedIfItIsNone) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  RunSweep(sweep, {.out = out.path()});
  const fs::path part = out.path() / "part-1-of-1";
  const std::string whole = ReadText(part);
  const auto refusal = [&](const std::string& bytes) {
    Write(part, bytes);
    const std::string of_merge = ErrorOf([&] { ReadSweep({out.path()}); });
    EXPECT_EQ(ErrorOf([&] { RunSweep(sweep, {.out = out.path()}); }), of_merge);
    EXPECT_EQ(ReadText(part), bytes);
    return of_merge;
  };
  EXPECT_EQ(refusal("something else"), part.string() +
                                           ": expected a part of a sweep, which begins "
                                           "with 'pliant sweep 1'; take the file away");
  std::string damaged = whole;
  damaged[100] ^= 1;
  const std::string head =
      part.string() +
      ": its head, which says what is swept, is damaged; take the file away, and "
      "the sweep makes its runs again";
  EXPECT_EQ(refusal(damaged), head);
  damaged = whole;
  for (const std::size_t at : {15, 16, 17, 18}) damaged[at] = '\x7f';
  EXPECT_EQ(refusal(damaged), head);
  for (std::size_t bit = 0; bit < 64; ++bit) {  // of size and checksum
    damaged = whole;
    damaged[15 + bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_EQ(refusal(damaged), head) << bit;
  }
}

TEST(SweepPart, IsRefusedIfItIsOfAnotherSweep) {
  const TemporaryDirectory out;
  RunSweep(Short(kOver, 1), {.out = out.path()});
  EXPECT_EQ(ErrorOf([&] { RunSweep(Short(kOver, 2), {.out = out.path()}); }),
            (out.path() / "part-1-of-1").string() +
                ": it is a part of another sweep\n  it has      runs: 1\n  this sweep  runs: 2\n"
                "give another --out, or take the parts there away");
  EXPECT_THAT(ErrorOf([&] {
                RunSweep(Short({"controller.pose.compliance=0,0.5", kOver[1]}, 1),
                         {.out = out.path(), .shard = {2, 2}});
              }),
              HasSubstr("it has      \"controller.pose.compliance=0,1\"\n  this sweep  "
                        "\"controller.pose.compliance=0,0.5\"\n"));
  EXPECT_THAT(SweepPartsIn(out.path()), SizeIs(1));  // nothing is left beside it
}

TEST(SweepPart, IsRefusedInThePlaceOfADevice) {
  const TemporaryDirectory out;
  const fs::path part = out.path() / "part-1-of-1";
  fs::create_symlink("/dev/full", part);  // which can be read without end
  EXPECT_EQ(ErrorOf([&] { RunSweep(Short(), {.out = out.path()}); }),
            part.string() + ": expected a file for a part of the sweep; give another --out");
}

TEST(SweepPart, IsRefusedWhileAnotherProcessWritesIt) {
  const TemporaryDirectory out;
  RunSweep(Short(), {.out = out.path()});
  const fs::path part = out.path() / "part-1-of-1";
  const int other = open(part.c_str(), O_RDWR);
  ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(ErrorOf([&] { RunSweep(Short(), {.out = out.path()}); }),
            part.string() + ": another process writes it; wait for it, or end it");
  EXPECT_THAT(ReadSweep({out.path()}).told,
              ElementsAre(part.string() + ": a process writes it; taken is what it has by now"));
  close(other);
}

TEST(ReadSweep, WantsAFolder) {
  EXPECT_EQ(ErrorOf([] { ReadSweep({}); }),
            "expected a folder with the parts of a sweep, got none");
}

TEST(ReadSweep, SaysWhatIsMissingTwiceOrNotTheSame) {
  const TemporaryDirectory out;
  const Sweep sweep = Short();
  const fs::path one = out.path() / "one", two = out.path() / "two";
  RunSweep(sweep, {.out = one, .shard = {1, 2}});
  EXPECT_THAT(ReadSweep({one}).missing(), ElementsAre(Pair(1u, 1u), Pair(3u, 3u), Pair(5u, 5u)));
  RunSweep(sweep, {.out = two});
  const SweepResults both = ReadSweep({one, two});
  EXPECT_TRUE(both.whole());
  EXPECT_THAT(both.repeated, ElementsAre(0u, 2u, 4u));
  EXPECT_EQ(CsvOf(both), CsvOf(ReadSweep({two})));

  const fs::path other = out.path() / "other";
  fs::create_directory(other);
  SweepRow row = ReadSweep({two}).rows[3];
  row.numbers[1] = std::nextafter(row.numbers[1], 1e9);
  SweepPart(other / "part-1-of-1", sweep).Append(row);
  EXPECT_THAT(ErrorOf([&] {
                ReadSweep({two, other});
              }),
              testing::MatchesRegex("run 3 is not the same in .*two/part-1-of-1 and in "
                                    ".*other/part-1-of-1: last, [-0-9.e]+ and [-0-9.e]+\n.*"));
  row.run = 99;
  SweepPart(other / "part-2-of-2", sweep).Append(row);
  EXPECT_THAT(ErrorOf([&] { ReadSweep({other}); }),
              HasSubstr("part-2-of-2: expected rows of runs 0 to 5, of 1 random values and 2 "
                        "numbers, got run 99 of 1 and 2"));
  const fs::path none = out.path() / "none";
  fs::create_directory(none);
  EXPECT_EQ(ErrorOf([&] { ReadSweep({none}); }),
            none.string() +
                ": there is no part of a sweep, a file such as part-1-of-1, which "
                "`pliant sweep` writes");
}

Shard ShardOf(const std::map<std::string, std::string>& variables) {
  return Shard::OfEnvironment([&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? std::optional<std::string>() : found->second;
  });
}

std::string TextOf(const Shard& shard) {
  return std::to_string(shard.number) + "/" + std::to_string(shard.of);
}

TEST(Shard, IsWhatALauncherSays) {
  EXPECT_EQ(TextOf(ShardOf({})), "1/1");
  EXPECT_EQ(TextOf(ShardOf({{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "4"}})), "3/4");
  EXPECT_EQ(TextOf(ShardOf({{"PMI_RANK", "0"}, {"PMI_SIZE", "2"}})), "1/2");
  std::map<std::string, std::string> slurm{{"SLURM_ARRAY_TASK_ID", "7"},
                                           {"SLURM_ARRAY_TASK_MIN", "5"},
                                           {"SLURM_ARRAY_TASK_COUNT", "4"},
                                           {"SLURM_PROCID", "0"},
                                           {"SLURM_NTASKS", "1"}};
  EXPECT_EQ(TextOf(ShardOf(slurm)), "3/4");
  slurm["SLURM_PROCID"] = "1";
  slurm["SLURM_STEP_NUM_TASKS"] = "2";
  EXPECT_EQ(TextOf(ShardOf(slurm)), "6/8");
  slurm["PMI_RANK"] = "0";  // of a library that srun starts for MPI
  slurm["PMI_SIZE"] = "3";
  EXPECT_EQ(TextOf(ShardOf(slurm)), "7/12");
  // A script that srun did not start has these too, and is one process.
  EXPECT_EQ(TextOf(ShardOf({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "4"}})), "1/1");
}

TEST(Shard, SharesAllRunsAndNoneTwice) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    int has = 0;
    for (std::uint32_t i = 1; i <= 3; ++i) has += Shard{i, 3}.has(run);
    EXPECT_EQ(has, 1);
  }
}

TEST(Shard, RefusesWhatIsNone) {
  for (const char* text : {"0/2", "3/2", "1", "a/2", "1/", "/2", "1/2/3", "-1/2", ""})
    EXPECT_EQ(
        ErrorOf([&] { Shard::Read(text); }),
        "--shard wants i/N with 1 <= i <= N <= 1000000, such as 2/8, got " + std::string(text));
  EXPECT_EQ(
      ErrorOf([] {
        ShardOf({{"OMPI_COMM_WORLD_RANK", "2"}});
      }),
      "the launcher's OMPI_COMM_WORLD_SIZE must be a whole number, got none; --shard 1/1 does "
      "without it");
  EXPECT_EQ(ErrorOf([] {
              ShardOf({{"PMI_RANK", "2"}, {"PMI_SIZE", "2"}});
            }),
            "the launcher's PMI_RANK=2 and PMI_SIZE=2 do not go together");
  EXPECT_EQ(ErrorOf([] {
              ShardOf({{"SLURM_ARRAY_TASK_ID", "9"},
                       {"SLURM_ARRAY_TASK_MIN", "1"},
                       {"SLURM_ARRAY_TASK_COUNT", "3"}});
            }),
            "the tasks of a Slurm array must be numbered without gaps, such as --array=0-2; task 9 "
            "of 3 from 1 is beyond them");
}

}  // namespace
}  // namespace pliant
