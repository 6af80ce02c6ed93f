#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/systems/error.h"

namespace pliant {

/// Rows of numbers at increasing times.
struct TimeTable {
  std::vector<std::string> columns;  ///< names, the time left out
  std::vector<double> times;         ///< [s]
  std::vector<double> cells;         ///< row by row, the time left out
  std::string time_column = {};      ///< the name of the first column; empty: there are no names
  int header_line = 0;               ///< where the names stand, from 1; 0: there are none

  bool operator==(const TimeTable&) const = default;
};

/// Reads comma-separated values with the time [s] in the first column. A first row that does not
/// begin with a number holds the names of the columns; without, they are "1", "2", …  Empty lines
/// are passed over. Names may be quoted. Throws Error "file:line:column: …" for what is no number,
/// not finite, missing or not later than the row before; line and column are counted from 1,
/// columns in fields.
TimeTable ReadTimeTable(const std::filesystem::path& file);

}  // namespace pliant
