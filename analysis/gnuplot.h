#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// Runs gnuplot, found through PATH and without anyone's start-up file, in `directory`; what it
/// prints goes to the file `drawing`, which is whole if `end` stands in it. Throws Error if gnuplot
/// is not there, or with what it says when it fails; an older file is left as it was.
void RunGnuplot(const std::filesystem::path& directory, const std::vector<std::string>& arguments,
                const std::filesystem::path& drawing, std::string_view end);

}  // namespace pliant::internal
