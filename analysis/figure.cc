#include "pliant/analysis/figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>

#include "pliant/analysis/figure_data.h"
#include "pliant/analysis/figure_style.h"
#include "pliant/analysis/gnuplot.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

using internal::Colour;

constexpr int kWidth = 900;  // of all figures [px]

struct Range {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();

  void Cover(double value) {
    if (!internal::IsDrawable(value)) return;
    from = std::min(from, value);
    to = std::max(to, value);
  }
  bool empty() const { return from > to; }
};

/// Room on both sides, and some where nothing varies.
Range Widened(Range range, double share) {
  if (range.empty()) return {0, 1};
  const double largest = std::max(std::abs(range.from), std::abs(range.to));
  double room = share * (range.to - range.from);
  if (range.to - range.from <= 1e-12 * largest || largest == 0)
    room = largest > 0 ? 0.1 * largest : 1;
  return {range.from - room, range.to + room};
}

/// Where a value stands along an axis; a value that a logarithmic one cannot show is not finite.
double Place(double value, const Axis& axis) {
  return axis.logarithmic ? std::log10(value) : value;
}

Range Chosen(Range range, const Axis& axis) {
  if (axis.logarithmic) range = {std::pow(10, range.from), std::pow(10, range.to)};
  return {axis.from.value_or(range.from), axis.to.value_or(range.to)};
}

/// A string of gnuplot, in which nothing but a quote has a meaning.
std::string Quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + "'";
}

std::string Number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}

std::string Rgb(const Colour& colour) { return "rgb '" + std::string(colour.light) + "'"; }

bool UsesRight(const Panel& panel) {
  return std::ranges::any_of(panel.curves, [](const Curve& c) { return c.side == Side::Right; });
}

// ---- what is refused -------------------------------------------------------------------------

void CheckAxis(const std::string& where, const Axis& axis) {
  if (axis.from && axis.to)
    Require(*axis.from < *axis.to, where + "an axis goes from less to more",
            Number(*axis.from) + " to " + Number(*axis.to));
  for (const auto& end : {axis.from, axis.to})
    Require(!end || internal::IsDrawable(Place(*end, axis)),
            where + (axis.logarithmic ? "the ends of a logarithmic axis are > 0 and finite"
                                      : "the ends of an axis are finite"),
            end.value_or(0));
}

void CheckMap(const std::string& where, const HeatMap& map) {
  Require(!map.x.empty() && !map.y.empty(), where + "a map has columns and rows");
  Require(map.values.size() == map.x.size() * map.y.size(),
          where + "a map has a value for each of its " + std::to_string(map.x.size()) + " x " +
              std::to_string(map.y.size()) + " cells",
          map.values.size());
}

void CheckPanel(const std::string& where, const Panel& panel) {
  Require((!panel.curves.empty()) + (!panel.bars.empty()) + panel.map.has_value() == 1,
          where + "it shows either curves or bars or a map");
  if (panel.map) CheckMap(where, *panel.map);
  for (const Axis& axis : {panel.x, panel.left, panel.right}) CheckAxis(where, axis);
  for (const Curve& curve : panel.curves)
    Require(curve.x.size() == curve.y.size(),
            where + "curve '" + curve.label + "': there are as many y as x",
            std::to_string(curve.x.size()) + " x and " + std::to_string(curve.y.size()) + " y");
  for (const Bar& bar : panel.bars)
    Require(bar.deviation >= 0, where + "bar '" + bar.label + "': the deviation must be ≥ 0",
            bar.deviation);
  for (const Bracket& bracket : panel.brackets) {
    Require(bracket.from < panel.bars.size() && bracket.to < panel.bars.size(),
            where + "bracket '" + bracket.label + "': it is over two of " +
                std::to_string(panel.bars.size()) + " bars, counted from 0",
            std::to_string(bracket.from) + " and " + std::to_string(bracket.to));
    Require(bracket.from != bracket.to,
            where + "bracket '" + bracket.label + "': it is over two different bars",
            std::to_string(bracket.from) + " twice");
  }
  Require(!panel.equal_scales || !(panel.x.logarithmic || panel.left.logarithmic),
          where + "axes of equal scales are not logarithmic");
  for (const LimitLine& limit : panel.x_limits)
    Require(internal::IsDrawable(Place(limit.at, panel.x)),
            where + "limit '" + limit.label + "' must be finite", limit.at);
  for (const auto* bands : {&panel.x_bands, &panel.y_bands})
    for (const Band& band : *bands)
      Require(band.from < band.to, where + "band '" + band.label + "': it goes from less to more",
              Number(band.from) + " to " + Number(band.to));
  for (const LimitLine& limit : panel.limits) {
    Require(internal::IsDrawable(limit.at), where + "limit '" + limit.label + "' must be finite",
            limit.at);
    Require(limit.side == Side::Left || UsesRight(panel),
            where + "limit '" + limit.label + "' is on the right, where no curve is");
  }
}

