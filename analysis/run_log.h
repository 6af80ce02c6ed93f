#pragma once

#include <filesystem>
#include <string>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/mcap_log.h"

namespace pliant {

/// A run, and where its log is to be.
struct RunLog {
  std::filesystem::path file;
  std::string experiment;  ///< the effective file, as YAML
  RunOf run;
  Scenario scenario;
  int repetition = 0;
  bool force = false;  ///< write over a log that is there
};

/// The log of a run, which says how to repeat it.
McapLog::Options RunLogOf(const RunLog& log);

}  // namespace pliant
