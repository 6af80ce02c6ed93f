#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/mcap_log.h"
#include "pliant/systems/simulator.h"

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

/// How a run has ended: the record "pliant.run" of its log. `whole`: it came to its end.
std::map<std::string, std::string> RunEndOf(const Simulator& sim, bool whole, double wall_s,
                                            std::int64_t ticks);

/// Makes the tick at the end of a run that came there, if there is one that is not made yet.
/// Whether it did.
bool TickAtEnd(Simulator& sim, double duration_s, Duration period);
/// How many ticks of that period were made.
std::int64_t TicksOf(const Simulator& sim, Duration period);

}  // namespace pliant
