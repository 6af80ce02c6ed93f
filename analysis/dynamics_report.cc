#include "pliant/analysis/dynamics_report.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>

#include "pliant/analysis/write_file.h"
#include "pliant/plants/urdf_inertials.h"
#include "pliant/systems/error.h"

namespace pliant {
namespace {

__attribute__((format(printf, 1, 2))) std::string Printed(const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

std::vector<std::pair<std::string, PerJoint>> RowsOf(const TorqueResiduals& r) {
  return {{"torque itself", r.torque},
          {"model as it is", r.model},
          {"model + joint terms", r.prior},
          {"least squares", r.free},
          {"identified", r.identified}};
}

std::string Title(const TorqueResiduals& r) {
  return "torque residual, rms [N·m], of the log that was " + r.log;
}

void AppendResiduals(const TorqueResiduals& r, std::string& text) {
  text += Title(r) + "\n";
  for (const auto& [name, rms] : RowsOf(r)) {
    text += Printed("  %-20s", name.c_str());
    for (const double x : rms) text += Printed(" %8.4f", x);
    text += '\n';
  }
}

Table TableOf(const TorqueResiduals& r, const RobotModel& model) {
  Table table{.title = Title(r), .columns = {""}, .rows = {}};
  for (const Joint& joint : model.joint_data()) table.columns.push_back(joint.name);
  for (const auto& [name, rms] : RowsOf(r)) {
    table.rows.push_back({name});
    for (const double x : rms) table.rows.back().push_back(Printed("%.4f", x));
  }
  return table;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// A figure the data did not decide by more than half is the prior's.
std::string Mark(double from_data) { return from_data < 0.5 ? " (prior)" : ""; }

constexpr const char* kFigures[] = {"mass [kg]", "c_x [m]", "c_y [m]", "c_z [m]", "I_xx [kg·m²]",
                                    "I_xy",      "I_xz",    "I_yy",    "I_yz",    "I_zz"};

double FigureOf(const Inertial& i, std::size_t k) {
  constexpr int kRow[] = {0, 0, 0, 1, 1, 2}, kColumn[] = {0, 1, 2, 1, 2, 2};
  if (k == 0) return i.mass;
  if (k < 4) return i.center[static_cast<Eigen::Index>(k) - 1];
  return i.inertia(kRow[k - 4], kColumn[k - 4]);
}

}  // namespace

std::string TextOf(const DynamicsResult& result) {
  std::string text = Printed("%td points fitted", result.points);
  if (result.repeated > 0) text += Printed(", %td rows repeat the one before", result.repeated);
  if (result.gaps > 0) text += Printed(", %td points left out for want of rows", result.gaps);
  text += "\n";
  AppendResiduals(result.fitted, text);
  if (result.validated) AppendResiduals(*result.validated, text);
  text += Printed("points worth one independent point:");
  for (const double x : result.correlation) text += Printed(" %.1f", x);
  text += Printed("\ncondition number %.3g, %zu combinations identified\n", result.condition,
                  result.combinations.size());
  if (!result.without.empty()) text += "without effect: " + Listed(result.without) + "\n";
  if (!result.combined.empty()) text += "in combinations only: " + Listed(result.combined) + "\n";
  text += "combinations, model -> found ± half of the 95 % interval\n";
  for (const IdentifiedCombination& c : result.combinations)
    text += Printed("  %11.5g -> %11.5g ± %-9.3g ", c.prior, c.value, c.half_width) + c.name + "\n";
  for (const IdentifiedLink& link : result.links) {
    text += (result.payload ? "payload on link " : "link ") + link.name +
            ", could be built, ± half of the 95 % interval\n";
    for (std::size_t k = 0; k < std::size(kFigures); ++k)
      text += Printed("  %-14s %11.5g ± %.2g%s\n", kFigures[k], FigureOf(link.found.inertial, k),
                      1.96 * FigureOf(link.found.deviation, k),
                      Mark(link.found.from_data[static_cast<Eigen::Index>(k)]).c_str());
  }
  text += "joint terms: coulomb [N·m], viscous [N·m·s/rad], offset [N·m], rotor [kg·m²]\n";
  for (std::size_t j = 0; j < result.terms.size(); ++j) {
    const JointTermValues& t = result.terms[j];
    text += Printed("  %9.4f %9.4f %9.4f %9.4f  ", t.coulomb, t.viscous, t.offset, t.rotor) +
            result.model.joint(static_cast<int>(j)).name + "\n";
  }
  return text;
}

Report ReportOf(const DynamicsResult& result) {
  Report report{.title = "Identified dynamics of " + result.model.name(),
                .summary =
                    "Inertial figures found from measured joint torques by weighted least "
                    "squares, and the links that could be built which explain them as well. "
                    "Figures marked (prior) were not decided by the data."};
  report.settings = {{"points", Text(result.points)},
                     {"rows dropped, they repeat the one before", Text(result.repeated)},
                     {"condition number", Printed("%.4g", result.condition)},
                     {"without effect", Listed(result.without)},
                     {"in combinations only", Listed(result.combined)}};
  report.tables.push_back(TableOf(result.fitted, result.model));
  if (result.validated) report.tables.push_back(TableOf(*result.validated, result.model));
  Table combinations{.title = "Combinations",
                     .columns = {"combination", "model", "found", "± (95 %)"},
                     .rows = {}};
  for (const IdentifiedCombination& c : result.combinations)
    combinations.rows.push_back({c.name, Printed("%.5g", c.prior), Printed("%.5g", c.value),
                                 Printed("%.3g", c.half_width)});
  report.tables.push_back(combinations);
  for (const IdentifiedLink& link : result.links) {
    Table table{.title = (result.payload ? "Payload on link " : "Link ") + link.name,
                .columns = {"", "model", "found", "± (95 %)", "decided by"},
                .rows = {}};
    for (std::size_t k = 0; k < std::size(kFigures); ++k) {
      const double data = link.found.from_data[static_cast<Eigen::Index>(k)];
      table.rows.push_back({kFigures[k], Printed("%.5g", FigureOf(link.prior, k)),
                            Printed("%.5g", FigureOf(link.found.inertial, k)),
                            Printed("%.3g", 1.96 * FigureOf(link.found.deviation, k)),
                            data < 0.5 ? "prior" : "data"});
    }
    report.tables.push_back(table);
  }
  Panel panel;
  panel.left.label = "torque residual, rms [N·m]";
  const TorqueResiduals& shown = result.validated ? *result.validated : result.fitted;
  for (Eigen::Index j = 0; j < shown.prior.size(); ++j) {
    const std::string& joint = result.model.joint(static_cast<int>(j)).name;
    panel.bars.push_back({joint, "model + joint terms", shown.prior[j]});
    panel.bars.push_back({joint, "identified", shown.identified[j]});
  }
  report.figures.push_back({.name = "residuals",
                            .caption = "Residual of each joint, of the log that was " + shown.log,
                            .panels = {panel}});
  return report;
}

std::string PayloadYaml(const DynamicsResult& result) {
  Require(result.payload, "this is no payload; a .urdf holds the figures of links");
  const IdentifiedLink& link = result.links.front();
  const auto& [m, c, I] = link.found.inertial;
  const auto& [dm, dc, dI] = link.found.deviation;
  const double radius = std::sqrt(2.5 * I.trace() / 3 / m);  // 2/5 m r² = tr(I)/3
  std::string text = "# Payload found by pliant identify dynamics; ±: half of the 95 % interval.\n";
  text += "# In a URDF:\n" + InertialElement(link.found.inertial, "#   ") + "\n";
  text += "payload:\n  link: " + link.name + "\n";
  text += Printed("  mass: %.6g  # ± %.2g kg\n", m, 1.96 * dm);
  text += Printed("  center: [%.6g, %.6g, %.6g]  # ± [%.2g, %.2g, %.2g] m\n", c.x(), c.y(), c.z(),
                  1.96 * dc.x(), 1.96 * dc.y(), 1.96 * dc.z());
  text += Printed("  radius: %.6g  # of the ball with the mean of its moments\n", radius);
  return text;
}

void WriteIdentified(const DynamicsResult& result, const std::filesystem::path& urdf,
                     const std::filesystem::path& file) {
  if (file.extension() == ".yaml") {
    internal::WriteFile(file, PayloadYaml(result));
    return;
  }
  std::map<std::string, Inertial> inertials;
  for (const IdentifiedLink& link : result.links)
    inertials[link.name] = result.model.link(result.model.link_index(link.name)).inertial;
  internal::WriteFile(file, WithInertials(internal::ReadFile(urdf), inertials, urdf.string()));
}

void RequireIdentifiedFile(const std::filesystem::path& file, bool payload, bool force) {
  const std::string kind = file.extension().string();
  Require(kind == ".yaml" || kind == ".urdf",
          file.string() + ": expected a file that ends in .yaml or .urdf");
  Require(kind == ".urdf" || payload,
          file.string() +
              ": a .yaml holds a payload; for the figures of links expected a file that ends in "
              ".urdf, or --payload");
  internal::RequireNewFile(file, force);
}

}  // namespace pliant
