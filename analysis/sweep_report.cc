#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <optional>
#include <ranges>

#include "pliant/analysis/printable.h"
#include "pliant/analysis/read_number.h"
#include "pliant/analysis/sample.h"
#include "pliant/analysis/summary.h"
#include "pliant/analysis/sweep_results.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr std::size_t kMostCells = 2500;  // of a map
constexpr std::size_t kMostCauses = 50;

std::string Digits(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

/// One number of all runs: those that have it, in order of size.
struct Measured {
  const NamedNumber* number;
  ScaledUnit unit;
  std::vector<std::pair<double, std::uint64_t>> sorted;  ///< value, run

  std::string label() const { return unit.unit.empty() ? "" : " [" + unit.unit + "]"; }
  /// The value that a share of the runs does not pass.
  double Quantile(double share) const {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1].first;
  }
};

Measured MeasuredOf(const SweepResults& results, std::size_t i) {
  Measured measured{.number = &results.sweep.numbers()[i], .unit = {}, .sorted = {}};
  double largest = 0;
  for (const SweepRow& row : results.rows) {
    if (std::isnan(row.numbers[i])) continue;
    measured.sorted.emplace_back(row.numbers[i], row.run);
    if (std::isfinite(row.numbers[i])) largest = std::max(largest, std::abs(row.numbers[i]));
  }
  std::ranges::sort(measured.sorted);
  measured.unit = UnitFor(largest, results.sweep.units()[i]);
  for (auto& [value, run] : measured.sorted) value /= measured.unit.factor;
  return measured;
}

double MeanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Table NumbersTable(const std::vector<Measured>& all) {
  Table table{.title = "Numbers",
              .columns = {"", "runs", "mean", "standard deviation", "least", "in run", "median",
                          "95 % are below", "greatest", "in run"},
              .rows = {},
              .caption =
                  "Of the runs that have the number; no mean if one is beyond ±1e75. `pliant "
                  "rerun` makes a run again, with a log."};
  for (const Measured& m : all) {
    std::vector<std::string>& cells =
        table.rows.emplace_back(std::vector<std::string>{m.number->title + m.label()});
    cells.push_back(Text(m.sorted.size()));
    cells.resize(table.columns.size(), "–");
    if (m.sorted.empty()) continue;
    if (std::max(-m.sorted.front().first, m.sorted.back().first) <= internal::kLargestOfSample) {
      const auto values = std::views::keys(m.sorted);
      const Summary summary = Summarize({values.begin(), values.end()});
      cells[2] = Digits(summary.mean);
      cells[3] = Digits(summary.standard_deviation);
    }
    cells[4] = Digits(m.sorted.front().first);
    cells[5] = Text(m.sorted.front().second);
    cells[6] = Digits(m.Quantile(0.5));
    cells[7] = Digits(m.Quantile(0.95));
    cells[8] = Digits(m.sorted.back().first);
    cells[9] = Text(m.sorted.back().second);
  }
  return table;
}

/// With "…" in the place of its numbers, which differ from run to run.
std::string KindOf(const std::string& cause) {
  std::string kind;
  bool in_number = false;
  for (std::size_t i = 0; i < cause.size(); ++i) {
    const auto is_digit = [&](std::size_t k) {
      return k < cause.size() && std::isdigit(static_cast<unsigned char>(cause[k]));
    };
    const auto is_letter = [&](char c) {
      return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
    };
    const bool begins = is_digit(i) && (i == 0 || !is_letter(cause[i - 1]));
    const bool goes_on =
        in_number && (is_digit(i) ||
                      ((cause[i] == '.' || cause[i] == '-' || cause[i] == '+' || cause[i] == 'e') &&
                       (is_digit(i + 1) || is_digit(i + 2))));
    if (begins && !in_number) kind += "…";
    in_number = begins || goes_on;
    if (!in_number) kind += cause[i];
  }
  return kind;
}

