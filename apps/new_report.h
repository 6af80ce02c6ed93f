#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "pliant/analysis/figure.h"
#include "pliant/apps/commands.h"
#include "pliant/systems/error.h"

namespace pliant {

/// Before a long read, not after it: a report can be written to a folder, if there is to be one,
/// and writes over none. Throws Error, or CannotGoOn where nothing can draw its figures.
inline void RequireNewReport(const std::filesystem::path& report, bool force) {
  namespace fs = std::filesystem;
  if (report.empty()) return;
  if (std::error_code none; fs::exists(report, none) && !fs::is_directory(report, none))
    throw Error("--report wants a folder, and " + report.string() + " is none");
  for (const char* name : {"report.html", "verdict.json"})
    if (std::error_code none; !force && fs::exists(report / name, none))
      throw Error((report / name).string() +
                  " exists; give --force to write over it, or another --report");
  try {
    RequireGnuplot();
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
}

}  // namespace pliant