// ---- ranges ----------------------------------------------------------------------------------

Range XRange(const Panel& panel) {
  Range range;
  bool in_time = true;
  for (const Curve& curve : panel.curves) {
    for (const double x : curve.x) range.Cover(Place(x, panel.x));
    in_time = in_time && !panel.x.logarithmic && curve.draw != Curve::Draw::Points &&
              std::ranges::is_sorted(curve.x);
  }
  for (const LimitLine& limit : panel.x_limits) range.Cover(Place(limit.at, panel.x));
  return Widened(range, in_time ? 1e-3 : 0.04);  // the last tick stands at its end
}

/// The height of a bracket: above all bars, each above the one before.
double BracketAt(const Panel& panel, std::size_t number) {
  Range range;
  range.Cover(0);
  for (const Bar& bar : panel.bars) {
    range.Cover(bar.mean + bar.deviation);
    range.Cover(bar.mean - bar.deviation);
  }
  const double height = range.to > range.from ? range.to - range.from : 1;
  return range.to + (0.1 + 0.16 * static_cast<double>(number)) * height;
}

Range YRange(const Panel& panel, Side side) {
  const Axis& axis = side == Side::Left ? panel.left : panel.right;
  Range range;
  for (const Curve& curve : panel.curves)
    if (curve.side == side)
      for (const double y : curve.y) range.Cover(Place(y, axis));
  for (const LimitLine& limit : panel.limits)
    if (limit.side == side) range.Cover(Place(limit.at, axis));
  if (side == Side::Left)
    for (const Bar& bar : panel.bars)
      for (const double y : {0.0, bar.mean - bar.deviation, bar.mean + bar.deviation})
        range.Cover(y);
  // As much again as the brackets take, of what the bars take.
  if (side == Side::Left && !panel.brackets.empty() && !range.empty())
    range.Cover(BracketAt(panel, panel.brackets.size()));
  return Widened(range, 0.06);
}

/// Stacked panels of one x label are read against each other, so they show one stretch of it.
Range SharedXRange(const Figure& figure, const Panel& panel) {
  Range range;
  for (const Panel& other : figure.panels) {
    if (&other != &panel && (figure.columns > 1 || other.x.label != panel.x.label)) continue;
    const Range its = XRange(other);
    range.Cover(its.from);
    range.Cover(its.to);
  }
  return Chosen(range, panel.x);
}

/// A legend of several rows above a panel would leave it no height.
bool HasManyLabels(const Panel& panel) {
  return std::ranges::count_if(panel.curves, [](const Curve& c) { return !c.label.empty(); }) > 7;
}

// ---- the script ------------------------------------------------------------------------------

constexpr std::string_view kStyle =
    R"(set encoding utf8
set style line 100 lc rgb '#262626' lw 1
set style line 101 lc rgb '#d9d9d9' lw 0.8
set style line 102 lc rgb '#737373' lw 1.4 dt (6,4)
set border 3 ls 100
set tics nomirror out scale 0.5 textcolor rgb '#262626'
set format '%g'
set grid xtics ytics back ls 101
set key outside top left horizontal Left reverse samplen 1.8 spacing 1.1 textcolor rgb '#262626'
set xtics offset 0,0.3
set xlabel offset 0,0.5
set ylabel offset 0.8,0
set y2label offset -0.8,0
set title offset 0,-0.5
set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', 5 '#fde725')
set colorbox
)";

/// Writes the script and, as it goes along, the data its curves are the blocks of.
class Script {
 public:
  explicit Script(const Figure& figure);

  const std::string& data() const { return data_; }
  std::string text() const { return text_.str(); }