/// How many runs have a text of each kind, most of them first.
Table TableOf(const std::string& title, const SweepResults& results, std::string SweepRow::*text) {
  struct Kind {
    std::size_t runs = 0;
    std::uint64_t first = 0;
    std::string example = {};
  };
  std::map<std::string, Kind> kinds;
  for (const SweepRow& row : results.rows) {
    if ((row.*text).empty()) continue;
    Kind& kind = kinds[KindOf(row.*text)];
    if (kind.runs++ == 0) kind = {1, row.run, row.*text};
  }
  std::vector<Kind> sorted;
  for (const auto& [name, kind] : kinds) sorted.push_back(kind);
  std::ranges::stable_sort(sorted, std::greater(), &Kind::runs);
  Table table{.title = title, .columns = {"the first says", "in run", "runs"}, .rows = {}};
  for (const Kind& kind : sorted) {
    if (table.rows.size() == kMostCauses) {
      table.caption = Text(sorted.size() - kMostCauses) + " more kinds are in results.csv.";
      break;
    }
    table.rows.push_back({kind.example, Text(kind.first), Text(kind.runs)});
  }
  return table;
}

/// The swept lists of more than one value.
std::vector<std::size_t> Varying(const Sweep& sweep) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < sweep.over().size(); ++i)
    if (sweep.over()[i].values().size() > 1) all.push_back(i);
  return all;
}

/// The values of a number at each value of one list, or of two: the first running fastest.
std::vector<std::vector<double>> ByCell(const SweepResults& results, std::size_t number,
                                        const std::vector<std::size_t>& lists, double factor) {
  const Sweep& sweep = results.sweep;
  std::size_t cells = 1;
  for (const std::size_t list : lists) cells *= sweep.over()[list].values().size();
  std::vector<std::vector<double>> by_cell(cells);
  for (const SweepRow& row : results.rows) {
    if (std::isnan(row.numbers[number])) continue;
    const std::vector<std::size_t> indices = sweep.IndicesOf(row.run);
    std::size_t cell = 0;
    for (std::size_t i = lists.size(); i-- > 0;)
      cell = cell * sweep.over()[lists[i]].values().size() + indices[lists[i]];
    by_cell[cell].push_back(row.numbers[number] / factor);
  }
  return by_cell;
}

/// A number for all runs of a cell.
struct Aggregate {
  const char* name;
  double (*of)(const std::vector<double>&);
};
constexpr std::array<Aggregate, 3> kAggregates{
    {{"mean", MeanOf},
     {"least", [](const std::vector<double>& v) { return *std::ranges::min_element(v); }},
     {"greatest", [](const std::vector<double>& v) { return *std::ranges::max_element(v); }}}};

std::vector<double> Each(const std::vector<std::vector<double>>& cells,
                         const Aggregate& aggregate) {
  std::vector<double> all;
  for (const std::vector<double>& cell : cells)
    all.push_back(cell.empty() ? std::nan("") : aggregate.of(cell));
  return all;
}

/// The values of a list, as an axis has room for them.
std::vector<std::string> ShortOf(const SweptValue& swept) {
  std::vector<std::string> names;
  for (const std::string& value : swept.values()) {
    const std::optional<double> number = internal::ReadNumber(value);
    names.push_back(number ? Digits(*number) : FirstBytes(value, 12));
  }
  return names;
}

Figure MapOf(const SweepResults& results, std::size_t number, const Measured& measured,
             const std::vector<std::size_t>& lists) {
  const SweptValue &x = results.sweep.over()[lists[0]], &y = results.sweep.over()[lists[1]];
  const auto cells = ByCell(results, number, {lists[0], lists[1]}, measured.unit.factor);
  const NamedNumber& of = *measured.number;
  Figure figure{.name = "map_" + of.name,
                .caption = of.title + measured.label() + " over " + x.path() + " and " + y.path() +
                           ": of the runs in each cell the mean, and the " +
                           (of.number.statistic == Statistic::Least ? "least" : "greatest") + ".",
                .columns = 1};
  for (const Aggregate& aggregate :
       {kAggregates[0], kAggregates[of.number.statistic == Statistic::Least ? 1 : 2]}) {
    Panel& panel = figure.panels.emplace_back();
    panel.title = aggregate.name + measured.label();
    panel.x.label = x.path();
    panel.left.label = y.path();
    panel.map = HeatMap{.x = ShortOf(x), .y = ShortOf(y), .values = Each(cells, aggregate)};
  }
  return figure;
}

