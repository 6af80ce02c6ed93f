#include "pliant/analysis/friction_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "pliant/analysis/write_file.h"

namespace pliant {

using Eigen::Index;

namespace {

constexpr Index kPoints = 1500;
constexpr int kCurvePoints = 200;

std::string Digits(double value, const char* format = "%.4g") {
  if (!std::isfinite(value)) return "–";
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string UnitOf(const std::string& name) {
  if (name.starts_with("viscous")) return "N·m·s/rad";
  if (name.starts_with("stribeck")) return "rad/s";
  return "N·m";
}

std::string FileName(const std::string& joint) {
  std::string name = "friction_";
  for (const char c : joint) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

/// A curve over both directions, with a gap where nothing slides.
template <class Law>
Curve Drawn(const std::string& label, double fastest, double slowest, const Law& law) {
  Curve curve{.label = label, .x = {}, .y = {}};
  for (const double sign : {-1.0, 1.0}) {
    for (int i = 0; i < kCurvePoints; ++i) {
      const double share =
          static_cast<double>(sign < 0 ? kCurvePoints - 1 - i : i) / (kCurvePoints - 1);
      const double v = sign * (slowest + share * share * (fastest - slowest));
      curve.x.push_back(v);
      curve.y.push_back(law(v));
    }
    curve.x.push_back(0);
    curve.y.push_back(std::nan(""));
  }
  return curve;
}

}  // namespace

std::vector<FrictionFit> FitChosen(const FrictionSamples& samples,
                                   std::optional<FrictionModel> model, FrictionFitOptions options) {
  options.model = model.value_or(FrictionModel::Stribeck);
  options.offset = options.offset && CountSliding(samples, options).both();
  if (!model) return CompareFriction(samples, options);
  return {FitFriction(samples, options)};
}

FrictionResult Identified(FrictionLog log, std::optional<FrictionModel> model,
                          FrictionFitOptions options) {
  const FrictionSamples& samples = log.samples;
  FrictionResult result{.log = {}, .fit = {}};
  try {
    const std::vector<FrictionFit> fits = FitChosen(samples, model, options);
    result.fit = fits.front();
    if (!model) result.candidates = fits;
  } catch (const Error& e) {
    options.model = model.value_or(FrictionModel::Stribeck);
    result.fit.options = options;
    result.fit.unidentified = {{"friction", e.what()}};
    result.fit.least_velocity = LeastVelocityOf(samples, options);
    result.fit.samples = CountSliding(samples, options).all();
  }
  result.log = std::move(log);
  return result;
}

Figure FigureOf(const FrictionResult& result) {
  const FrictionSamples& s = result.log.samples;
  const FrictionFit& fit = result.fit;
  const FrictionEstimate* offset = fit.Find("offset");
  const double b = offset ? offset->value : 0;
  const auto at = [&](const char* name, double v) {
    const std::string behind = !fit.options.separate ? "" : v < 0 ? "_negative" : "_positive";
    const FrictionEstimate* e = fit.Find(name + behind);
    return e ? e->value : std::nan("");
  };

  Curve cloud, left;
  cloud.label = "samples";
  cloud.draw = left.draw = Curve::Draw::Points;
  const Index stride = std::max<Index>(1, s.velocity.size() / kPoints);
  for (Index k = 0; k < s.velocity.size(); k += stride) {
    cloud.x.push_back(s.velocity(k));
    cloud.y.push_back(s.torque(k) - b);
    const double residual = s.torque(k) - b - fit.Curve(s.velocity(k));
    if (std::abs(s.velocity(k)) < fit.least_velocity || !std::isfinite(residual)) continue;
    left.x.push_back(s.velocity(k));
    left.y.push_back(residual);
  }
  const double fastest = s.velocity.size() > 0 ? s.velocity.cwiseAbs().maxCoeff() : 1;
  const double slowest = 1e-3 * fastest;

  Panel over{.title = result.log.joint,
             .x = {.label = "velocity [rad/s]"},
             .left = {.label = "torque error [N·m]"}};
  over.curves.push_back(std::move(cloud));
  const auto draw = [&](const std::string& label, const auto& law) {
    Curve curve = Drawn(label, fastest, slowest, law);
    const bool told = std::ranges::any_of(curve.y, [](double y) { return std::isfinite(y); });
    if (told) over.curves.push_back(std::move(curve));
  };
  draw("fit", [&](double v) { return fit.Curve(v); });
  draw("Coulomb", [&](double v) { return std::copysign(at("coulomb", v), v); });
  draw("viscous", [&](double v) { return at("viscous", v) * v; });
  for (const double sign : {1.0, -1.0}) {
    const double c = at("coulomb", sign), stiction = at("stiction", sign);
    if (!std::isfinite(c) || !std::isfinite(stiction)) continue;
    over.y_bands.push_back({.from = std::min(sign * c, sign * stiction),
                            .to = std::max(sign * c, sign * stiction),
                            .label = sign > 0 ? "static" : ""});
  }
  const bool followed = !left.x.empty();
  Panel below{.x = {.label = "velocity [rad/s]"}, .left = {.label = "residual [N·m]"}};
  below.curves.push_back(std::move(left));
  below.limits = {{.at = 2 * fit.scale, .label = "2 σ"}, {.at = -2 * fit.scale}};
  const double room = 6 * fit.scale;
  if (room > 0) {
    below.left.from = -room;
    below.left.to = room;
  }
  return {.name = FileName(result.log.joint),
          .caption = "Torque error of " + result.log.joint + " over its velocity" +
                     (offset ? ", without the offset of " + Digits(b) + " N·m" : "") +
                     ", and what the fit leaves. Of " + Text(s.velocity.size()) +
                     " samples an even share is shown.",
          .panels = followed ? std::vector<Panel>{std::move(over), std::move(below)}
                             : std::vector<Panel>{std::move(over)}};
}

Table FrictionTable(const std::vector<FrictionResult>& results) {
  Table table{.title = "Identified friction",
              .columns = {"joint", "parameter", "value", "95 % interval", "unit"},
              .rows = {},
              .caption =
                  "Intervals hold for the loss and for noise that is alike in neighbours; "
                  "they do not hold a lack of fit."};
  for (const FrictionResult& result : results) {
    for (const FrictionEstimate& e : result.fit.estimates)
      table.rows.push_back({result.log.joint, e.name, Digits(e.value),
                            Digits(e.low) + " to " + Digits(e.high), UnitOf(e.name)});
    for (const auto& u : result.fit.unidentified)
      table.rows.push_back({result.log.joint, u.name, "–", u.reason, UnitOf(u.name)});
  }
  return table;
}

namespace {

Table Residuals(const std::vector<FrictionResult>& results) {
  Table table{.title = "What the fits leave",
              .columns = {"joint", "samples", "σ [N·m]", "rms [N·m]", "beyond 4 σ",
                          "held out σ [N·m]", "lack of fit [N·m]", "samples per independent one"},
              .rows = {},
              .caption =
                  "σ is 1.4826 times the median of |r|. Lack of fit is the root mean square, "
                  "over bins of velocity, of what is left in the mean."};
  for (const FrictionResult& result : results) {
    const FrictionFit& f = result.fit;
    if (f.estimates.empty()) continue;
    table.rows.push_back({result.log.joint, Text(f.samples), Digits(f.scale), Digits(f.rms),
                          Digits(100 * f.outliers, "%.2f %%"), Digits(f.cross_validation),
                          Digits(f.lack_of_fit) + (f.lacks_fit ? " ✗" : ""),
                          Digits(f.inefficiency, "%.3g")});
  }
  return table;
}

}  // namespace

Table FrictionModels(const std::vector<FrictionResult>& results) {
  Table table{.title = "Models",
              .columns = {"joint", "model", "AIC", "BIC", "held out σ [N·m]", "not told"},
              .rows = {},
              .caption = "The first of each joint has the least BIC and was taken."};
  for (const FrictionResult& result : results)
    for (const FrictionFit& f : result.candidates) {
      std::string not_told;
      for (const auto& u : f.unidentified) not_told += (not_told.empty() ? "" : ", ") + u.name;
      table.rows.push_back({result.log.joint, WordOf(f.options.model), Digits(f.aic, "%.1f"),
                            Digits(f.bic, "%.1f"), Digits(f.cross_validation),
                            not_told.empty() ? "–" : not_told});
    }
  return table;
}

Report FrictionReportOf(const std::vector<FrictionResult>& results, const std::string& logs,
                        const std::string& read) {
  Report report{.title = "Identified friction",
                .summary = "Friction of " + Text(results.size()) +
                           (results.size() == 1 ? " joint" : " joints") +
                           ", from the torque error y = κ i − τ − B q̈ over the velocity."};
  report.settings = {{"logs", logs}, {"read", read}};
  if (!results.empty()) {
    const FrictionFitOptions& o = results.front().fit.options;
    report.settings.push_back({"loss", WordOf(o.loss)});
    report.settings.push_back({"directions", o.separate ? "separate" : "both"});
  }
  for (const FrictionResult& result : results) {
    report.figures.push_back(FigureOf(result));
    for (const std::string& doubt : result.log.doubts)
      report.settings.push_back({"doubt", result.log.joint + ": " + doubt});
  }
  report.tables = {FrictionTable(results), Residuals(results)};
  if (Table models = FrictionModels(results); !models.rows.empty())
    report.tables.push_back(std::move(models));
  return report;
}

std::string FrictionText(const FrictionResult& result) {
  const FrictionFit& f = result.fit;
  std::string all = result.log.joint + ": " + WordOf(f.options.model) + ", " + Text(f.samples) +
                    " samples faster than " + Digits(f.least_velocity) + " rad/s, " +
                    Text(result.log.transient) + " left out after " + Text(result.log.steps) +
                    " steps of the current\n";
  std::array<char, 200> line;
  for (const FrictionEstimate& e : f.estimates) {
    std::snprintf(line.data(), line.size(), "  %-26s %10.4g  from %.4g to %.4g %s\n",
                  e.name.c_str(), e.value, e.low, e.high, UnitOf(e.name).c_str());
    all += line.data();
  }
  for (const auto& u : f.unidentified)
    all += "  " + u.name + " is not identified: " + u.reason + "\n";
  if (!f.estimates.empty()) {
    std::snprintf(
        line.data(), line.size(),
        "  residual σ %.3g N·m, held out %s, %.2f %% beyond 4 σ, lack of fit %.2g N·m%s\n", f.scale,
        Digits(f.cross_validation, "%.3g").c_str(), 100 * f.outliers, f.lack_of_fit,
        f.lacks_fit ? ": the model does not follow the samples" : "");
    all += line.data();
  }
  for (const FrictionFit& c : result.candidates) {
    std::snprintf(line.data(), line.size(), "  %-16s AIC %.1f  BIC %.1f%s\n",
                  WordOf(c.options.model).c_str(), c.aic, c.bic,
                  &c == &result.candidates.front() ? "  taken" : "");
    all += line.data();
  }
  for (const std::string& doubt : result.log.doubts) all += "  doubt: " + doubt + "\n";
  return all;
}

void WriteFriction(const FrictionFile& friction, const std::filesystem::path& file, bool force) {
  internal::RequireNewFile(file, force);
  internal::WriteFile(file, friction.text());
}

}  // namespace pliant
