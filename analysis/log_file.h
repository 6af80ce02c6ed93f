#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace pliant::internal {

/// A file that grows and can be read at any time under its own name.
///
/// One that is there already is refused. With `force` the new file begins beside it, as
/// "<file>.part", and Begun moves it over the old one: that stays if the new one cannot even begin,
/// and there is never a moment without a file. What is no regular file, such as a pipe, is written
/// to as it is.
class LogFile {
 public:
  /// Throws Error, with the file and the reason, as all functions here do.
  LogFile(const std::filesystem::path& file, bool force);
  ~LogFile();  ///< removes a file that has not begun
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// The first bytes are written: from now on the file stays.
  void Begun();

  /// All of it or, of a regular file, nothing; if a part of it stays, the error says so.
  void Write(std::string_view bytes);
  void Close();

  const std::filesystem::path& path() const { return path_; }
  std::int64_t size() const { return size_; }  ///< bytes written

 private:
  [[noreturn]] void Throw(int reason, const std::string& besides = "") const;

  const std::filesystem::path path_;
  std::filesystem::path begins_as_;  // until it has begun
  int descriptor_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace pliant::internal
