#include "pliant/analysis/csv_rows.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "pliant/analysis/printable.h"
#include "pliant/systems/error.h"

namespace pliant::internal {

namespace {

constexpr std::size_t kBuffer = 1 << 20;
constexpr std::size_t kMostInLine = 1 << 20;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string_view Trimmed(std::string_view word) {
  const std::size_t from = word.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return word.substr(from, word.find_last_not_of(" \t\r") - from + 1);
}

std::string_view Unquoted(std::string_view word) {
  if (word.size() >= 2 && word.front() == '"' && word.back() == '"')
    return word.substr(1, word.size() - 2);
  return word;
}

bool SameLetters(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](char x, char y) { return std::tolower(static_cast<unsigned char>(x)) == y; });
}

/// Nothing if the word is no number.
std::optional<double> NumberOf(std::string_view word) {
  word = Unquoted(Trimmed(word));
  if (word.starts_with('+')) word.remove_prefix(1);
  double number;
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, number);
  if (rest == end && error == std::errc()) return number;
  if (rest == end && error == std::errc::result_out_of_range) return kNaN;
  for (const std::string_view none : {"", "null", "na", "n/a"})
    if (SameLetters(word, none)) return kNaN;
  return std::nullopt;
}

char DelimiterOf(std::string_view line) {
  for (const char c : {'\t', ';', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

/// Appends the cells of a line; quotes keep a delimiter together.
void SplitInto(std::vector<std::string_view>& cells, std::string_view line, char delimiter) {
  cells.clear();
  if (delimiter == ' ') {
    for (std::size_t at = line.find_first_not_of(' '); at != std::string_view::npos;) {
      const std::size_t end = std::min(line.find(' ', at), line.size());
      cells.push_back(line.substr(at, end - at));
      at = line.find_first_not_of(' ', end);
    }
    return;
  }
  const bool quotes = line.find('"') != std::string_view::npos;
  for (std::size_t begin = 0;;) {
    std::size_t end = begin;
    if (quotes) {
      for (bool inside = false; end < line.size() && (inside || line[end] != delimiter); ++end)
        inside ^= line[end] == '"';
    } else {
      end = std::min(line.find(delimiter, begin), line.size());
    }
    cells.push_back(line.substr(begin, end - begin));
    if (end == line.size()) return;
    begin = end + 1;
  }
}

bool IsWord(std::string_view cell) { return !NumberOf(cell); }

}  // namespace

CsvRows::CsvRows(const std::filesystem::path& file, char delimiter)
    : file_{file}, buffer_(kBuffer), line_buffer_(kMostInLine), delimiter_{delimiter} {
  in_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw Error(file.string() + " is a directory");
  in_.open(file, std::ios::binary);
  if (!in_) throw Error("cannot read " + file.string() + ": " + std::strerror(errno));
  size_ = std::filesystem::file_size(file, error);
  if (error) size_ = 0;

  if (!ReadLine()) throw Error(file.string() + " is empty");
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  const bool remark = text_.starts_with('#');
  if (remark) text_.erase(0, text_.find_first_not_of("# \t"));
  if (!delimiter_) delimiter_ = DelimiterOf(Trimmed(text_));
  Split();
  named_ = std::ranges::any_of(cells_, IsWord);

  std::vector<std::string> first(cells_.begin(), cells_.end());
  if (remark) {
    // A remark unless it names as many columns as follow.
    const bool follows = ReadLine();
    if (follows) {
      const char between = delimiter ? delimiter : DelimiterOf(Trimmed(text_));
      std::vector<std::string_view> below;
      SplitInto(below, between == ' ' ? Trimmed(text_) : text_, between);
      if (below.size() != first.size()) {
        delimiter_ = between;
        named_ = false;
      }
    }
    if (follows && !named_) {
      Split();
      named_ = std::ranges::any_of(cells_, IsWord);
      first.assign(cells_.begin(), cells_.end());
      pending_ = !named_;
    } else {
      pending_ = follows;
    }
  } else {
    pending_ = !named_;
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    std::string name(Unquoted(Trimmed(first[i])));
    for (std::size_t at = 0; (at = name.find("\"\"", at)) != std::string::npos; ++at)
      name.erase(at, 1);
    units_.emplace_back();
    if (!named_) {
      names_.push_back(Text(i + 1));
      continue;
    }
    const std::size_t unit = name.rfind(" (");
    if (unit != std::string::npos && name.ends_with(')')) {
      units_.back() = name.substr(unit + 2, name.size() - unit - 3);
      name.erase(unit);
    }
    names_.push_back(std::move(name));
  }
}

bool CsvRows::ReadLine() {
  do {
    in_.getline(line_buffer_.data(), static_cast<std::streamsize>(line_buffer_.size()));
    const auto count = static_cast<std::size_t>(in_.gcount());
    if (in_.bad()) throw Error("cannot read " + file_.string() + ": " + std::strerror(errno));
    if (in_.fail() && in_.eof()) return false;
    ++line_;
    if (in_.fail())
      Fail("the line has more than " + Text(kMostInLine - 1) + " bytes; is it a CSV file?");
    bytes_ += count;
    ended_ = in_.eof();
    text_.assign(line_buffer_.data(), ended_ ? count : count - 1);
    if (text_.find('\0') != std::string::npos) Fail("there is a zero byte; is it a CSV file?");
  } while (Trimmed(text_).empty() || (line_ > 1 && text_.starts_with('#')));
  return true;
}

void CsvRows::Split() {
  SplitInto(cells_, delimiter_ == ' ' ? Trimmed(text_) : std::string_view(text_), delimiter_);
}

bool CsvRows::Next() {
  if (!pending_ && !ReadLine()) return false;
  pending_ = false;
  Split();
  if (cells_.size() == names_.size()) return true;
  if (ended_) {
    cut_ = true;
    return false;
  }
  Fail("expected " + Text(names_.size()) + " cells as in the first line, got " +
       Text(cells_.size()));
}

double CsvRows::number(std::size_t column) const {
  const std::optional<double> number = NumberOf(cells_[column]);
  if (!number)
    Fail("expected a number in column '" + Printable(names_[column]) + "', got '" +
         Printable(Trimmed(cells_[column]).substr(0, 40)) + "'");
  return *number;
}

void CsvRows::Fail(const std::string& what) const {
  throw Error(file_.string() + ":" + Text(line_) + ": " + what);
}

}  // namespace pliant::internal
