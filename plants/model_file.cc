#include "pliant/plants/model_file.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

#include "pliant/systems/error.h"

namespace pliant {

namespace fs = std::filesystem;

fs::path ModelFile(std::string_view name) {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("PLIANT_MODELS")) {
    folders.emplace_back(chosen);
  } else {
    Dl_info library;
    if (dladdr(reinterpret_cast<const void*>(&ModelFile), &library) && library.dli_fname)
      folders.push_back(fs::path(library.dli_fname).parent_path().parent_path() /
                        "share/pliant/models");
    folders.emplace_back(PLIANT_MODELS_SOURCE);
  }
  std::string looked;
  for (const fs::path& folder : folders) {
    std::error_code none;
    if (fs::is_regular_file(folder / name, none)) return folder / name;
    looked += "\n  " + (folder / name).string();
  }
  throw Error("there is no model '" + std::string(name) + "'; looked for" + looked +
              "\nset PLIANT_MODELS to the folder with pliant's models");
}

}  // namespace pliant
