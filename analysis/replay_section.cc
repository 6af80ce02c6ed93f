#include "pliant/analysis/replay_section.h"

#include "pliant/analysis/page_data.h"
#include "pliant/analysis/page_run.h"

namespace pliant::internal {

namespace {

/// The run with all signals that have the times of the joints, and its data as text.
Json JsonOf(const RunData& run, std::size_t index, std::size_t characters, std::string& data) {
  std::vector<const RecordedValue*> values;
  PageColumns columns{{run.times().begin(), run.times().end()}};
  for (const RecordedSignal& signal : run.log.signals()) {
    if (signal.times != run.times()) continue;
    values.push_back(&signal);
    for (Eigen::Index i = 0; i < signal.numbers.rows(); ++i) {
      const Eigen::RowVectorXd row = signal.numbers.row(i);
      columns.emplace_back(row.begin(), row.end());
    }
  }
  FittedData fitted = FitPageData(columns, characters);
  data = std::move(fitted.text);
  Json json = PageRun(run.title, values, run.arm.model, PushesOf(run.scenario));
  json["data"] = "data-" + std::to_string(index);
  json["rows"] = fitted.rows;
  json["decimation"] = fitted.decimation;
  return json;
}

}  // namespace

ReplaySection ReplaySectionOf(const std::vector<const RunData*>& runs, std::size_t characters) {
  if (runs.empty()) return {};
  Json list = Json::array();
  std::vector<std::string> data(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i)
    list.push_back(JsonOf(*runs[i], i, characters / runs.size(), data[i]));
  const RunData& first = *runs.front();
  const Json all{{"plots", {{"arm.measured_position"}, {"control.torque"}, {"control.pose_error"}}},
                 {"runs", list},
                 {"robot", PageRobot(first.arm.model, ToolOf(first.control))}};
  return {"<section id=\"replay\"></section>\n", PageEnd(all, data, "replay")};
}

}  // namespace pliant::internal
