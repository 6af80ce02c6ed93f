#include "pliant/analysis/sweep_results.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <type_traits>

#include "pliant/analysis/read_number.h"
#include "pliant/analysis/sweep_part.h"

namespace pliant {

namespace {

/// The shortest text of that number; of a whole one that is exact, without an exponent.
std::string Cell(double value) {
  std::array<char, 32> text;
  char* const end = text.data() + text.size();
  const bool whole = value == std::trunc(value) && std::abs(value) <= 0x1p53;
  return {text.data(), whole ? std::to_chars(text.data(), end, value, std::chars_format::fixed).ptr
                             : std::to_chars(text.data(), end, value).ptr};
}

/// As RFC 4180 says.
std::string Cell(const std::string& word) {
  if (word.find_first_of(",\"\r\n") == std::string::npos) return word;
  std::string quoted;
  for (const char c : word) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + quoted + '"';
}

/// All of them as numbers, if they are.
std::optional<std::vector<double>> NumbersOf(const std::vector<std::string>& words) {
  std::vector<double> numbers;
  for (const std::string& word : words)
    if (const auto number = internal::ReadNumber(word))
      numbers.push_back(*number);
    else
      return std::nullopt;
  return numbers;
}

}  // namespace

std::vector<std::pair<std::uint64_t, std::uint64_t>> SweepResults::missing() const {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> gaps;
  std::uint64_t next = 0;
  for (const SweepRow& row : rows) {
    if (row.run > next) gaps.emplace_back(next, row.run - 1);
    next = row.run + 1;
  }
  if (next < sweep.runs()) gaps.emplace_back(next, sweep.runs() - 1);
  return gaps;
}

std::size_t SweepResults::failures() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows, [](const SweepRow& row) { return !row.failed.empty(); }));
}

std::vector<SweepColumn> SweepResults::columns() const {
  std::vector<SweepColumn> all;
  const auto add = [&](const std::string& name, const auto& of, const std::string& unit = "") {
    std::vector<std::decay_t<decltype(of(rows.front()))>> cells;
    for (const SweepRow& row : rows) cells.push_back(of(row));
    all.push_back({name, unit, std::move(cells)});
  };
  const auto index = [](std::uint64_t i) { return static_cast<double>(i); };

  add("run", [&](const SweepRow& row) { return index(row.run); });
  for (std::size_t i = 0, random = 0; i < sweep.over().size(); ++i) {
    const SweptValue& swept = sweep.over()[i];
    const auto numbers = NumbersOf(swept.values());
    if (swept.is_random()) {
      add(swept.path(), [&](const SweepRow& row) { return row.random[random]; });
      ++random;
    } else if (numbers) {
      add(swept.path(),
          [&](const SweepRow& row) { return (*numbers)[sweep.IndicesOf(row.run)[i]]; });
    } else {
      add(swept.path(),
          [&](const SweepRow& row) { return swept.values()[sweep.IndicesOf(row.run)[i]]; });
    }
  }
  if (!sweep.sweeps_seed())
    add("seed", [&](const SweepRow& row) { return index(sweep.SeedOf(row.run)); });
  for (std::size_t i = 0; i < sweep.numbers().size(); ++i)
    add(
        sweep.numbers()[i].name, [&](const SweepRow& row) { return row.numbers[i]; },
        sweep.units()[i]);
  add("ended", [](const SweepRow& row) { return row.ended; });
  add("failed", [](const SweepRow& row) { return row.failed; });
  return all;
}

Eigen::MatrixXd SweepResults::numbers() const {
  Eigen::MatrixXd all(rows.size(), sweep.numbers().size());
  for (Eigen::Index k = 0; k < all.rows(); ++k)
    all.row(k) =
        Eigen::RowVectorXd::Map(rows[static_cast<std::size_t>(k)].numbers.data(), all.cols());
  return all;
}

void AddRows(SweepResults& results, std::vector<std::pair<SweepRow, std::string>> rows) {
  std::ranges::stable_sort(rows, {}, [](const auto& row) { return row.first.run; });
  const std::string* from = nullptr;  // of the last one that was taken
  for (const auto& [row, where] : rows) {
    if (results.rows.empty() || results.rows.back().run != row.run) {
      results.rows.push_back(row);
      from = &where;
      continue;
    }
    if (results.rows.back() != row)
      throw Error("run " + Text(row.run) + " is not the same in " + *from + " and in " + where +
                  ": " + results.sweep.DifferenceOf(results.rows.back(), row) +
                  "\nwhat made them computes differently; take one of the parts away");
    if (results.repeated.empty() || results.repeated.back() != row.run)
      results.repeated.push_back(row.run);
  }
}

SweepResults ReadSweep(const std::vector<std::filesystem::path>& directories) {
  Require(!directories.empty(), "expected a folder with the parts of a sweep, got none");
  std::optional<SweepResults> results;
  std::vector<std::pair<SweepRow, std::string>> rows;
  std::vector<std::string> told;
  std::vector<std::filesystem::path> read;
  for (const std::filesystem::path& directory : directories) {
    std::error_code unknown;
    if (std::ranges::any_of(read, [&](const std::filesystem::path& other) {
          return std::filesystem::equivalent(directory, other, unknown);
        }))
      continue;
    read.push_back(directory);
    const std::vector<std::filesystem::path> parts = SweepPartsIn(directory);
    if (parts.empty())
      throw Error(directory.string() +
                  ": there is no part of a sweep, a file such as part-1-of-1, which `pliant sweep` "
                  "writes");
    for (const std::filesystem::path& file : parts) {
      const bool grows = IsBeingWritten(file);
      const SweepPartContent content = SweepPartContent::Read(file);
      if (grows)
        told.push_back(file.string() + ": a process writes it; taken is what it has by now");
      else
        for (const std::string& damaged : content.damaged)
          told.push_back(file.string() + ": " + damaged);
      if (content.whole == 0) continue;
      if (!results) results = {.sweep = Sweep::ReadText(content.text, file.string())};
      RequireSameSweep(results->sweep, file, content.text);
      for (const SweepRow& row : content.rows) {
        results->sweep.RequireOwn(row, file.string());
        rows.emplace_back(row, file.string());
      }
    }
  }
  if (!results)
    throw Error(directories.front().string() + ": its parts say nothing yet; was the sweep begun?");
  AddRows(*results, std::move(rows));
  results->told = std::move(told);
  return *std::move(results);
}

std::string CsvOf(const SweepResults& results) {
  const std::vector<SweepColumn> columns = results.columns();
  std::string csv;
  for (const SweepColumn& column : columns)
    csv += (csv.empty() ? "" : ",") +
           Cell(column.name + (column.unit.empty() ? "" : " (" + column.unit + ")"));
  for (std::size_t row = 0; row < results.rows.size(); ++row) {
    std::string line;
    for (const SweepColumn& column : columns)
      line += "," + std::visit([&](const auto& cells) { return Cell(cells[row]); }, column.cells);
    csv += "\n" + line.substr(1);
  }
  return csv + "\n";
}

}  // namespace pliant
