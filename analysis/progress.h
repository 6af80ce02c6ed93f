#pragma once

#include <functional>
#include <string>

namespace pliant {

/// How far a run is: what runs, simulated time, of how much, wall time so far [s]. Calls do not
/// overlap.
using Progress =
    std::function<void(const std::string& phase, double done_s, double total_s, double wall_s)>;

}  // namespace pliant
