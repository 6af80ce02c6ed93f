#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/figure.h"

namespace pliant {

/// What a paper claims, held against what was measured.
struct Claim {
  std::string id;         ///< unique in its report, such as "no-motion"
  std::string source;     ///< the paper and the place in it
  std::string paper;      ///< what it says
  std::string measured;   ///< with its unit, see WithUnit
  std::string criterion;  ///< when the claim is taken to hold, stated before the run
  std::string basis;      ///< where the criterion comes from; what no paper gives says so
  bool holds;

  bool operator==(const Claim&) const = default;
};

/// A row of "what was run".
struct Setting {
  std::string name, value;
};

struct Table {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< a cell for each column
  std::string caption = {};
};

/// The values something took, and the bounds it has; a bound that is not there is infinite.
struct Extent {
  std::string name;
  double least, greatest;
  double lower, upper;
};

/// A row for each of `extents`: least and greatest value, bounds, and how much of the room between
/// the bounds was used, from their middle: 100 % at a bound. `unit` stands with the columns.
Table ExtentsTable(const std::string& title, const std::string& unit,
                   const std::vector<Extent>& extents);

struct Timing {
  double simulated_s;
  double wall_s;
  std::int64_t ticks;
  std::int64_t integrator_steps;
  std::int64_t derivative_calls;
};

/// What is left of an experiment: what was run, what came out, and whether the claims hold.
struct Report {
  std::string title;
  std::string summary;  ///< one paragraph
  std::vector<Setting> settings = {};
  std::vector<Claim> claims = {};
  std::vector<Table> results = {};  ///< what was asked for beside the claims
  std::vector<Figure> figures = {};
  std::vector<Table> tables = {};
  std::optional<Timing> timing = {};
};

class Runs;

/// Writes
///
///   verdict.json               {"claims": [{"id", "source", "paper", "measured", "criterion",
///                              "basis", "holds"}], "tables": the results, [{"title",
///                              "columns", "rows", "caption"}]}
///   figures/NAME.svg .pdf …    see DrawFigure
///   report.html                all of it in one page that asks for no other file, with the runs of
///                              one repetition, to zoom into and to replay
///
/// Each file is moved into place when it is whole. Throws Error, with the file and the reason, or
/// with what is wrong in the report before anything is written.
void WriteReport(const Report& report, const Runs& runs, const std::filesystem::path& directory);
void WriteReport(const Report& report, const std::filesystem::path& directory);

}  // namespace pliant
