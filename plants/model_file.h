#pragma once

#include <filesystem>
#include <string_view>

namespace pliant {

/// A model that comes with pliant, such as "gen3/gen3_7dof.urdf": in the folder PLIANT_MODELS (an
/// environment variable) if it is set, else beside the installed library or in the source tree.
/// Throws Error with the places looked at if it is in none of them.
std::filesystem::path ModelFile(std::string_view name);

}  // namespace pliant
