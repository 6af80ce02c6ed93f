#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// The rows of a CSV file, one after the other, in memory of one row: cells with a comma, a
/// semicolon, a tab or blanks between them, which of them the first line shows. A first line with a
/// word in it names the columns; lines that begin with '#' are passed over, but for one that stands
/// first and names as many columns as follow.
class CsvRows {
 public:
  /// `delimiter` 0: found. Throws Error, with the file and the reason, as Next does.
  explicit CsvRows(const std::filesystem::path& file, char delimiter = 0);

  /// Of the columns; "1", "2", … where the file has none.
  const std::vector<std::string>& names() const { return names_; }
  bool named() const { return named_; }
  /// " (unit)" behind a name; empty where there is none.
  const std::vector<std::string>& units() const { return units_; }

  /// Reads on to the next row; false at the end of the file. A row of another length than the
  /// first is an Error, but a last one without its end of line counts as cut.
  bool Next();
  /// Of the row just read. What is empty, nan or null is NaN; a word is an Error with its place.
  double number(std::size_t column) const;
  std::int64_t line() const { return line_; }     ///< of the row just read, from 1
  bool cut() const { return cut_; }               ///< the last row was not whole
  std::uint64_t bytes() const { return bytes_; }  ///< read so far
  std::uint64_t size() const { return size_; }

 private:
  bool ReadLine();
  void Split();
  [[noreturn]] void Fail(const std::string& what) const;

  const std::filesystem::path file_;
  std::ifstream in_;
  std::vector<char> buffer_, line_buffer_;
  std::string text_;
  std::vector<std::string_view> cells_;
  std::vector<std::string> names_, units_;
  std::uint64_t bytes_ = 0, size_ = 0;
  std::int64_t line_ = 0;
  char delimiter_;
  bool named_ = false, ended_ = false, cut_ = false, pending_ = false;
};

}  // namespace pliant::internal
