#pragma once

#include <atomic>
#include <filesystem>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/progress.h"
#include "pliant/analysis/report.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// A run could not go on: its integrator failed, or its log could not be written.
class FailedRun : public Error {
 public:
  using Error::Error;
};

struct RunOptions {
  std::filesystem::path out;  ///< logs go to out/logs; made if it is not there
  int repeat = 1;             ///< with the seeds of the scenario, that + 1, …
  int jobs = 1;               ///< runs at a time
  bool force = false;         ///< write over logs that are there
  Progress progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< true ends the runs; their logs are whole files
};

/// Simulates the runs of an experiment, each into a log out/logs/NAME.mcap, or NAME-0.mcap,
/// NAME-1.mcap, … if there are repetitions. Returns the logs of the runs that were begun. A run
/// that cannot go on leaves what it has in its log, and throws FailedRun when the others have
/// ended.
std::vector<std::filesystem::path> RunExperiment(const ExperimentFile& file, const RunOptions& o);

/// What the logs of an experiment's runs hold: by repetition, and then in the order of the
/// experiment.
std::vector<RunData> ReadRuns(const std::vector<std::filesystem::path>& logs);

/// The report on the runs of one experiment: its claims, figures and tables from their logs.
/// A claim holds if it holds in every repetition. Throws Error if the logs are of different
/// experiments, or runs are missing.
Report ReportOf(const std::vector<RunData>& runs);

}  // namespace pliant