 private:
  void Draw(const Panel& panel, bool names_x);
  void Ranges(const Panel& panel);
  void Labels(const Panel& panel, bool names_x);
  void Bands(const Panel& panel);
  void Limits(const Panel& panel);
  void Curves(const Panel& panel);
  void Dashes(const Curve& curve);
  void Brackets(const Panel& panel, const std::vector<double>& at);
  void Bars(const Panel& panel);
  void Map(const HeatMap& map);
  void Rectangle(const std::string& from, const std::string& to, const Colour& colour,
                 const std::string& label);
  /// The block's place in the data file, as gnuplot asks for it.
  std::string AddBlock(const std::string& comment, const std::string& block);

  const Figure& figure_;
  std::ostringstream text_;
  std::string data_;
  std::string plots_;
  int blocks_ = 0;
};

Script::Script(const Figure& figure) : figure_{figure} {
  std::string name = figure.name;
  std::ranges::replace(name, '-', '_');  // gnuplot takes no hyphen in the name of a drawing
  const std::size_t columns =
      std::min(static_cast<std::size_t>(figure.columns), figure.panels.size());
  const std::size_t rows = (figure.panels.size() + columns - 1) / columns;
  const bool many = std::ranges::any_of(figure.panels, HasManyLabels);
  const bool equal = std::ranges::any_of(figure.panels, &Panel::equal_scales);
  const bool bracketed =
      std::ranges::any_of(figure.panels, [](const Panel& p) { return !p.brackets.empty(); });
  const bool mapped =
      std::ranges::any_of(figure.panels, [](const Panel& p) { return p.map.has_value(); });
  const std::size_t height = columns == 1 && equal                   ? 600
                             : columns > 1 && bracketed              ? 420
                             : columns == 1 && (rows == 1 || mapped) ? 400
                             : columns == 1 && !many                 ? 250
                                                                     : 340;
  const auto inches = [](double pixels) { return Number(pixels / 96); };
  text_ << "# gnuplot " << figure.name << ".gp > " << figure.name << ".svg\n"
        << "# gnuplot -e 'pdf = 1' " << figure.name << ".gp > " << figure.name << ".pdf\n"
        << "if (exists('pdf')) set terminal pdfcairo size " << inches(kWidth) << ","
        << inches(static_cast<double>(rows * height)) << " noenhanced font 'sans-serif,10'\n"
        << "if (!exists('pdf')) set terminal svg size " << kWidth << "," << rows * height
        << " dynamic noenhanced font 'sans-serif,13' background rgb 'white' name '" << name << "'\n"
        << kStyle << "set multiplot layout " << rows << "," << columns << "\n";
  if (many) text_ << "set key outside right top vertical\n";
  // Plots of one figure stand under each other, whatever their numbers look like.
  if (columns > 1) text_ << "set key width -1 samplen 1.2\n";
  if (figure.panels.size() > 1) {
    const bool right = std::ranges::any_of(figure.panels, UsesRight);
    const bool powers =
        std::ranges::any_of(figure.panels, [](const Panel& p) { return p.left.logarithmic; });
    const int room = columns == 1 || powers ? 10 : 8;
    text_ << "set lmargin " << room << "\nset rmargin "
          << (many     ? 22
              : mapped ? 12
              : right  ? room
                       : 3)
          << "\n";
  }
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const bool named_below = columns == 1 && p + 1 < figure.panels.size() &&
                             figure.panels[p + 1].x.label == figure.panels[p].x.label;
    Draw(figure.panels[p], !named_below);
  }
  text_ << "unset multiplot\n";
}

void Script::Draw(const Panel& panel, bool names_x) {
  text_ << "\nunset object\nunset arrow\nunset label\n"
        << (panel.equal_scales ? "set size ratio -1\n" : "set size noratio\n");
  plots_.clear();
  Labels(panel, names_x);
  Ranges(panel);
  Bars(panel);
  if (panel.map) Map(*panel.map);
  Curves(panel);
  Bands(panel);
  Limits(panel);
  // The first item keeps the axes where there is nothing to draw.
  text_ << "plot NaN notitle" << plots_ << "\n";
}

