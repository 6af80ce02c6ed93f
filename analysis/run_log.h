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

/// Whether there is a tick of that period at t [s].
bool IsAtTick(double t, Duration period);
/// How many there are before t.
std::int64_t TicksBefore(double t, Duration period);

}  // namespace pliant
