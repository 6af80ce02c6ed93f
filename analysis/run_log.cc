#include "pliant/analysis/run_log.h"

#include "pliant/analysis/write_file.h"
#include "pliant/plants/parameter_text.h"

namespace pliant {

McapLog::Options RunLogOf(const RunLog& log) {
  const std::filesystem::path urdf = UrdfOf(log.scenario);
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
          .robot = RobotModel::FromUrdf(urdf),
          .robot_description = internal::ReadFile(urdf),
          .position = "arm.measured_position",
          .velocity = "arm.measured_velocity",
          .torque = "arm.measured_torque"};
}

}  // namespace pliant
