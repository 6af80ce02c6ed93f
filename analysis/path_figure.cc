#include "pliant/analysis/path_figure.h"

#include <algorithm>

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

std::string UnitOf(const SignalElement& of, const Recording& recorded) {
  const RecordedSignal& signal = recorded[of.signal];
  return signal.units[static_cast<std::size_t>(signal.row(of.element))];
}

Axis AxisOf(const SignalElement& of, const std::string& unit) {
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
  for (const Plane& plane : planes) figure.panels.push_back(PanelOf(plane, all));
  return figure;
}

Panel PathFigure::PanelOf(const Plane& plane, const Runs& all) const {
  std::vector<Curve> curves;
  double largest_x = 0, largest_y = 0;
  for (const std::string& name_of_run : runs) {
    const RunData& run = all[name_of_run];
    const auto numbers = [&](const SignalElement& of, double& largest) {
      const RecordedSignal& signal = run.log[of.signal];
      const RowsBetween rows(signal.times, from_s, to_s);
      const Eigen::VectorXd x = signal[of.element].segment(rows.begin, rows.size());
      largest = std::max(largest, x.cwiseAbs().maxCoeff<Eigen::PropagateNumbers>());
      return std::vector<double>(x.begin(), x.end());
    };
    curves.push_back(
        {.label = run.title, .x = numbers(plane.x, largest_x), .y = numbers(plane.y, largest_y)});
  }
  const Recording& first = all[runs.front()].log;
  const std::string x_unit = UnitOf(plane.x, first), y_unit = UnitOf(plane.y, first);
  const bool equal = x_unit == y_unit;
  const double largest = std::max(largest_x, largest_y);
  const ScaledUnit x = UnitFor(equal ? largest : largest_x, x_unit);
  const ScaledUnit y = UnitFor(equal ? largest : largest_y, y_unit);
  for (Curve& curve : curves) {
    for (double& number : curve.x) number /= x.factor;
    for (double& number : curve.y) number /= y.factor;
  }
  return {.x = AxisOf(plane.x, x.unit),
          .left = AxisOf(plane.y, y.unit),
          .curves = std::move(curves),
          .equal_scales = equal};
}

}  // namespace pliant
