#pragma once

#include <vector>

#include "pliant/analysis/report.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// What was run, in words: what all runs of a repetition have in common, and where they differ.
std::vector<Setting> RunSettings(const Runs& runs);

}  // namespace pliant
