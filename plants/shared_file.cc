#include "pliant/plants/shared_file.h"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>
#include <vector>

#include "pliant/systems/error.h"

namespace pliant {

namespace fs = std::filesystem;

fs::path SharedFile(std::string_view name) {
  std::vector<fs::path> folders;
  if (const char* chosen = std::getenv("PLIANT_SHARE")) {
    folders.emplace_back(chosen);
  } else {
    Dl_info library;
    std::error_code none;
    // Without links: on Debian, where /lib is one, it is found in /lib and stands in /usr/lib.
    if (dladdr(reinterpret_cast<const void*>(&SharedFile), &library) && library.dli_fname)
      folders.push_back(fs::canonical(library.dli_fname, none).parent_path().parent_path() /
                        "share/pliant");
    folders.emplace_back(PLIANT_SOURCE);
  }
  std::string looked;
  for (const fs::path& folder : folders) {
    std::error_code none;
    if (fs::exists(folder / name, none)) return folder / name;
    looked += "\n  " + (folder / name).string();
  }
  throw Error("there is no '" + std::string(name) + "'; looked for" + looked +
              "\nset PLIANT_SHARE to the folder that has pliant's models and experiments");
}

}  // namespace pliant
