#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pliant {

/// A file or folder that comes with pliant, such as "experiments": in the folder PLIANT_SHARE (an
/// environment variable) if it is set, else beside the installed library or in the source tree.
/// Throws Error with the places looked at if it is in none of them.
std::filesystem::path SharedFile(std::string_view name);

/// A robot model that comes with pliant, such as "gen3/gen3_7dof.urdf".
inline std::filesystem::path ModelFile(std::string_view name) {
  return SharedFile("models/" + std::string(name));
}

}  // namespace pliant
