#pragma once

#include <filesystem>

#include "pliant/apps/doctor_checks.h"

namespace pliant {

/// Asks the machine; what it tries, it undoes. Takes half a second, for `median_s` and `worst_s`.
RealTimeFacts RealTimeOfThisMachine();

/// Tries to write a file there, or in the nearest folder above that is there: a run makes the rest.
OutputFolder OutputAt(const std::filesystem::path& folder);

}  // namespace pliant
