#include "pliant/analysis/experiment_figures.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "pliant/analysis/compliance_claims.h"
#include "pliant/analysis/series.h"
#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

std::vector<double> Vector(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

/// The norm of the sum of the forces of all contacts of the environment [N].
Eigen::VectorXd ContactForces(const RunData& run) {
  constexpr std::array<std::string_view, 4> kKinds{"push_", "hand_", "mass_", "surface_"};
  Series force = Series::Zero(3, run.times().size());
  for (const RecordedSignal& signal : run.log.signals()) {
    const auto named = [&](std::string_view kind) { return signal.path.starts_with(kind); };
    if (signal.type != ContactForce::quantity.name || std::ranges::none_of(kKinds, named)) continue;
    const std::array<Eigen::Index, 3> rows{signal.row("force[x]"), signal.row("force[y]"),
                                           signal.row("force[z]")};
    force += signal.numbers(rows, Eigen::all);
  }
  return Norms(force);
}

}  // namespace

void RequireFileName(const std::string& name) {
  const bool fit = std::ranges::all_of(
      name, [](unsigned char c) { return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-'); });
  Require(fit, "its name, which names its file, has letters, digits, '_' and '-'",
          "'" + name + "'");
  Require(name.size() <= 100, "its name has at most 100 letters", name.size());
}

std::vector<Band> ContactBands(const Scenario& scenario) {
  std::vector<Band> bands;
  const auto add = [&](double start, double duration) {
    bands.push_back({start, start + duration});
  };
  for (const EnvironmentPart& part : scenario.environment) {
    if (const auto* push = std::get_if<Push::Options>(&part)) add(push->start_s, push->duration_s);
    if (const auto* hold = std::get_if<HandHold>(&part)) add(hold->start_s, hold->duration_s);
  }
  return bands;
}

void VelocityFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  ComplianceOf(scenario.controller);
}

Figure VelocityFigure::Draw(const Runs& all) const {
  Figure figure{
      .name = file(),
      .caption =
          "Norms of the tool's linear and angular velocity and of the joint velocity, and "
          "(orange) the sum of the forces of all contacts. Shaded: while something pushes or a "
          "hand holds. A column for each run.",
      .columns = static_cast<int>(runs.size())};
  struct Row {
    const char* label;
    Eigen::VectorXd (*norms)(const RunData&);
  };
  const std::array<Row, 3> rows{
      {{"tool [m/s]", [](const RunData& r) { return Norms(Linear(r["control.pose_error_rate"])); }},
       {"tool [rad/s]",
        [](const RunData& r) { return Norms(Angular(r["control.pose_error_rate"])); }},
       {"joints [rad/s]", [](const RunData& r) { return Norms(r["arm.measured_velocity"]); }}}};
  for (const Row& row : rows) {
    double top = 0;  // one scale per row, so that columns compare
    for (const std::string& name : runs) top = std::max(top, 1.1 * Largest(row.norms(all[name])));
    for (const std::string& name : runs) {
      const RunData& run = all[name];
      const Eigen::VectorXd force = ContactForces(run);
      const std::vector<double> t = Vector(run.times());
      figure.panels.push_back(
          {.title = &row == &rows.front() ? run.title : "",
           .x = {.label = "time [s]"},
           .left = {.label = row.label, .from = 0, .to = top},
           .right = {.label = "force [N]", .from = 0, .to = 1.25 * std::max(1.0, Largest(force))},
           .curves = {{.label = "", .x = t, .y = Vector(row.norms(run))},
                      {.label = "", .x = t, .y = Vector(force), .side = Side::Right}},
           .x_bands = ContactBands(run.scenario)});
    }
  }
  return figure;
}

void PredictionFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  ComplianceOf(scenario.controller);
}

Figure PredictionFigure::Draw(const Runs& all) const {
  Figure figure{.name = file(),
                .caption =
                    "How far the tool is off, measured and predicted: behind the observer "
                    "by its transfer function, as if the push were static by Λ⁻¹F/λ₂."};
  const auto add = [&](const RunData& run, const Series& predicted, const std::string& how) {
    const auto millimetres = [](const Series& e) { return Vector(1000 * Norms(Linear(e))); };
    figure.panels.push_back(
        {.title = run.title,
         .x = {.label = "time [s]"},
         .left = {.label = "tool [mm]"},
         .curves = {{.label = "measured",
                     .x = Vector(run.times()),
                     .y = millimetres(run["control.pose_error"])},
                    {.label = how, .x = Vector(run.times()), .y = millimetres(predicted)}},
         .x_bands = ContactBands(run.scenario)});
  };
  for (const std::string& name : behind_observer)
    add(all[name], PredictedError(all[name]), "predicted");
  for (const std::string& name : as_if_static) add(all[name], StaticError(all[name]), "if static");
  return figure;
}