void Script::Labels(const Panel& panel, bool names_x) {
  const bool right = UsesRight(panel);
  const auto label = [&](const char* axis, const std::string& text, const Colour& colour) {
    text_ << "set " << axis << "label " << Quoted(text) << " textcolor " << Rgb(colour) << "\n";
  };
  text_ << "set title " << Quoted(panel.title) << " textcolor " << Rgb(internal::kInk) << "\n";
  label("x", names_x ? panel.x.label : "", internal::kInk);
  label("y", panel.left.label, right ? internal::kBlue : internal::kInk);
  label("y2", right ? panel.right.label : "", internal::kVermillion);
  text_ << "set border " << (right ? 11 : 3) << "\n"
        << "set xtics autofreq\n"
        << (panel.map ? "unset grid\nset style fill solid 1 noborder\n"
                      : "set grid xtics ytics back ls 101\nset style fill solid 0.75 noborder\n")
        << "set ytics autofreq textcolor " << Rgb(right ? internal::kBlue : internal::kInk) << "\n"
        << (right ? "set y2tics textcolor " + Rgb(internal::kVermillion) : "unset y2tics") << "\n";
}

void Script::Ranges(const Panel& panel) {
  const auto set = [&](const char* name, const Range& range, const Axis& axis) {
    text_ << (axis.logarithmic ? "set" : "unset") << " logscale " << name << "\nset " << name
          << "range [" << Number(range.from) << ":" << Number(range.to) << "]\n";
  };
  Range x = SharedXRange(figure_, panel), y = Chosen(YRange(panel, Side::Left), panel.left);
  if (panel.equal_scales) {
    // As long as each other: a thin strip has no room for its numbers.
    const double length = std::max(x.to - x.from, y.to - y.from);
    for (Range* range : {&x, &y}) {
      const double middle = (range->from + range->to) / 2;
      *range = {middle - length / 2, middle + length / 2};
    }
  }
  set("x", x, panel.x);
  set("y", y, panel.left);
  set("y2", Chosen(YRange(panel, Side::Right), panel.right), panel.right);
}

void Script::Curves(const Panel& panel) {
  const bool right = UsesRight(panel);
  std::array<std::size_t, 2> drawn{};  // on each side
  for (const Curve& curve : panel.curves) {
    if (curve.draw == Curve::Draw::Dashes) {
      Dashes(curve);
      continue;
    }
    const bool on_the_right = curve.side == Side::Right;
    const std::span<const Colour> colours = on_the_right
                                                ? std::span<const Colour>(internal::kOnTheRight)
                                            : right ? std::span<const Colour>(internal::kOnTheLeft)
                                                    : std::span<const Colour>(internal::kAlone);
    const std::size_t number = drawn[on_the_right]++;
    const std::size_t dash = number / colours.size();
    const std::string style =
        curve.draw == Curve::Draw::Points
            ? "points pt 7 ps 0.35"
            : (curve.draw == Curve::Draw::Steps ? "steps lw 1.8 dt " : "lines lw 1.8 dt ") +
                  std::to_string(dash % 4 + 1);
    const std::string look = " with " + style + " lc " + Rgb(colours[number % colours.size()]) +
                             (curve.label.empty() ? " notitle" : " title " + Quoted(curve.label));
    const std::string block = internal::DataOf(curve);
    plots_ += ", \\\n  ";
    plots_ += block.empty() ? "keyentry" + look
                            : AddBlock(curve.label, block) + " using 1:2 axes x1" +
                                  (on_the_right ? "y2" : "y1") + look;
  }
}

void Script::Dashes(const Curve& curve) {
  const std::string look =
      " with lines ls 102" + (curve.label.empty() ? " notitle" : " title " + Quoted(curve.label));
  const std::string block = internal::DataOf(curve);
  plots_ += ", \\\n  ";
  plots_ += block.empty() ? "keyentry" + look
                          : AddBlock(curve.label, block) + " using 1:2 axes x1" +
                                (curve.side == Side::Right ? "y2" : "y1") + look;
}

