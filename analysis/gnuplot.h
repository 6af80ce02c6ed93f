#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pliant::internal {

/// Runs gnuplot, found through PATH and without anyone's start-up file, in `directory`; what it
/// prints goes to the file `svg`. Throws Error if gnuplot is not there, or with what it says when
/// it fails; an older file is left as it was.
void RunGnuplot(const std::filesystem::path& directory, const std::string& script,
                const std::filesystem::path& svg);

}  // namespace pliant::internal
