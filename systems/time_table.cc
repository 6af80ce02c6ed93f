#include "pliant/systems/time_table.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>

namespace pliant {

namespace {

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Commas part fields, except within quotes.
std::vector<std::string_view> Fields(std::string_view line) {
  std::vector<std::string_view> fields;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (line[i] != ',' || quoted)) continue;
    fields.push_back(Trimmed(line.substr(begin, i - begin)));
    begin = i + 1;
  }
  return fields;
}

std::optional<double> Number(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), x);
  if (error != std::errc{} || end != field.data() + field.size()) return std::nullopt;
  return x;
}

std::string Unquoted(std::string_view field) {
  if (field.size() >= 2 && field.starts_with('"') && field.ends_with('"'))
    field = field.substr(1, field.size() - 2);
  return std::string(field);
}

}  // namespace

TimeTable ReadTimeTable(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream in(file);
  std::string line;
  int number = 1;
  const auto refuse = [&](std::size_t column, const std::string& why) {
    throw Error(file.string() + ":" + Text(number) + ":" + Text(column) + ": " + why);
  };
  if (!in) refuse(1, std::string("cannot read the file: ") + std::strerror(errno));

  TimeTable table;
  std::size_t width = 0;  // fields of a row
  for (; std::getline(in, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // UTF-8 byte order mark
    if (Trimmed(line).empty()) continue;
    const std::vector<std::string_view> fields = Fields(line);
    const bool is_first = width == 0;
    if (is_first) {
      width = fields.size();
      if (width < 2) refuse(1, "a row has a time and at least one number, got one field");
      const bool is_header = !Number(fields[0]);
      for (std::size_t i = 1; i < width; ++i)
        table.columns.push_back(is_header ? Unquoted(fields[i]) : Text(i));
      if (is_header) {
        table.time_column = Unquoted(fields[0]);
        table.header_line = number;
        continue;
      }
    }
    if (fields.size() != width)
      refuse(std::min(fields.size(), width) + 1,
             "expected " + Text(width) + " fields as in the first row, got " + Text(fields.size()));
    for (std::size_t i = 0; i < width; ++i) {
      const std::optional<double> x = Number(fields[i]);
      if (!x) refuse(i + 1, "expected a number, got '" + std::string(fields[i]) + "'");
      if (!std::isfinite(*x))
        refuse(i + 1, "expected a finite number, got '" + std::string(fields[i]) + "'");
      if (i > 0) {
        table.cells.push_back(*x);
        continue;
      }
      if (!table.times.empty() && *x <= table.times.back())
        refuse(1, "times must increase, got " + Text(*x) + " after " + Text(table.times.back()));
      table.times.push_back(*x);
    }
  }
  if (in.bad()) refuse(1, std::string("cannot read on: ") + std::strerror(errno));
  if (table.times.empty()) refuse(1, "expected a row of numbers, got the end of the file");
  return table;
}

}  // namespace pliant
