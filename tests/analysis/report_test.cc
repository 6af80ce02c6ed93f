#include "pliant/analysis/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::string kNasty = R"(a<b> & "c" 'd' é)";
const std::string kNastyEscaped = "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39; é";

Claim NoMotion() {
  return {.id = "no-motion",
          .source = "fig. 6",
          .paper = "neither moves",
          .measured = "0.4 mm/s",
          .criterion = "below 1 mm/s",
          .basis = "stated by us",
          .holds = true};
}

Report Sample() {
  Claim fails = NoMotion();
  fails.id = "both";
  fails.holds = false;
  fails.measured = kNasty;
  return {.title = "Title " + kNasty,
          .summary = "Summary " + kNasty,
          .settings = {{"seed " + kNasty, "7 " + kNasty}},
          .claims = {NoMotion(), fails},
          .figures = {{.name = "speed",
                       .caption = "Caption " + kNasty,
                       .panels = {{.title = "Panel " + kNasty,
                                   .curves = {{"v " + kNasty, {0, 1}, {0, 1}}}}}}},
          .tables = {{"Table " + kNasty, {"joint", "least"}, {{"elbow " + kNasty, "-0.3"}}}},
          .timing = Timing{12, 4, 12000, 40000, 160000}};
}

class WriteReportTest : public ::testing::Test {
 protected:
  std::filesystem::path Out() const { return directory_.path() / "deep" / "report"; }
  std::string Page() const { return ReadText(Out() / "report.html"); }
  std::string ErrorOfWriting(const Report& report) {
    return ErrorOf([&] { WriteReport(report, Out()); });
  }

  TemporaryDirectory directory_;
};

TEST_F(WriteReportTest, ThePageAsksForNothingElse) {
  WriteReport(Sample(), Out());
  const std::string page = Page();
  for (const char* request :
       {"http:", "https:", "src=", "url(", "@import", "<link", "<script", "xmlns", "file:"})
    EXPECT_THAT(page, Not(HasSubstr(request)));
  // References are to parts of the drawing itself.
  for (std::size_t at = 0; (at = page.find("href=", at)) != std::string::npos; ++at)
    EXPECT_EQ(page.substr(at + 6, 1), "#");
}

TEST_F(WriteReportTest, ThePageEscapesEveryText) {
  WriteReport(Sample(), Out());
  const std::string page = Page();
  EXPECT_THAT(page, Not(HasSubstr("a<b>")));
  EXPECT_THAT(page, Not(HasSubstr("& \"c\"")));
  for (const char* text : {"<h1>Title ", "<title>Title ", "Summary ", "seed ", "7 ", "<td>",
                           "Caption ", "Table ", "elbow "})
    EXPECT_THAT(page, HasSubstr(text + kNastyEscaped));
}

TEST_F(WriteReportTest, ThePageShowsEveryClaimAndTheTally) {
  WriteReport(Sample(), Out());
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("1 of 2 claims hold"));
  for (const char* text : {"no-motion", "both", "fig. 6", "neither moves", "0.4 mm/s",
                           "below 1 mm/s", "stated by us", "✓ yes", "✗ no"})
    EXPECT_THAT(page, HasSubstr(text));
}

TEST_F(WriteReportTest, ThePageShowsFiguresAndTimes) {
  WriteReport(Sample(), Out());
  const std::string page = Page();
  EXPECT_THAT(page, HasSubstr("<svg role=\"img\""));
  EXPECT_THAT(page, HasSubstr("var(--blue)"));
  for (const char* text : {"12.0 s", "4.00 s", "3.00", "12000", "40000", "160000"})
    EXPECT_THAT(page, HasSubstr(">" + std::string(text) + "</td>"));
  EXPECT_THAT(ReadText(Out() / "figures" / "speed.svg"), HasSubstr("</svg>"));
}

TEST_F(WriteReportTest, TheVerdictIsReadBack) {
  const Report report = Sample();
  WriteReport(report, Out());
  const auto verdict = nlohmann::json::parse(ReadText(Out() / "verdict.json"));
  ASSERT_EQ(verdict.at("claims").size(), report.claims.size());
  for (std::size_t i = 0; i < report.claims.size(); ++i) {
    const auto& c = verdict["claims"][i];
    const Claim read{c.at("id"),        c.at("source"), c.at("paper"), c.at("measured"),
                     c.at("criterion"), c.at("basis"),  c.at("holds")};
    EXPECT_EQ(read, report.claims[i]);
  }
}

TEST_F(WriteReportTest, AReportOfATitleIsEnough) {
  WriteReport({.title = "Nothing", .summary = ""}, Out());
  EXPECT_THAT(Page(), HasSubstr("<h1>Nothing</h1>"));
  EXPECT_EQ(nlohmann::json::parse(ReadText(Out() / "verdict.json")).at("claims").size(), 0u);
}

