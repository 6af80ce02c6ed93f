#include "pliant/analysis/phase_figure.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

namespace {

constexpr const char* kPosition = "arm.measured_position";
constexpr const char* kVelocity = "arm.measured_velocity";

/// One bound of a joint and what the dampers of some runs make of it.
struct Bound {
  double limit;        ///< q⁺ or q⁻
  double safe;         ///< d_s inside of it, the nearest to the limit of all runs
  double outward;      ///< 1 above, −1 below
  bool shown = false;  ///< the joint comes near
};

struct Extremes {
  double least = kUnbounded, most = -kUnbounded;

  void Cover(double x) {
    if (!std::isfinite(x)) return;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  double width() const { return most - least; }
};

/// A range with room for what stands at its ends.
void Set(Axis& axis, const Extremes& of) {
  const double room = of.width() > 0 ? 0.06 * of.width() : 1;
  axis.from = of.least - room;
  axis.to = of.most + room;
}

/// λ/(4M²), of ë_p = 0.
double SlopeOf(const RunData& run) {
  const auto& damper = ComplianceOf(run.control).damper;
  return damper.rate / (4 * damper.damping_ratio * damper.damping_ratio);
}

/// Where the damper of a run begins to brake before a bound, across the panel.
Curve DamperLine(const RunData& run, const Bound& bound, double range, const Axis& x,
                 std::string label) {
  const double safe =
      bound.limit - bound.outward * ComplianceOf(run.control).damper.safety_distance * range;
  const double far = bound.outward > 0 ? *x.from : *x.to;
  return {.label = std::move(label),
          .x = {far, safe},
          .y = {SlopeOf(run) * (safe - far), 0},
          .draw = Curve::Draw::Dashes};
}

}  // namespace

void PhaseFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  ComplianceOf(scenario.controller);
  RequireRowBetween(from_s, to_s, scenario);
}

void PhaseFigure::RequireSound(const Recording& recorded) const { recorded[kPosition].row(joint); }

Figure PhaseFigure::Draw(const Runs& all) const {
  Panel panel{.x = {.label = "position of " + joint + " [rad]"},
              .left = {.label = "velocity [rad/s]"}};
  Extremes q, v;
  for (const std::string& name_of_run : runs) {
    const RunData& run = all[name_of_run];
    const RowsBetween rows(run.times(), from_s, to_s);
    const auto numbers = [&](const char* path, Extremes& extremes) {
      const Eigen::VectorXd x = run.log[path][joint].segment(rows.begin, rows.size());
      for (const double each : x) extremes.Cover(each);
      return std::vector<double>(x.begin(), x.end());
    };
    panel.curves.push_back(
        {.label = run.title, .x = numbers(kPosition, q), .y = numbers(kVelocity, v)});
  }

  const RunData& first = all[runs.front()];
  const RobotModel& model = ModelOf(first.control);
  const Joint& of = model.joint(static_cast<int>(first.log[kPosition].row(joint)));
  const bool has_positions = of.type != Joint::Type::Continuous;
  const double range = of.upper - of.lower;
  double nearest = kUnbounded, fastest = 0;  // d_s and q̇⁺, of the run that is allowed most
  for (const std::string& name_of_run : runs) {
    const auto& damper = ComplianceOf(all[name_of_run].control).damper;
    nearest = std::min(nearest, damper.safety_distance * range);
    fastest = std::max(fastest, damper.velocity_fraction * of.velocity);
  }

  const double near_q = q.width(), near_v = std::max(v.width(), 0.25 * fastest);
  std::vector<Bound> bounds;
  if (has_positions) {
    bounds.push_back({of.upper, of.upper - nearest, 1, of.upper - nearest - q.most < near_q});
    bounds.push_back({of.lower, of.lower + nearest, -1, q.least - of.lower - nearest < near_q});
  }
  for (const Bound& bound : bounds)
    if (bound.shown) q.Cover(bound.limit);
  const bool up = fastest - v.most < near_v, down = v.least + fastest < near_v;
  if (up) v.Cover(fastest);
  if (down) v.Cover(-fastest);
  v.Cover(0);
  Set(panel.x, q);
  Set(panel.left, v);

  for (const double side : {1.0, -1.0}) {
    if (!(side > 0 ? up : down)) continue;
    panel.limits.push_back({.at = side * fastest});
    panel.y_bands.push_back(side > 0 ? Band{fastest, kUnbounded} : Band{-kUnbounded, -fastest});
  }
  for (const Bound& bound : bounds) {
    if (!bound.shown) continue;
    panel.x_limits.push_back({.at = bound.safe});
    panel.x_limits.push_back({.at = bound.limit});
    for (const double from : {bound.safe, bound.limit})
      panel.x_bands.push_back(bound.outward > 0 ? Band{from, kUnbounded, "", true}
                                                : Band{-kUnbounded, from, "", true});
    std::vector<std::pair<double, double>> drawn;
    for (const std::string& name_of_run : runs) {
      const RunData& run = all[name_of_run];
      const std::pair line{SlopeOf(run), ComplianceOf(run.control).damper.safety_distance};
      if (std::ranges::find(drawn, line) != drawn.end()) continue;
      drawn.push_back(line);
      const bool is_first = std::ranges::none_of(
          panel.curves, [](const Curve& c) { return c.draw == Curve::Draw::Dashes; });
      panel.curves.push_back(DamperLine(run, bound, range, panel.x,
                                        is_first ? "limits, and where dampers begin" : ""));
    }
  }
  return {.name = name, .caption = caption, .panels = {std::move(panel)}};
}

}  // namespace pliant
