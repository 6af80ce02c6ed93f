#include "pliant/analysis/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "pliant/analysis/figure_data.h"
#include "pliant/analysis/report_page.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

/// Four digits: a table's cells are compared with each other.
std::string Cell(double value) {
  if (std::isinf(value)) return "–";
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string Used(const Extent& e) {
  const double middle = (e.lower + e.upper) / 2;
  const double used = std::max(e.greatest - middle, middle - e.least) / ((e.upper - e.lower) / 2);
  if (!std::isfinite(used)) return "–";
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), used > 1 ? "%.1f %% ✗" : "%.1f %%", 100 * used);
  return text.data();
}

void CheckClaims(const std::vector<Claim>& claims) {
  std::set<std::string> ids;
  for (const Claim& claim : claims) {
    Require(!claim.id.empty(), "a claim has an id, this one does not: " + claim.paper);
    const std::string where = "claim '" + claim.id + "'";
    Require(ids.insert(claim.id).second, where + ": the report has it twice");
    const std::array<std::pair<const char*, const std::string*>, 5> fields{
        {{"source", &claim.source},
         {"paper", &claim.paper},
         {"measured", &claim.measured},
         {"criterion", &claim.criterion},
         {"basis", &claim.basis}}};
    for (const auto& [name, text] : fields)
      Require(!text->empty(), where + ": it says nothing under '" + name + "'");
  }
}

void CheckTable(const Table& table) {
  const std::string where = "table '" + table.title + "'";
  Require(!table.columns.empty(), where + ": it has no columns");
  for (const auto& row : table.rows)
    Require(row.size() == table.columns.size(),
            where + ": a row has " + Text(table.columns.size()) + " cells", row.size());
}

void CheckTiming(const Timing& t) {
  Require(t.simulated_s >= 0 && t.wall_s > 0, "timing: simulated_s must be ≥ 0 and wall_s > 0",
          Text(t.simulated_s) + " and " + Text(t.wall_s));
  for (const std::int64_t count : {t.ticks, t.integrator_steps, t.derivative_calls})
    Require(count >= 0, "timing: a count must be ≥ 0", count);
}

void Check(const Report& report) {
  Require(!report.title.empty(), "a report has a title");
  CheckClaims(report.claims);
  for (const auto* tables : {&report.results, &report.tables})
    for (const Table& table : *tables) CheckTable(table);
  std::set<std::string> names;
  for (const Figure& figure : report.figures) {
    internal::CheckFigure(figure);
    Require(names.insert(figure.name).second,
            "figure '" + figure.name + "': the report has it twice");
  }
  if (report.timing) CheckTiming(*report.timing);
}

std::string Verdict(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  for (const Claim& claim : report.claims)
    list.push_back({{"id", claim.id},
                    {"source", claim.source},
                    {"paper", claim.paper},
                    {"measured", claim.measured},
                    {"criterion", claim.criterion},
                    {"basis", claim.basis},
                    {"holds", claim.holds}});
  Json tables = Json::array();
  for (const Table& table : report.results)
    tables.push_back({{"title", table.title},
                      {"columns", table.columns},
                      {"rows", table.rows},
                      {"caption", table.caption}});
  const Json verdict = {{"claims", std::move(list)}, {"tables", std::move(tables)}};
  return verdict.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Table ExtentsTable(const std::string& title, const std::string& unit,
                   const std::vector<Extent>& extents) {
  const std::string in = unit.empty() ? "" : " [" + unit + "]";
  Table table{title, {"", "least" + in, "greatest" + in, "lower" + in, "upper" + in, "used"}, {}};
  for (const Extent& e : extents) {
    Require(e.lower < e.upper,
            "table '" + title + "', " + e.name + ": the lower bound is below the upper one",
            Text(e.lower) + " and " + Text(e.upper));
    table.rows.push_back(
        {e.name, Cell(e.least), Cell(e.greatest), Cell(e.lower), Cell(e.upper), Used(e)});
  }
  return table;
}

void WriteReport(const Report& report, const std::filesystem::path& directory) {
  WriteReport(report, Runs(), directory);
}

void WriteReport(const Report& report, const Runs& runs, const std::filesystem::path& directory) {
  Check(report);
  internal::MakeDirectory(directory);
  // What can fail for other reasons than a full disk comes first.
  std::vector<std::string> drawings;
  for (const Figure& figure : report.figures)
    drawings.push_back(DrawFigure(figure, directory / "figures"));
  internal::WriteFile(directory / "report.html", internal::ReportPage(report, drawings, runs));
  internal::WriteFile(directory / "verdict.json", Verdict(report));
}

}  // namespace pliant