Figure LimitFigure::Draw(const Runs& all) const {
  const RunData& of = all[run];
  const RobotModel& model = of.arm.model;
  Figure figure{.name = file(),
                .caption = "Joint positions, velocities and torques as parts of their limits, " +
                           of.title + ". Continuous joints have no position limit."};
  Panel position{.x = {.label = "time [s]"}, .left = {.label = "position / limit"}};
  Panel velocity{.x = {.label = "time [s]"}, .left = {.label = "velocity / limit"}};
  Panel torque{.x = {.label = "time [s]"}, .left = {.label = "torque / limit"}};
  const std::vector<double> t = Vector(of.times());
  for (int i = 0; i < model.size(); ++i) {
    const Joint& j = model.joint(i);
    const auto row = [&](const char* path) { return Eigen::ArrayXd(of[path].row(i).transpose()); };
    if (j.type != Joint::Type::Continuous)
      position.curves.push_back(
          {j.name, t,
           Vector((2 * row("arm.measured_position") - j.lower - j.upper) / (j.upper - j.lower))});
    velocity.curves.push_back({j.name, t, Vector(row("arm.measured_velocity") / j.velocity)});
    torque.curves.push_back({j.name, t, Vector(row("control.torque") / j.effort)});
  }
  for (Panel* panel : {&position, &velocity, &torque}) {
    panel->limits = {{1}, {-1}};
    panel->left.from = -1.1;
    panel->left.to = 1.1;
    figure.panels.push_back(std::move(*panel));
  }
  return figure;
}

Figure SignalFigure::Draw(const Runs& all) const {
  Figure figure{.name = name, .caption = caption, .columns = static_cast<int>(runs.size())};
  for (const std::string& path : signals) {
    for (const std::string& run : runs) {
      const RecordedSignal& signal = all[run].log[path];
      const std::set<std::string> units(signal.units.begin(), signal.units.end());
      Panel panel{.title = path == signals.front() ? all[run].title : "",
                  .x = {.label = "time [s]"},
                  .left = {.label = path + (units.size() == 1 && !units.begin()->empty()
                                                ? " [" + *units.begin() + "]"
                                                : "")},
                  .x_bands = ContactBands(all[run].scenario)};
      for (std::size_t i = 0; i < signal.elements.size(); ++i)
        panel.curves.push_back(
            {.label = signal.elements[i],
             .x = Vector(signal.times),
             .y = Vector(signal.numbers.row(static_cast<Eigen::Index>(i)).transpose())});
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

SignalNumber NormFigure::Of(const std::string& signal) const {
  return {.signal = signal, .relative_to_s = relative_to_s, .below_hz = below_hz};
}

void NormFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  Of("").RequireFit(scenario);
}

void NormFigure::RequireSound(const Recording& recorded) const {
  for (const std::string& path : signals) Of(path).RequireSound(recorded[path]);
}

Figure NormFigure::Draw(const Runs& all) const {
  Figure figure{.name = name, .caption = caption};
  for (const std::string& path : signals) {
    const SignalNumber number = Of(path);
    std::vector<Eigen::VectorXd> norms;
    double largest = 0;
    for (const std::string& run : runs) {
      norms.push_back(Norms(number.Elements(all[run].log[path])));
      largest = std::max(largest, Largest(norms.back()));
    }
    const ScaledUnit unit = UnitFor(largest, number.unit(all[runs.front()].log[path]));
    Panel panel;
    panel.x.label = "time [s]";
    panel.left.label = "‖" + path + "‖ [" + unit.unit + "]";
    panel.left.logarithmic = logarithmic;
    panel.x_bands = ContactBands(all[runs.front()].scenario);
    for (std::size_t i = 0; i < runs.size(); ++i)
      panel.curves.push_back({.label = all[runs[i]].title,
                              .x = Vector(all[runs[i]].log[path].times),
                              .y = Vector(norms[i] / unit.factor)});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace pliant
