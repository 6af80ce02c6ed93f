#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/report.h"

namespace pliant {

/// How far a run is: what runs, simulated time, of how much, wall time so far [s].
using Progress =
    std::function<void(const std::string& phase, double done_s, double total_s, double wall_s)>;

struct ExperimentOptions {
  bool ideal = false;  ///< torque sources and sensors without error instead of the real ones
};

/// An experiment of the papers that anyone can run by name.
struct Experiment {
  std::string name;
  std::string summary;
  std::function<Report(const ExperimentOptions&, const Progress&)> run;
};

const std::vector<Experiment>& Experiments();

/// Throws Error with the nearest name if there is none of that name.
const Experiment& FindExperiment(std::string_view name);

}  // namespace pliant