void Script::Bars(const Panel& panel) {
  if (panel.bars.empty()) return;
  std::vector<std::string> groups, labels;
  const auto place = [](std::vector<std::string>& names, const std::string& name) {
    const auto at = std::ranges::find(names, name);
    const std::ptrdiff_t i = at - names.begin();
    if (at == names.end()) names.push_back(name);
    return static_cast<double>(i);
  };
  for (const Bar& bar : panel.bars) {
    place(groups, bar.group);
    place(labels, bar.label);
  }
  const double width = 0.8 / static_cast<double>(labels.size());
  text_ << "set boxwidth " << Number(0.9 * width) << " absolute\nset xtics (";
  for (std::size_t g = 0; g < groups.size(); ++g)
    text_ << (g ? ", " : "") << Quoted(groups[g]) << " " << g;
  text_ << (groups == std::vector<std::string>{""} ? ")\nunset xtics" : ")")
        << "\nset xrange [-0.6:" << Number(static_cast<double>(groups.size()) - 0.4) << "]\n";

  std::vector<double> at(panel.bars.size());
  for (std::size_t l = 0; l < labels.size(); ++l) {
    const double offset =
        width * (static_cast<double>(l) - 0.5 * static_cast<double>(labels.size() - 1));
    std::string block;
    bool scatters = false;
    for (std::size_t i = 0; i < panel.bars.size(); ++i) {
      const Bar& bar = panel.bars[i];
      if (bar.label != labels[l]) continue;
      at[i] = place(groups, bar.group) + offset;
      if (!internal::IsDrawable(bar.mean)) continue;
      const double deviation = internal::IsDrawable(bar.deviation) ? bar.deviation : 0;
      block += Number(at[i]) + " " + Number(bar.mean) + " " + Number(deviation) + "\n";
      scatters = scatters || deviation > 0;
    }
    if (block.empty()) continue;
    const std::string from = ", \\\n  " + AddBlock(labels[l], block);
    plots_ += from + " using 1:2 with boxes lc " +
              Rgb(internal::kAlone[l % internal::kAlone.size()]) + " title " + Quoted(labels[l]);
    if (scatters)
      plots_ += from +
                " using 1:($2-$3):(0):(2*$3) with vectors heads size screen 0.004,90 lw 1.2 lc " +
                Rgb(internal::kInk) + " notitle";
  }
  Brackets(panel, at);
}

void Script::Map(const HeatMap& map) {
  // As many names as there is room for.
  constexpr std::size_t kNames = 10, kDigitsFit = 130;
  const auto tics = [&](const char* axis, const std::vector<std::string>& names) {
    const std::size_t step = (names.size() + kNames - 1) / kNames;
    text_ << "set " << axis << "tics (";
    for (std::size_t i = 0; i < names.size(); i += step)
      text_ << (i ? ", " : "") << Quoted(names[i]) << " " << i;
    text_ << ")\nset " << axis << "range [-0.5:" << Number(static_cast<double>(names.size()) - 0.5)
          << "]\n";
  };
  tics("x", map.x);
  tics("y", map.y);
  Range range;
  for (const double value : map.values) range.Cover(value);
  if (range.empty()) return;
  const double middle = (range.from + range.to) / 2;
  if (range.from == range.to) range = Widened(range, 0);
  text_ << "set cbrange [" << Number(range.from) << ":" << Number(range.to) << "]\nset cblabel "
        << Quoted(map.label) << " textcolor " << Rgb(internal::kInk) << "\n";
  std::string all, dark, bright;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    if (!internal::IsDrawable(map.values[i])) continue;
    const std::string line = std::to_string(i % map.x.size()) + " " +
                             std::to_string(i / map.x.size()) + " " + Number(map.values[i]) + "\n";
    all += line;
    (map.values[i] > middle ? bright : dark) += line;
  }
  plots_ += ", \\\n  " + AddBlock(map.label, all) +
            " using 1:2:(0.5):(0.5):3 with boxxyerror fs solid 1 noborder lc palette notitle";
  if (map.values.size() > kDigitsFit) return;
  const auto digits = [&](const std::string& block, const char* colour) {
    if (!block.empty())
      plots_ += ", \\\n  " + AddBlock("digits", block) +
                " using 1:2:(sprintf('%.3g', $3)) with labels font ',9' textcolor rgb '" + colour +
                "' notitle";
  };
  digits(dark, "white");
  digits(bright, "black");
}