/// The numbers of a list, or its indices if it has words.
std::vector<double> PlacesOf(const SweptValue& swept) {
  std::vector<double> places;
  for (const std::string& value : swept.values())
    places.push_back(internal::ReadNumber(value).value_or(std::nan("")));
  if (std::ranges::any_of(places, [](double x) { return std::isnan(x); }))
    std::iota(places.begin(), places.end(), 0.0);
  return places;
}

Figure CurveOf(const SweepResults& results, std::size_t number, const Measured& measured,
               std::size_t list) {
  const SweptValue& swept = results.sweep.over()[list];
  const auto cells = ByCell(results, number, {list}, measured.unit.factor);
  Figure figure{.name = "over_" + measured.number->name,
                .caption = measured.number->title + " over " + swept.path() +
                           ", of the runs at each of its values."};
  Panel& panel = figure.panels.emplace_back();
  panel.x.label = swept.path();
  panel.left.label = measured.number->title + measured.label();
  for (const Aggregate& aggregate : kAggregates)
    panel.curves.push_back(
        {.label = aggregate.name, .x = PlacesOf(swept), .y = Each(cells, aggregate)});
  return figure;
}

Figure DistributionOf(const std::vector<Measured>& all) {
  Figure figure{.name = "distributions",
                .caption = "Which share of the runs has at most so much.",
                .columns = static_cast<int>(std::min<std::size_t>(all.size(), 2))};
  for (const Measured& m : all) {
    Panel& panel = figure.panels.emplace_back();
    panel.x.label = m.number->title + m.label();
    panel.left = {.label = "share of runs", .from = 0, .to = 1};
    Curve& curve = panel.curves.emplace_back();
    curve.draw = Curve::Draw::Steps;
    for (std::size_t k = 0; k < m.sorted.size(); ++k) {
      curve.x.push_back(m.sorted[k].first);
      curve.y.push_back(static_cast<double>(k + 1) / static_cast<double>(m.sorted.size()));
    }
  }
  return figure;
}

}  // namespace

Report ReportOf(const SweepResults& results) {
  const Sweep& sweep = results.sweep;
  Report report{.title = sweep.experiment().title + ": " + Text(sweep.runs()) + " runs",
                .summary = sweep.experiment().summary};
  report.settings.push_back({"runs", Text(results.rows.size()) + " of " + Text(sweep.runs()) +
                                         ", in " + Text(sweep.cells()) + " cells"});
  for (const SweptValue& swept : sweep.over())
    report.settings.push_back(
        {swept.path(), FirstBytes(swept.text().substr(swept.path().size() + 1), 200)});
  report.settings.push_back({"failed", Text(results.failures())});

  std::vector<Measured> all;
  for (std::size_t i = 0; i < sweep.numbers().size(); ++i) all.push_back(MeasuredOf(results, i));
  report.results.push_back(NumbersTable(all));
  for (const auto& [title, text] :
       {std::pair("Why runs failed", &SweepRow::failed),
        std::pair("Why runs ended before their time", &SweepRow::ended)})
    if (Table table = TableOf(title, results, text); !table.rows.empty())
      report.results.push_back(std::move(table));

  const std::vector<std::size_t> lists = Varying(sweep);
  const bool mapped =
      lists.size() >= 2 &&
      sweep.over()[lists[0]].values().size() * sweep.over()[lists[1]].values().size() <= kMostCells;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (mapped)
      report.figures.push_back(MapOf(results, i, all[i], lists));
    else
      for (const std::size_t list : lists)
        report.figures.push_back(CurveOf(results, i, all[i], list));
  }
  report.figures.push_back(DistributionOf(all));
  return report;
}

}  // namespace pliant
