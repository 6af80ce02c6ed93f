#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/analysis/report.h"
#include "pliant/analysis/sweep.h"

namespace pliant {

/// A column of the results: of each row a number or a text.
struct SweepColumn {
  std::string name, unit;
  std::variant<std::vector<double>, std::vector<std::string>> cells;
};

/// The rows of a sweep.
struct SweepResults {
  Sweep sweep;
  std::vector<SweepRow> rows = {};  ///< by run
  /// Runs that are there more than once, the same each time.
  std::vector<std::uint64_t> repeated = {};
  std::vector<std::string> told = {};  ///< what was wrong with parts, a line each

  /// Runs that no part has: first and last of each stretch.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> missing() const;
  bool whole() const { return rows.size() == sweep.runs(); }
  std::size_t failures() const;

  /// run, the swept values by their paths, seed unless it is swept, the numbers, ended, failed.
  /// Swept values are texts, as YAML, if one of them is no number; numbers are written in their
  /// shortest form.
  std::vector<SweepColumn> columns() const;
  Eigen::MatrixXd numbers() const;  ///< a row for each run, a column for each number
};

/// Sorts rows by run; puts those that are there twice into `repeated`. Throws Error if they differ.
/// `from` names where each came from.
void AddRows(SweepResults& results, std::vector<std::pair<SweepRow, std::string>> rows);

/// All parts in these directories. Throws Error if there are none, or if they are of different
/// sweeps, or have different rows of one run.
SweepResults ReadSweep(const std::vector<std::filesystem::path>& directories);

/// Writes
///
///   results.csv   a row for each run: its index, its values, its seed, its numbers, why it ended
///                 or failed. The same bytes, however the rows were made
///   results.h5    the same, a dataset for each column
///
/// Throws Error if one cannot be written; an older one then stays as it was.
void WriteSweepTables(const SweepResults& results, const std::filesystem::path& directory);

/// Maps of the numbers over the first two lists, how they are distributed, and what failed.
Report ReportOf(const SweepResults& results);

std::string CsvOf(const SweepResults& results);

}  // namespace pliant