void Script::Brackets(const Panel& panel, const std::vector<double>& at) {
  const double foot = 0.03 * (BracketAt(panel, 1) - BracketAt(panel, 0)) / 0.16;
  for (std::size_t i = 0; i < panel.brackets.size(); ++i) {
    const Bracket& bracket = panel.brackets[i];
    const double y = BracketAt(panel, i), from = at[bracket.from], to = at[bracket.to];
    const auto line = [&](double x1, double y1, double x2, double y2) {
      text_ << "set arrow from first " << Number(x1) << "," << Number(y1) << " to first "
            << Number(x2) << "," << Number(y2) << " nohead ls 100 front\n";
    };
    line(from, y - foot, from, y);
    line(from, y, to, y);
    line(to, y, to, y - foot);
    text_ << "set label " << Quoted(bracket.label) << " at first " << Number((from + to) / 2) << ","
          << Number(y) << " center offset 0,0.55 textcolor " << Rgb(internal::kInk) << " front\n";
  }
}

void Script::Bands(const Panel& panel) {
  const auto end = [](double value, const char* side) {
    return std::isfinite(value) ? "first " + Number(value) : std::string("graph ") + side;
  };
  for (const Band& band : panel.x_bands)
    Rectangle(end(band.from, "0") + ", graph 0", end(band.to, "1") + ", graph 1",
              band.forbidden ? internal::kVermillion : internal::kGrey, band.label);
  for (const Band& band : panel.y_bands)
    Rectangle("graph 0, " + end(band.from, "0"), "graph 1, " + end(band.to, "1"),
              internal::kVermillion, band.label);
}

void Script::Rectangle(const std::string& from, const std::string& to, const Colour& colour,
                       const std::string& label) {
  const std::string fill = " fs transparent solid 0.14 noborder";
  text_ << "set object rectangle from " << from << " to " << to << " fc " << Rgb(colour) << fill
        << " behind\n";
  if (!label.empty())
    plots_ += ", \\\n  keyentry with boxes lc " + Rgb(colour) + fill + " title " + Quoted(label);
}

void Script::Limits(const Panel& panel) {
  for (const LimitLine& limit : panel.limits) {
    const std::string axis = limit.side == Side::Right ? "second " : "first ";
    text_ << "set arrow from graph 0, " << axis << Number(limit.at) << " to graph 1, " << axis
          << Number(limit.at) << " nohead ls 102 front\n";
    if (!limit.label.empty())
      plots_ += ", \\\n  keyentry with lines ls 102 title " + Quoted(limit.label);
  }
  for (const LimitLine& limit : panel.x_limits) {
    text_ << "set arrow from first " << Number(limit.at) << ", graph 0 to first "
          << Number(limit.at) << ", graph 1 nohead ls 102 front\n";
    if (!limit.label.empty())
      plots_ += ", \\\n  keyentry with lines ls 102 title " + Quoted(limit.label);
  }
}

std::string Script::AddBlock(const std::string& comment, const std::string& block) {
  data_ += (data_.empty() ? "# " : "\n\n# ") + Quoted(comment) + "\n" + block;
  return "'" + figure_.name + ".dat' index " + std::to_string(blocks_++);
}

}  // namespace

void internal::CheckFigure(const Figure& figure) {
  const auto is_plain = [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-');
  };
  Require(!figure.name.empty() && std::ranges::all_of(figure.name, is_plain),
          "the name of a figure is made of letters, digits, '_' and '-'", "'" + figure.name + "'");
  const std::string where = "figure '" + figure.name + "'";
  Require(figure.columns >= 1, where + ": columns must be ≥ 1", figure.columns);
  Require(!figure.panels.empty(), where + ": it has no panel");
  for (std::size_t p = 0; p < figure.panels.size(); ++p)
    CheckPanel(where + ", panel " + std::to_string(p + 1) + ": ", figure.panels[p]);
}

std::string DrawFigure(const Figure& figure, const std::filesystem::path& directory) {
  internal::CheckFigure(figure);
  const Script script(figure);
  internal::MakeDirectory(directory);
  const std::filesystem::path svg = directory / (figure.name + ".svg");
  internal::WriteFile(directory / (figure.name + ".dat"), script.data());
  internal::WriteFile(directory / (figure.name + ".gp"), script.text());
  const std::filesystem::path pdf = directory / (figure.name + ".pdf");
  internal::RunGnuplot(directory, {figure.name + ".gp"}, std::filesystem::absolute(svg), "</svg>");
  internal::RunGnuplot(directory, {"-e", "pdf = 1", figure.name + ".gp"},
                       std::filesystem::absolute(pdf), "%%EOF");
  std::ifstream in(svg);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace pliant
