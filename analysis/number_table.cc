#include "pliant/analysis/number_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

std::string Digits(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// How a row is shown: a number of its own unit times `factor` has `unit`.
ScaledUnit ShownIn(const NumberTable::Row& row, const RepeatedNumber& number) {
  if (row.unit) return {row.factor, *row.unit};
  double largest = 0;
  for (const RepeatedNumber::OfRun& run : number.runs())
    if (run.finite()) largest = std::max(largest, std::abs(Summarize(run.values).mean));
  const ScaledUnit own = UnitFor(largest, number.unit());
  return {1 / own.factor, own.unit};
}

std::string CellOf(const RepeatedNumber::OfRun& run, double factor, int digits) {
  if (!run.finite()) return "not finite";
  const Summary s = Summarize(run.values);
  const std::string mean = Digits(factor * s.mean, digits);
  return s.n == 1 ? mean : mean + " ± " + Digits(factor * s.standard_deviation, 2);
}

}  // namespace

void NumberTable::RequireFit(const Scenario& scenario) const {
  Require(!title.empty(), "title is missing");
  Require(!rows.empty(), "it shows no number");
  for (const Row& row : rows) {
    const std::string where = "row '" + row.title + "': ";
    Require(row.paper.empty() || row.paper.size() == runs.size(),
            where + "paper has what the paper says of each of the " + Text(runs.size()) + " runs",
            row.paper.size());
    Require(row.factor == 1 || row.unit,
            where + "unit is missing: what a number has that is multiplied by " + Text(row.factor));
    row.number.RequireFit(scenario);
  }
}

void NumberTable::RequireSound(const Recording& recorded) const {
  for (const Row& row : rows) row.number.RequireSound(recorded[row.number.signal]);
}

std::vector<RepeatedNumber> NumberTable::Wanted() const {
  std::vector<RepeatedNumber> all;
  for (const Row& row : rows) all.emplace_back(row.number, runs);
  return all;
}

Table NumberTable::Show(const std::vector<RepeatedNumber>& measured) const {
  Table table{.title = title, .columns = {""}, .rows = {}, .caption = caption};
  for (const RepeatedNumber::OfRun& run : measured.front().runs())
    table.columns.push_back(run.title);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const ScaledUnit in = ShownIn(row, measured[i]);
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(row.title + (in.unit.empty() ? "" : " [" + in.unit + "]"));
    for (std::size_t k = 0; k < runs.size(); ++k) {
      cells.push_back(CellOf(measured[i].runs()[k], in.factor, row.digits));
      if (!row.paper.empty() && !row.paper[k].empty()) cells.back() += " (" + row.paper[k] + ")";
    }
  }
  return table;
}

}  // namespace pliant
