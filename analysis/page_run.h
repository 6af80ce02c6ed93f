#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pliant/plants/push.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/record_sink.h"

/// What a page knows of runs and of their robot; web/README.md says what is in it.
namespace pliant::internal {

using Json = nlohmann::ordered_json;

/// Links, joints and shapes. The path that is shown is that of the tool.
Json PageRobot(const RobotModel& model, const std::string& tool);

/// A run: its columns, the time first and then the numbers of the values, what poses the joints,
/// the arrows of forces, the times of pushes.
Json PageRun(const std::string& title, const std::vector<const RecordedValue*>& values,
             const RobotModel& model, const std::vector<Push::Options>& pushes);

/// The end of a page's body: the data of the runs, what is known of them, and web/dist/SCRIPT.js
/// and .css, which show them.
std::string PageEnd(const Json& runs, const std::vector<std::string>& data, const char* script);

}  // namespace pliant::internal
