#include "pliant/analysis/path_figure.h"

#include <algorithm>

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

namespace {

std::string UnitOf(const SignalElement& of, const Recording& recorded) {
  const RecordedSignal& signal = recorded[of.signal];
  return signal.units[static_cast<std::size_t>(signal.row(of.element))];
}

Axis AxisOf(const SignalElement& of, const Recording& recorded) {
  const std::string unit = UnitOf(of, recorded);
  return {.label = of.signal + "[" + of.element + "]" + (unit.empty() ? "" : " [" + unit + "]")};
}

}  // namespace

void PathFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  Require(!planes.empty(), "it shows no plane");
  RequireRowBetween(from_s, to_s, scenario);
}

void PathFigure::RequireSound(const Recording& recorded) const {
  for (const Plane& plane : planes)
    for (const SignalElement& of : {plane.x, plane.y}) UnitOf(of, recorded);
}

Figure PathFigure::Draw(const Runs& all) const {
  Figure figure{.name = name,
                .caption = caption,
                .columns = static_cast<int>(std::min<std::size_t>(planes.size(), 3))};
  for (const Plane& plane : planes) {
    const Recording& first = all[runs.front()].log;
    Panel panel{.x = AxisOf(plane.x, first), .left = AxisOf(plane.y, first)};
    panel.equal_scales = UnitOf(plane.x, first) == UnitOf(plane.y, first);
    for (const std::string& name_of_run : runs) {
      const RunData& run = all[name_of_run];
      const RowsBetween rows(run.times(), from_s, to_s);
      const auto numbers = [&](const SignalElement& of) {
        const Eigen::VectorXd x = run.log[of.signal][of.element].segment(rows.begin, rows.size());
        return std::vector<double>(x.begin(), x.end());
      };
      panel.curves.push_back({.label = run.title, .x = numbers(plane.x), .y = numbers(plane.y)});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace pliant
