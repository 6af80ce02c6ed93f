#include "pliant/analysis/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Figure OneCurve(std::vector<double> x, std::vector<double> y) {
  return {.name = "one",
          .panels = {{.x = {.label = "time [s]"},
                      .left = {.label = "speed [m/s]"},
                      .curves = {{"speed", std::move(x), std::move(y)}}}}};
}

/// The lines of a data file that hold numbers.
std::vector<std::string> Rows(const std::filesystem::path& file) {
  std::istringstream in(ReadText(file));
  std::vector<std::string> rows;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with('#') && !line.empty()) rows.push_back(line);
  return rows;
}

class DrawFigureTest : public ::testing::Test {
 protected:
  std::string Draw(const Figure& figure) { return DrawFigure(figure, directory_.path()); }
  std::string ErrorOfDrawing(const Figure& figure) {
    return ErrorOf([&] { Draw(figure); });
  }
  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path()))
      names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }
  std::filesystem::path File(const std::string& name) const { return directory_.path() / name; }

  TemporaryDirectory directory_;
};

TEST_F(DrawFigureTest, LeavesTheDrawingTheScriptAndTheData) {
  const std::string svg = Draw(OneCurve({0, 1, 2}, {0, 0.5, 0.25}));
  EXPECT_THAT(Files(), ElementsAre("one.dat", "one.gp", "one.pdf", "one.svg"));
  EXPECT_THAT(ReadText(File("one.pdf")), ::testing::StartsWith("%PDF"));
  EXPECT_EQ(svg, ReadText(File("one.svg")));
  EXPECT_THAT(svg, HasSubstr("<text>speed [m/s]</text>"));
  EXPECT_THAT(Rows(File("one.dat")), ElementsAre("0 0", "1 0.5", "2 0.25"));
}

TEST_F(DrawFigureTest, TakesAHyphenInItsName) {
  Figure figure = OneCurve({0, 1}, {0, 1});
  figure.name = "one-curve";
  EXPECT_THAT(Draw(figure), HasSubstr("</svg>"));
  EXPECT_THAT(Files(),
              ElementsAre("one-curve.dat", "one-curve.gp", "one-curve.pdf", "one-curve.svg"));
}

TEST_F(DrawFigureTest, TheScriptGivesTheSameDrawing) {
  const std::string svg = Draw(OneCurve({0, 1, 2}, {0, 0.5, 0.25}));
  const std::string command =
      "cd " + directory_.path().string() + " && gnuplot -d one.gp > again.svg";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(ReadText(File("again.svg")), svg);
}

