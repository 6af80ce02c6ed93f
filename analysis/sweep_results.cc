#include "pliant/analysis/sweep_results.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "pliant/analysis/sweep_part.h"

namespace pliant {

namespace {

std::string Shortest(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// As RFC 4180 says.
std::string Quoted(const std::string& word) {
  if (word.find_first_of(",\"\r\n") == std::string::npos) return word;
  std::string quoted;
  for (const char c : word) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return '"' + quoted + '"';
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

std::vector<std::string> SweepResults::names() const {
  std::vector<std::string> all;
  for (const NamedNumber& number : sweep.numbers()) all.push_back(number.name);
  return all;
}

Eigen::MatrixXd SweepResults::numbers() const {
  Eigen::MatrixXd all(rows.size(), sweep.numbers().size());
  for (Eigen::Index k = 0; k < all.rows(); ++k)
    all.row(k) =
        Eigen::RowVectorXd::Map(rows[static_cast<std::size_t>(k)].numbers.data(), all.cols());
  return all;
}

std::vector<std::string> SweepResults::causes() const {
  std::vector<std::string> all;
  for (const SweepRow& row : rows) all.push_back(row.failed);
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
                  "\nthe machines that made them compute differently; take the part of one away");
    if (results.repeated.empty() || results.repeated.back() != row.run)
      results.repeated.push_back(row.run);
  }
}

SweepResults ReadSweep(const std::vector<std::filesystem::path>& directories) {
  Require(!directories.empty(), "expected a folder with the parts of a sweep, got none");
  std::optional<SweepResults> results;
  std::vector<std::pair<SweepRow, std::string>> rows;
  std::vector<std::string> told;
  for (const std::filesystem::path& directory : directories) {
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
  const Sweep& sweep = results.sweep;
  std::string csv = "run";
  for (const Swept& swept : sweep.over()) csv += "," + Quoted(swept.path());
  const bool sweeps_seed =
      std::ranges::any_of(sweep.over(), [](const Swept& s) { return s.path() == "seed"; });
  if (!sweeps_seed) csv += ",seed";
  for (std::size_t i = 0; i < sweep.numbers().size(); ++i)
    csv += "," + Quoted(sweep.numbers()[i].name +
                        (sweep.units()[i].empty() ? "" : " (" + sweep.units()[i] + ")"));
  csv += ",ended,failed\n";
  for (const SweepRow& row : results.rows) {
    csv += std::to_string(row.run);
    const std::vector<std::size_t> indices = sweep.IndicesOf(row.run);
    std::size_t random = 0;
    for (std::size_t i = 0; i < sweep.over().size(); ++i) {
      const Swept& swept = sweep.over()[i];
      csv += "," + (swept.is_random() ? Shortest(row.drawn[random++])
                                      : Quoted(swept.values()[indices[i]]));
    }
    if (!sweeps_seed) csv += "," + std::to_string(sweep.SeedOf(row.run));
    for (const double number : row.numbers) csv += "," + Shortest(number);
    csv += "," + Quoted(row.ended) + "," + Quoted(row.failed) + "\n";
  }
  return csv;
}

}  // namespace pliant
