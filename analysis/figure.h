#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// Which axis a curve or a limit belongs to.
enum class Side { Left, Right };

/// Points joined in their order. Values that are not finite leave a gap.
struct Curve {
  enum class Draw { Line, Steps, Points, Dashes };  ///< Dashes: grey, as a limit

  std::string label;  ///< in the legend; empty: not there
  std::vector<double> x, y;
  Side side = Side::Left;
  Draw draw = Draw::Line;
};

/// A mean and what it scatters by. Bars of one group stand together; bars of one label have one
/// colour.
struct Bar {
  std::string group, label;
  double mean;
  double deviation = 0;
};

/// A bracket over two bars of a panel, counted from 0, such as what a test says of them.
struct Bracket {
  std::size_t from, to;
  std::string label;
};

/// A shaded interval; an end may be infinite.
struct Band {
  double from, to;
  std::string label = {};
  bool forbidden = false;  ///< in the colour of y_bands
};

/// A dashed line across the panel, or upright.
struct LimitLine {
  double at;
  std::string label = {};
  Side side = Side::Left;
};

struct Axis {
  std::string label = {};                    ///< with its unit: "velocity [m/s]"
  std::optional<double> from = {}, to = {};  ///< none: so that everything is seen
  bool logarithmic = false;                  ///< what is not > 0 leaves a gap
};

/// Numbers over two lists, as colours; with few of them, also as digits.
struct HeatMap {
  std::vector<std::string> x, y;  ///< what stands below each column, and beside each row
  std::vector<double> values;     ///< row by row, from below; what is not finite is left empty
  std::string label = {};         ///< of the colours, with its unit
};

/// One pair of axes. With curves on both sides, what belongs to the left is blue and green, what
/// belongs to the right is orange.
struct Panel {
  std::string title = {};
  Axis x = {}, left = {}, right = {};
  std::vector<Curve> curves = {};
  std::vector<Bar> bars = {};            ///< instead of curves
  std::optional<HeatMap> map = {};       ///< instead of curves
  std::vector<Bracket> brackets = {};    ///< above the bars, each on a line of its own
  std::vector<LimitLine> limits = {};    ///< across, at a value of y
  std::vector<LimitLine> x_limits = {};  ///< upright, at a value of x; of no side
  std::vector<Band> x_bands = {};        ///< such as while a push lasts
  std::vector<Band> y_bands = {};        ///< of the left axis, such as beyond a bound
  bool equal_scales = false;             ///< one length for a unit of x and of the left axis
};

/// Panels in rows of `columns`: 1 stacks them, and panels of one x label share its range.
struct Figure {
  std::string name;  ///< of its files: letters, digits, '_' and '-'
  std::string caption = {};
  int columns = 1;
  std::vector<Panel> panels = {};
};

/// Draws a figure as directory/NAME.svg and NAME.pdf and leaves what it was drawn from beside them:
/// NAME.dat, and NAME.gp to restyle it with gnuplot. Long curves are thinned out to some 2000
/// points among which are the least and greatest of every stretch. Returns the SVG.
std::string DrawFigure(const Figure& figure, const std::filesystem::path& directory);

/// Throws Error unless DrawFigure will find gnuplot: to be asked before a long run.
void RequireGnuplot();

}  // namespace pliant