TEST_F(DrawFigureTest, KeepsTheExtremesOfALongCurve) {
  std::vector<double> x(1'000'000), y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = 1e-3 * static_cast<double>(i);
    y[i] = std::sin(1e4 * x[i]);
  }
  y[123'457] = 17.25;
  y[765'432] = -3.5;
  Draw(OneCurve(x, y));
  const std::vector<std::string> rows = Rows(File("one.dat"));
  EXPECT_LE(rows.size(), 2000u);
  EXPECT_GE(rows.size(), 1000u);
  EXPECT_THAT(rows, ::testing::Contains(::testing::EndsWith(" 17.25")));
  EXPECT_THAT(rows, ::testing::Contains(::testing::EndsWith(" -3.5")));
  EXPECT_THAT(rows.front(), ::testing::StartsWith("0 "));
  EXPECT_THAT(rows.back(), ::testing::StartsWith("999.999 "));
}

TEST_F(DrawFigureTest, LeavesAGapOfOneBlankLineForALongRunOfNaN) {
  std::vector<double> x(100'000), y(x.size(), 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
  std::fill(y.begin() + 20'000, y.begin() + 80'000, kNan);
  Draw(OneCurve(x, y));
  const std::string data = ReadText(File("one.dat"));
  EXPECT_THAT(data, Not(HasSubstr("\n\n\n")));
  const std::size_t gap = data.find("\n\n");
  ASSERT_NE(gap, std::string::npos);
  EXPECT_EQ(data.find("\n\n", gap + 1), std::string::npos);
}

TEST_F(DrawFigureTest, DrawsWhatHasNoNumbers) {
  EXPECT_THAT(Draw(OneCurve({}, {})), HasSubstr("<text>speed</text>"));
  EXPECT_THAT(Draw(OneCurve({0, 1}, {kNan, kNan})), HasSubstr("<text>speed</text>"));
  EXPECT_THAT(Draw(OneCurve({0, 1}, {kInfinity, -kInfinity})), HasSubstr("</svg>"));
  EXPECT_THAT(Draw(OneCurve({0, 1}, {1e300, -1e300})), HasSubstr("</svg>"));
  EXPECT_THAT(Draw(OneCurve({0, 1}, {1e99, -1e99})), HasSubstr("</svg>"));
  EXPECT_THAT(Draw(OneCurve({3}, {4})), HasSubstr("</svg>"));
}

// 1e-6 to 1e-2 with 6 % of the decades as room: 10^−6.24 to 10^−1.76.
TEST_F(DrawFigureTest, LogarithmicAxesShowEveryDecadeAndLeaveOutWhatIsNotAboveZero) {
  Figure figure = OneCurve({1, 10, 100}, {1e-6, 0, 1e-2});
  figure.panels[0].x.logarithmic = figure.panels[0].left.logarithmic = true;
  EXPECT_THAT(Draw(figure), HasSubstr("</svg>"));
  const std::string script = ReadText(File("one.gp"));
  EXPECT_THAT(script, HasSubstr("set logscale x\n"));
  EXPECT_THAT(script, HasSubstr("set logscale y\nset yrange [5.75"));
  EXPECT_THAT(script, HasSubstr("unset logscale y2\n"));
  figure.panels[0].left.from = 0;
  EXPECT_THAT(ErrorOfDrawing(figure),
              HasSubstr("the ends of a logarithmic axis are > 0 and finite, got 0"));
}

TEST_F(DrawFigureTest, DrawsBothSidesBandsLimitsAndBars) {
  Figure figure{.name = "all", .columns = 2};
  figure.panels.push_back({.title = "it's <both>",
                           .left = {.label = "speed [m/s]", .from = 0, .to = 2},
                           .right = {.label = "force [N]"},
                           .curves = {{"v", {0, 1}, {0, 1}},
                                      {"f", {0, 1}, {20, 30}, Side::Right, Curve::Draw::Steps},
                                      {"p", {0, 1}, {1, 1}, Side::Left, Curve::Draw::Points}},
                           .limits = {{1.5, "bound"}, {28, "", Side::Right}},
                           .x_bands = {{0.2, 0.4, "push"}},
                           .y_bands = {{1.5, kInfinity, "forbidden"}}});
  figure.panels.push_back({.bars = {{"PID", "load", 3, 0.5}, {"fusion", "load", 2, 0.25}}});
  const std::string svg = Draw(figure);
  for (const char* text :
       {"it's &lt;both>", "speed [m/s]", "force [N]", "bound", "push", "forbidden", "PID", "load"})
    EXPECT_THAT(svg, HasSubstr("<text>" + std::string(text) + "</text>"));
}

TEST_F(DrawFigureTest, DrawsBracketsAboveTheBarsEachHigherThanTheOneBefore) {
  Figure figure{.name = "bars"};
  figure.panels.push_back({.bars = {{"", "a", 1, 0.5}, {"", "b", 2, 0.25}, {"", "c", 3, 1}},
                           .brackets = {{0, 1, "n.s."}, {0, 2, "**"}}});
  const std::string svg = Draw(figure);
  EXPECT_THAT(svg, HasSubstr("<text>n.s.</text>"));
  EXPECT_THAT(svg, HasSubstr("<text>**</text>"));
  // Bars take 0 … 4; brackets stand 10 % above, and 16 % above each other; bars are 0.8/3 apart.
  const std::string script = ReadText(File("bars.gp"));
  EXPECT_THAT(script, ::testing::ContainsRegex("set label 'n.s.' at first -0.1333333[0-9]*,4.4"));
  EXPECT_THAT(script, HasSubstr("set label '**' at first 0,5.04"));
  EXPECT_THAT(script, HasSubstr("set yrange [-0."));
  EXPECT_THAT(script, HasSubstr("unset xtics"));  // there is but one group, without a name
}

TEST_F(DrawFigureTest, DrawsUprightLimitsDashesAndEqualScales) {
  Figure figure = OneCurve({0, 4}, {1, 2});
  figure.panels[0].curves.push_back({"slope", {0, 4}, {0, 1}, Side::Left, Curve::Draw::Dashes});
  figure.panels[0].x_limits = {{3, "wall"}};
  figure.panels[0].x_bands = {{3, kInfinity, "beyond", true}};
  figure.panels[0].equal_scales = true;
  const std::string svg = Draw(figure);
  for (const char* text : {"slope", "wall", "beyond"})
    EXPECT_THAT(svg, HasSubstr("<text>" + std::string(text) + "</text>"));
  const std::string script = ReadText(File("one.gp"));
  EXPECT_THAT(script, HasSubstr("set size ratio -1\n"));
  EXPECT_THAT(script, HasSubstr("set arrow from first 3, graph 0 to first 3, graph 1 nohead"));
  // x from 0 to 4 with 1/1000 as room, y as long about its middle, 1.
  EXPECT_THAT(script, HasSubstr("set xrange [-0.00"));
  EXPECT_THAT(script, HasSubstr("set yrange [-1.00"));
}

TEST_F(DrawFigureTest, DrawsAMapCellByCellAndLeavesOutWhatIsNotFinite) {
  Figure figure{.name = "map", .columns = 2, .panels = std::vector<Panel>(2)};
  figure.panels[0].map = HeatMap{.x = {"a", "it's"}, .y = {"1", "2"}, .values = {1, 2, 4, NAN}};
  figure.panels[1].curves.push_back({.label = "", .x = {0, 1}, .y = {0, 1}});
  EXPECT_TRUE(Draw(figure).find("<svg") != std::string::npos);
  const std::string data = ReadText(File("map.dat")), script = ReadText(File("map.gp"));
  EXPECT_NE(data.find("0 0 1\n1 0 2\n0 1 4\n"), std::string::npos) << data;
  EXPECT_NE(script.find("set cbrange [1:4]"), std::string::npos) << script;
  EXPECT_NE(script.find("set xtics ('a' 0, 'it''s' 1)"), std::string::npos) << script;
  EXPECT_NE(script.find("set xtics autofreq", script.find("it''s")), std::string::npos);

  figure.panels[0].map->values.pop_back();
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'map', panel 1: a map has a value for each of its 2 x 2 cells, got 3");
  figure.panels[0].map->x.clear();
  EXPECT_EQ(ErrorOfDrawing(figure), "figure 'map', panel 1: a map has columns and rows");
}

TEST_F(DrawFigureTest, RefusesBracketsAndScalesThatCannotBeDrawn) {
  Figure figure{.name = "one", .panels = {{.bars = {{"", "a", 1}, {"", "b", 2}}}}};
  figure.panels[0].brackets = {{0, 2, "*"}};
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: bracket '*': it is over two of 2 bars, counted from 0, got 0 "
            "and 2");
  figure.panels[0].brackets = {{1, 1, "*"}};
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: bracket '*': it is over two different bars, got 1 twice");
  figure = OneCurve({1}, {1});
  figure.panels[0].x_limits = {{kNan, "wall"}};
  EXPECT_EQ(ErrorOfDrawing(figure), "figure 'one', panel 1: limit 'wall' must be finite, got nan");
  figure = OneCurve({1}, {1});
  figure.panels[0].equal_scales = figure.panels[0].x.logarithmic = true;
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: axes of equal scales are not logarithmic");
}

TEST_F(DrawFigureTest, RefusesWhatCannotBeDrawn) {
  Figure figure = OneCurve({0, 1}, {0});
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: curve 'speed': there are as many y as x, got 2 x and 1 y");
  figure = OneCurve({0}, {0});
  figure.name = "../one";
  EXPECT_EQ(ErrorOfDrawing(figure),
            "the name of a figure is made of letters, digits, '_' and '-', got '../one'");
  figure = OneCurve({0}, {0});
  figure.columns = 0;
  EXPECT_EQ(ErrorOfDrawing(figure), "figure 'one': columns must be ≥ 1, got 0");
  EXPECT_EQ(ErrorOfDrawing({.name = "one"}), "figure 'one': it has no panel");
  EXPECT_EQ(ErrorOfDrawing({.name = "one", .panels = {{}}}),
            "figure 'one', panel 1: it shows either curves or bars or a map");
  figure = OneCurve({0}, {0});
  figure.panels[0].left = {.from = 2, .to = 1};
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: an axis goes from less to more, got 2 to 1");
  figure = OneCurve({0}, {0});
  figure.panels[0].y_bands = {{2, 1, "late"}};
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: band 'late': it goes from less to more, got 2 to 1");
  figure = OneCurve({0}, {0});
  figure.panels[0].limits = {{kInfinity, "bound"}};
  EXPECT_EQ(ErrorOfDrawing(figure), "figure 'one', panel 1: limit 'bound' must be finite, got inf");
  figure.panels[0].limits = {{1, "bound", Side::Right}};
  EXPECT_EQ(ErrorOfDrawing(figure),
            "figure 'one', panel 1: limit 'bound' is on the right, where no curve is");
  EXPECT_EQ(ErrorOfDrawing({.name = "one", .panels = {{.bars = {{"a", "b", 1, -1}}}}}),
            "figure 'one', panel 1: bar 'b': the deviation must be ≥ 0, got -1");
  EXPECT_THAT(Files(), ElementsAre());
}

TEST_F(DrawFigureTest, NamesThePackageWhereGnuplotIsMissing) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", directory_.path().c_str(), 1);
  const std::string drawing = ErrorOfDrawing(OneCurve({0, 1}, {0, 1}));
  const std::string asking = ErrorOf([] { RequireGnuplot(); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(drawing,
            "cannot run gnuplot, which draws the figures of a report: No such file or directory\n"
            "install the Debian package gnuplot-nox, or put the directory of gnuplot on PATH");
  EXPECT_EQ(asking, drawing);
  EXPECT_EQ(ErrorOf([] { RequireGnuplot(); }), "no error");
  EXPECT_THAT(Files(), ElementsAre("one.dat", "one.gp"));
}

TEST_F(DrawFigureTest, SaysWhatGnuplotSaysAndKeepsTheOlderDrawing) {
  const std::string svg = Draw(OneCurve({0, 1}, {0, 1}));
  const std::string path = std::getenv("PATH");
  std::ofstream(File("gnuplot")) << "#!/bin/sh\necho '<svg>'; echo 'line 3: no font' >&2; exit 1\n";
  std::filesystem::permissions(File("gnuplot"), std::filesystem::perms::owner_all);
  setenv("PATH", directory_.path().c_str(), 1);
  const std::string error = ErrorOfDrawing(OneCurve({0, 1}, {0, 2}));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(error, "gnuplot cannot draw " + File("one.svg").string() + ": line 3: no font\n");
  EXPECT_EQ(ReadText(File("one.svg")), svg);
  EXPECT_THAT(Files(), ElementsAre("gnuplot", "one.dat", "one.gp", "one.pdf", "one.svg"));
}

TEST_F(DrawFigureTest, DoesNotTakeHalfADrawing) {
  const std::string path = std::getenv("PATH");
  std::ofstream(File("gnuplot")) << "#!/bin/sh\necho '<svg>'\n";
  std::filesystem::permissions(File("gnuplot"), std::filesystem::perms::owner_all);
  setenv("PATH", directory_.path().c_str(), 1);
  const std::string error = ErrorOfDrawing(OneCurve({0, 1}, {0, 2}));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(error,
            "gnuplot drew only a part of " + File("one.svg").string() + "; is the disk full?");
  EXPECT_THAT(Files(), ElementsAre("gnuplot", "one.dat", "one.gp"));
}

}  // namespace
}  // namespace pliant
