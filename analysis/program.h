#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// A program that draws, found through PATH.
struct Program {
  std::string name;
  std::string task;     ///< such as "draws the figures of a report"
  std::string package;  ///< of Debian, that has it

  struct Call {
    std::filesystem::path directory = ".";  ///< where it runs
    std::vector<std::string> arguments = {};
    std::string_view input = {};  ///< what it reads from its standard input
  };

  /// What it prints goes to the file `drawing`, which is whole if `end` stands in it. Throws Error
  /// if the program is not there, or with what it says when it fails; an older file is left as it
  /// was.
  void Draw(const Call& call, const std::filesystem::path& drawing, std::string_view end) const;

  /// Throws Error unless it runs and ends well.
  void RequireThatItRuns(const Call& call) const;
};

}  // namespace pliant::internal