TEST_F(WriteReportTest, TwoRunsAreTheSameBytes) {
  WriteReport(Sample(), Out());
  const std::string first = Page();
  WriteReport(Sample(), Out());
  EXPECT_EQ(Page(), first);
}

TEST_F(WriteReportTest, RefusesABadReportBeforeItWrites) {
  Report report = Sample();
  report.title = "";
  EXPECT_EQ(ErrorOfWriting(report), "a report has a title");
  report = Sample();
  report.claims[0].id = "";
  EXPECT_EQ(ErrorOfWriting(report), "a claim has an id, this one does not: neither moves");
  report = Sample();
  report.claims[1].id = "no-motion";
  EXPECT_EQ(ErrorOfWriting(report), "claim 'no-motion': the report has it twice");
  report = Sample();
  report.claims[1].basis = "";
  EXPECT_EQ(ErrorOfWriting(report), "claim 'both': it says nothing under 'basis'");
  report = Sample();
  report.figures.push_back(report.figures[0]);
  EXPECT_EQ(ErrorOfWriting(report), "figure 'speed': the report has it twice");
  report = Sample();
  report.figures[0].panels[0].curves[0].y.pop_back();
  EXPECT_THAT(ErrorOfWriting(report), HasSubstr("there are as many y as x, got 2 x and 1 y"));
  report = Sample();
  report.tables[0] = {"Torques", {"joint", "least"}, {{"elbow"}}};
  EXPECT_EQ(ErrorOfWriting(report), "table 'Torques': a row has 2 cells, got 1");
  report.tables[0] = {"Torques", {}, {}};
  EXPECT_EQ(ErrorOfWriting(report), "table 'Torques': it has no columns");
  report = Sample();
  report.timing->wall_s = 0;
  EXPECT_EQ(ErrorOfWriting(report), "timing: simulated_s must be ≥ 0 and wall_s > 0, got 12 and 0");
  report = Sample();
  report.timing->ticks = -1;
  EXPECT_EQ(ErrorOfWriting(report), "timing: a count must be ≥ 0, got -1");
  EXPECT_FALSE(std::filesystem::exists(Out()));
}

TEST_F(WriteReportTest, AFileInTheWayIsNamed) {
  std::ofstream(directory_.path() / "deep") << "a file";
  EXPECT_EQ(ErrorOfWriting(Sample()),
            "cannot make the directory " + Out().string() + ": Not a directory");
}

TEST_F(WriteReportTest, ADirectoryThatCannotBeWrittenIsNamed) {
  EXPECT_EQ(ErrorOf([] { WriteReport(Sample(), "/proc"); }),
            "cannot make the directory /proc/figures: No such file or directory");
}

TEST_F(WriteReportTest, AFullDiskLeavesTheOlderFile) {
  WriteReport(Sample(), Out());
  const std::string before = Page();
  // Every write to this device fails as on a full disk.
  std::filesystem::create_symlink("/dev/full", Out() / "report.html.part");
  Report report = Sample();
  report.title = "Newer";
  EXPECT_EQ(ErrorOfWriting(report),
            "cannot write " + (Out() / "report.html").string() + ": No space left on device");
  EXPECT_EQ(Page(), before);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(Out()))
    names.push_back(entry.path().filename());
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("figures", "report.html", "verdict.json"));
}

TEST(ExtentsTable, MeasuresUseFromTheMiddleOfTheBounds) {
  const Table table = ExtentsTable("Positions", "rad",
                                   {{"shoulder", -0.5, 1, -2, 2},
                                    {"elbow", 0.5, 1.5, 0, 2},
                                    {"wrist", -9, 9, -kInfinity, kInfinity},
                                    {"over", -2.2, 0, -2, 2}});
  EXPECT_THAT(table.columns, ElementsAre("", "least [rad]", "greatest [rad]", "lower [rad]",
                                         "upper [rad]", "used"));
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre("shoulder", "-0.5", "1", "-2", "2", "50.0 %"),
                                      ElementsAre("elbow", "0.5", "1.5", "0", "2", "50.0 %"),
                                      ElementsAre("wrist", "-9", "9", "–", "–", "–"),
                                      ElementsAre("over", "-2.2", "0", "-2", "2", "110.0 % ✗")));
}

TEST(ExtentsTable, RefusesBoundsThatAreCrossed) {
  EXPECT_EQ(ErrorOf([] {
              ExtentsTable("Positions", "rad", {{"elbow", 0, 0, 1, -1}});
            }),
            "table 'Positions', elbow: the lower bound is below the upper one, got 1 and -1");
}

}  // namespace
}  // namespace pliant
