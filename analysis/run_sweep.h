#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "pliant/analysis/shard.h"
#include "pliant/analysis/sweep_results.h"

namespace pliant {

/// How far a sweep is: runs made, of how many, of which so many failed; wall time so far [s]. Calls
/// do not overlap.
using SweepProgress =
    std::function<void(std::uint64_t made, std::uint64_t of, std::uint64_t failed, double wall_s)>;

struct SweepOptions {
  std::filesystem::path out = {};  ///< for parts; made if it is not there. Empty: nothing is kept
  int jobs = 1;                    ///< runs at a time
  Shard shard = {};
  SweepProgress progress = {};
  const std::atomic<bool>* stop = nullptr;           ///< true ends it; runs that are made are kept
  std::function<void(const std::string&)> say = {};  ///< what was wrong with parts that are there
};

/// Makes the runs of a sweep that no part in `out` has yet, each into the part of this shard.
/// Returns what there is then. Throws Error if a part is of another sweep or if another process
/// writes the shard's, FailedRun if a row cannot be written.
SweepResults RunSweep(const Sweep& sweep, const SweepOptions& o = {});

}  // namespace pliant
