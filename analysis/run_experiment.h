#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/live_view.h"
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
  int jobs = 1;               ///< runs at a time
  bool force = false;         ///< write over logs that are there
  Progress progress = {};
  const std::atomic<bool>* stop = nullptr;  ///< true ends the runs; their logs are whole files
  /// Shows the one run, which then keeps pace with the wall clock. Without `out` it leaves no log.
  LiveView* view = nullptr;
  std::function<void(const std::string&)> say = {};  ///< how a run that is shown kept pace
};

/// Simulates the runs of an experiment, each `repeat` times with the seeds of its scenario, that
/// + 1, …, each into a log out/logs/NAME.mcap, or NAME-0.mcap, NAME-1.mcap, … if it is repeated.
/// Returns the logs of the runs that were begun. A run that cannot go on leaves what it has in its
/// log, and throws FailedRun when the others have ended.
std::vector<std::filesystem::path> RunExperiment(const ExperimentFile& file, const RunOptions& o);

/// What the logs of an experiment's runs hold, all in memory: by repetition, and then in the order
/// of the experiment.
std::vector<RunData> ReadRuns(const std::vector<std::filesystem::path>& logs);

/// The report on the runs of one experiment: its claims, figures and tables from their logs. A
/// claim about one run holds if it holds in every repetition; one about many repetitions is judged
/// by all of them. Figures of signals show the first. Throws Error if the logs are of different
/// experiments, if runs are missing, or if there are too few repetitions for a claim.
Report ReportOf(const std::vector<RunData>& runs);

/// A report, and the runs of the first repetition, which its page shows.
struct RunsReport {
  Report report;
  std::vector<std::shared_ptr<const RunData>> kept;

  Runs runs() const;  ///< lives no longer than this
};

/// Reads the log of a run.
using ReadRun = std::function<std::shared_ptr<const RunData>(const std::filesystem::path&)>;

std::shared_ptr<const RunData> ReadWhole(const std::filesystem::path& log);

/// The same of logs, of which `read` reads those of one repetition at a time: what is in memory are
/// the runs of the first repetition and of the one that is measured.
RunsReport ReportOf(const std::vector<std::filesystem::path>& logs,
                    const ReadRun& read = ReadWhole);

}  // namespace pliant
