#include "pliant/analysis/run_log.h"

#include "pliant/plants/parameter_text.h"

namespace pliant {

McapLog::Options RunLogOf(const RunLog& log) {
  return {.file = log.file,
          .force = log.force,
          .metadata = {{"pliant",
                        {{"version", PLIANT_VERSION},
                         {"built_with", PLIANT_BUILT_WITH},
                         {"experiment", log.experiment},
                         {"scenario", ParametersText(log.scenario)},
                         {"run", log.run.name},
                         {"title", log.run.title},
                         {"repetition", std::to_string(log.repetition)},
                         {"seed", std::to_string(log.scenario.seed)}}}},
          .robot = RobotOf(log.scenario),
          .robot_description = UrdfTextOf(log.scenario),
          .position = "arm.measured_position",
          .velocity = "arm.measured_velocity",
          .torque = "arm.measured_torque"};
}

}  // namespace pliant
