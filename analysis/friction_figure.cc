#include "pliant/analysis/friction_figure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/friction_run.h"

namespace pliant {

namespace {

/// So many points of a joint are shown.
constexpr Eigen::Index kPoints = 500;

Curve CloudOf(const std::string& label, const FrictionSamples& samples, double offset) {
  Curve cloud{.label = label, .x = {}, .y = {}, .draw = Curve::Draw::Points};
  const Eigen::Index step = std::max<Eigen::Index>(1, samples.velocity.size() / kPoints);
  for (Eigen::Index k = 0; k < samples.velocity.size(); k += step) {
    cloud.x.push_back(samples.velocity(k));
    cloud.y.push_back(samples.torque(k) - offset);
  }
  return cloud;
}

/// NaN if it was not identified.
double ValueOf(const FrictionFit& fit, const char* name) {
  const FrictionEstimate* found = fit.Find(name);
  return found ? found->value : std::numeric_limits<double>::quiet_NaN();
}

std::string Rounded(double x) { return std::isfinite(x) ? Text(std::round(1e3 * x) / 1e3) : "–"; }

}  // namespace

void FrictionFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  RequireFrictionExperiment(scenario);
}

Figure FrictionFigure::Draw(const Runs& all) const {
  const RunData& of = all[run];
  Figure figure{.name = name,
                .caption = "Torque that friction takes over the velocity, " + of.title +
                           ": samples at constant speeds, the Coulomb and viscous friction that "
                           "fits them, and, shaded, up to where the joints stay at rest.",
                .columns = 2};
  for (const ActuatorSize& size : SizesOf(of)) {
    const SizeFit fit = FitOf(size);
    const double c = ValueOf(fit.all, "coulomb"), d = ValueOf(fit.all, "viscous"),
                 s = ValueOf(fit.all, "stiction");
    Panel panel{.title = "c = " + Rounded(c) + " N·m, d = " + Rounded(d) +
                         " N·m·s/rad, s = " + Rounded(s) + " N·m",
                .x = {.label = "velocity [rad/s]"},
                .left = {.label = "κ i − τ − B q̈ [N·m]"}};
    for (std::size_t i = 0; i < size.joints.size(); ++i) {
      const FrictionEstimate* offset = fit.each[i].Find("offset");
      panel.curves.push_back(CloudOf(of.arm.model.joint(size.joints[i].joint).name,
                                     size.joints[i].samples, offset ? offset->value : 0));
    }
    const double fastest = fit.pooled.velocity.cwiseAbs().maxCoeff();
    constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(c + d))
      panel.curves.push_back({.label = "fit",
                              .x = {-fastest, 0, kGap, 0, fastest},
                              .y = {-c - d * fastest, -c, kGap, c, c + d * fastest}});
    if (std::isfinite(s)) panel.y_bands.push_back({-s, s, "static"});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace pliant
