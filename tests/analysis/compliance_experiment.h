#pragma once

#include <string>

#include "pliant/analysis/run_experiment.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {

/// Runs of the recursive engine with ideal torques, so that seconds pass quickly.
inline const std::string kShort = R"(title: Short
summary: Two runs of a tenth of a second.
robot: gen3
station: !SimulatedArm {ideal: true, engine: recursive}
controller: !Compliance {tool: tool_frame}
environment:
  - !Push {link: tool_frame, force: [0, 0, -20], start_s: 0, duration_s: 0.08, edge_s: 0.02}
duration_s: 0.1
runs:
  - {name: stiff, title: stiff}
  - {name: full, title: full, set: {controller.pose.compliance: 1, controller.posture.compliance: 1}}
)";

/// The report on all runs of an experiment.
inline Report ReportOn(const ExperimentFile& file) {
  const TemporaryDirectory out;
  return ReportOf(ReadRuns(RunExperiment(file, {.out = out.path()})));
}

}  // namespace pliant
