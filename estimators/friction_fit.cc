#include "pliant/estimators/friction_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pliant/estimators/friction_regression.h"

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::Blocking;
using internal::BlockingOf;
using internal::Certainty;
using internal::CertaintyOf;
using internal::InfluenceOf;
using internal::kNormal95;
using internal::Residuals;
using internal::Shape;
using internal::Solution;
using internal::SolutionOf;
using internal::Solve;
using internal::Student95;
using internal::Thinned;

const std::vector<std::string>& Words(FrictionModel) {
  static const std::vector<std::string> words{"coulomb_viscous", "stribeck", "lugre_static"};
  return words;
}

const std::vector<std::string>& Words(FrictionLoss) {
  static const std::vector<std::string> words{"none", "huber", "cauchy"};
  return words;
}

double MedianOf(std::vector<double> all) {
  if (all.empty()) return 0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Index kLeastInDirection = 20;

constexpr Index kHalfWindow = 5;

/// The mean of each velocity and of its neighbours in the same stretch that differ by noise at
/// most: noise in ω would flatten what is fitted over it. `of` is how many are in each.
struct Means {
  VectorXd velocity, of;
};
Means MeansOf(const FrictionSamples& samples) {
  const VectorXd& v = samples.velocity;
  const double near = 5 * NoiseOf(v);
  Means means{v, VectorXd::Ones(v.size())};
  if (near == 0) return means;
  for (std::size_t i = 0; i < samples.begin.size(); ++i) {
    const Index from = samples.begin[i];
    const Index to = i + 1 < samples.begin.size() ? samples.begin[i + 1] : v.size();
    for (Index k = from; k < to; ++k) {
      // As many before as after, or a change would shift it.
      const Index half = std::min({kHalfWindow, k - from, to - 1 - k});
      double sum = v(k), count = 1;
      for (Index j = 1; j <= half; ++j) {
        if (std::abs(v(k - j) - v(k)) > near || std::abs(v(k + j) - v(k)) > near) break;
        sum += v(k - j) + v(k + j);
        count += 2;
      }
      means.velocity(k) = sum / count;
      means.of(k) = count;
    }
  }
  return means;
}

/// Samples that slide.
struct Sliding {
  VectorXd velocity, torque, raw;  // raw: the velocities as they were measured
  std::vector<bool> faster;        // the speed grows
  std::vector<Index> begin;
};

Sliding SlidingOf(const FrictionSamples& samples, const FrictionFitOptions& o) {
  const Means means = MeansOf(samples);
  const VectorXd& velocity = means.velocity;
  const double least = LeastVelocityOf(samples, o);
  // A mean of few, at the ends of a stretch, has more noise.
  const double noise = o.least_velocity > 0 ? 0 : 4 * NoiseOf(samples.velocity);
  Sliding s;
  std::vector<Index> kept;
  std::size_t stretch = 0;
  Index last = -2;
  for (Index k = 0; k < samples.velocity.size(); ++k) {
    bool fresh = k != last + 1;
    while (stretch < samples.begin.size() && samples.begin[stretch] <= k) {
      fresh = true;
      ++stretch;
    }
    if (!(std::abs(velocity(k)) >= std::max(least, noise / std::sqrt(means.of(k))))) continue;
    s.faster.push_back(k > 0 && k + 1 < velocity.size() &&
                       std::abs(velocity(k + 1)) > std::abs(velocity(k - 1)));
    if (fresh || kept.empty()) s.begin.push_back(std::ssize(kept));
    kept.push_back(k);
    last = k;
  }
  s.velocity = velocity(kept);
  s.raw = samples.velocity(kept);
  s.torque = samples.torque(kept);
  return s;
}

SlidingCount CountOf(const Sliding& s) {
  const Index positive = (s.velocity.array() > 0).count();
  return {positive, s.velocity.size() - positive};
}

void RequireSound(const FrictionSamples& samples) {
  Require(samples.velocity.size() == samples.torque.size(),
          "there must be a torque for each velocity, " + Text(samples.velocity.size()),
          samples.torque.size());
  Require(
      samples.velocity.allFinite() && samples.torque.allFinite() && samples.break_away.allFinite(),
      "velocities and torques must be finite");
}

/// Whether the velocities of a direction are one velocity and its noise.
bool IsOneVelocity(const Sliding& s, double sign) {
  std::vector<double> v;
  double differences = 0;
  Index pairs = 0;
  for (Index k = 0; k < s.raw.size(); ++k) {
    if (s.raw(k) * sign <= 0) continue;
    v.push_back(s.raw(k));
    if (k > 0 && s.raw(k - 1) * sign > 0) {
      differences += std::pow(s.raw(k) - s.raw(k - 1), 2);
      ++pairs;
    }
  }
  if (v.size() < 2 || pairs == 0) return v.size() < 2;
  const Eigen::Map<const VectorXd> all(v.data(), std::ssize(v));
  const double variance = (all.array() - all.mean()).square().mean();
  // The noise is half of what neighbours differ by; a quarter of it at most may be left.
  return variance < 4 * differences / (2 * static_cast<double>(pairs)) &&
         std::sqrt(variance) < 0.2 * std::abs(all.mean());
}

/// Bins of velocity, and in each those that grow faster by themselves: bristles lag behind.
void AddLackOfFit(FrictionFit& fit, const Sliding& s, const VectorXd& r) {
  constexpr Index kInBin = 20, kMostBins = 12;
  double squares = 0, noise = 0, chi2 = 0;
  Index bins = 0;
  for (const double sign : {1.0, -1.0}) {
    for (const bool faster : {true, false}) {
      std::vector<Index> order;
      for (Index k = 0; k < std::ssize(s.faster); ++k)
        if (s.velocity(k) * sign > 0 && s.faster[static_cast<std::size_t>(k)] == faster)
          order.push_back(k);
      std::ranges::sort(order, {}, [&](Index k) { return std::abs(s.velocity(k)); });
      const Index size = std::ssize(order), count = std::min(kMostBins, size / kInBin);
      for (Index b = 0; b < count; ++b) {
        double sum = 0, sum2 = 0;
        const Index from = b * size / count, to = (b + 1) * size / count;
        for (Index i = from; i < to; ++i) {
          const double e =
              std::clamp(r(order[static_cast<std::size_t>(i)]), -4 * fit.scale, 4 * fit.scale);
          sum += e;
          sum2 += e * e;
        }
        const auto n = static_cast<double>(to - from);
        const double mean = sum / n, variance = std::max(sum2 / n - mean * mean, 1e-30);
        const double of_mean = variance * std::max(1.0, fit.inefficiency) / n;
        squares += mean * mean;
        noise += of_mean;
        chi2 += mean * mean / of_mean;
        ++bins;
      }
    }
  }
  if (bins == 0) return;
  const auto n = static_cast<double>(bins);
  fit.lack_of_fit = std::sqrt(std::max(0.0, squares - noise) / n);
  const double degrees = std::max(1.0, n - static_cast<double>(fit.estimates.size()));
  // Five deviations: with a robust loss, the bins' means are not quite those it makes zero.
  fit.lacks_fit = chi2 > degrees + 5 * std::sqrt(2 * degrees) && fit.lack_of_fit > 0.02 * fit.scale;
}

/// σ of samples that were held out. Folds take every so many-th of four times as many blocks.
double CrossValidation(const Shape& shape, const FrictionFitOptions& o, const Sliding& s,
                       const Solution& of_all) {
  const VectorXd velocity = Thinned(s.velocity, 20'000), torque = Thinned(s.torque, 20'000);
  const Index blocks = 4 * o.folds, n = velocity.size();
  if (n < blocks * 2) return kNaN;
  std::vector<double> held_out;
  for (int fold = 0; fold < o.folds; ++fold) {
    std::vector<Index> in, out;
    for (Index k = 0; k < n; ++k) (k * blocks / n % o.folds == fold ? out : in).push_back(k);
    const VectorXd v = velocity(in), y = torque(in), v_out = velocity(out), y_out = torque(out);
    VectorXd x = of_all.x;
    Solve(shape, o.loss, of_all.scale, v, y, x);
    const VectorXd r = Residuals(shape, x, v_out, y_out);
    for (const double e : r) held_out.push_back(std::abs(e));
  }
  return 1.4826 * MedianOf(held_out);
}

/// The mean of what broke away, of one direction or of both.
void AddBreakAway(FrictionFit& fit, const VectorXd& break_away, bool separate) {
  const double b = fit.Find("offset") ? (*fit.Find("offset")).value : 0;
  for (const double sign : {1.0, -1.0}) {
    if (!separate && sign < 0) break;
    const std::string name =
        separate ? (sign > 0 ? "stiction_positive" : "stiction_negative") : "stiction";
    if (fit.Find(name)) continue;
    std::vector<double> level;
    for (const double y : break_away)
      if (!separate || y * sign > 0) level.push_back(std::abs(y - b));
    if (level.empty()) continue;
    const Eigen::Map<const VectorXd> all(level.data(), std::ssize(level));
    const auto n = static_cast<double>(level.size());
    const double mean = all.mean();
    // One alone scatters as any sample does.
    const double of_mean =
        n > 1 ? std::sqrt((all.array() - mean).square().sum() / (n * (n - 1))) : fit.scale;
    const double t = n > 1 ? Student95(n - 1) : kNormal95;
    fit.estimates.push_back({name, mean, of_mean, mean - t * of_mean, mean + t * of_mean});
    const Index p = fit.covariance.rows();
    fit.covariance.conservativeResizeLike(MatrixXd::Zero(p + 1, p + 1));
    fit.covariance(p, p) = of_mean * of_mean;
    std::erase_if(fit.unidentified, [&](const auto& u) { return u.name == name; });
  }
}

FrictionFit FitOf(const FrictionSamples& samples, const FrictionFitOptions& o, bool stribeck) {
  const Shape shape{stribeck, o.separate, o.offset};
  const int p = shape.size();
  FrictionFit fit;
  fit.options = o;
  fit.least_velocity = LeastVelocityOf(samples, o);
  Sliding s = SlidingOf(samples, o);
  fit.samples = s.velocity.size();
  if (fit.samples < 10 * p)
    throw Error("a fit of " + Text(p) + " parameters needs at least " + Text(10 * p) +
                " samples faster than " + Text(fit.least_velocity) + " rad/s, got " +
                Text(fit.samples) + " of " + Text(samples.velocity.size()));
  const Sliding sliding = s;
  if (stribeck && samples.break_away.size() > 0) {
    // Their speed is 0 with the sign of the motion.
    const Index n = s.velocity.size(), m = samples.break_away.size();
    s.velocity.conservativeResize(n + m);
    s.torque.conservativeResize(n + m);
    for (Index k = 0; k < m; ++k) s.velocity(n + k) = std::copysign(0.0, samples.break_away(k));
    s.torque.tail(m) = samples.break_away;
    s.begin.push_back(n);
  }

  const Solution at = SolutionOf(shape, o, s.velocity, s.torque);
  const VectorXd r = Residuals(shape, at.x, s.velocity, s.torque);
  fit.scale = at.scale;
  fit.rms = std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
  fit.outliers = (r.array().abs() > 4 * at.scale).cast<double>().mean();
  const VectorXd psi = r.unaryExpr([&](double e) { return InfluenceOf(o.loss, e / at.scale).psi; });
  const Blocking blocking = BlockingOf(psi, s.begin);
  fit.block = blocking.length;
  fit.inefficiency = o.inefficiency > 0 ? o.inefficiency : std::max(blocking.inefficiency, 1e-3);

  Certainty known = CertaintyOf(shape, o.loss, at, s.velocity, s.torque, s.begin, fit.block);
  const std::vector<std::string> names = shape.names();
  std::vector<std::string> why(static_cast<std::size_t>(p));
  const auto mark = [&](int i, const std::string& reason) {
    known.unknown[static_cast<std::size_t>(i)] = true;
    if (why[static_cast<std::size_t>(i)].empty()) why[static_cast<std::size_t>(i)] = reason;
  };
  const SlidingCount slides = CountOf(sliding);
  for (const double sign : {1.0, -1.0}) {
    const Index count = sign > 0 ? slides.positive : slides.negative;
    const std::string direction = sign > 0 ? "positive direction" : "negative direction";
    const int from = shape.begin(sign);
    if (o.separate && count < kLeastInDirection)
      for (int i = from; i < from + shape.each(); ++i)
        mark(i, count == 0 ? "nothing moves in the " + direction
                           : "only " + Text(count) + " samples slide in the " + direction +
                                 ", it needs " + Text(kLeastInDirection));
    else if (o.separate && IsOneVelocity(sliding, sign))
      for (const int i : {from, from + 1}) mark(i, "there is one velocity only");
  }
  const bool both = slides.both();
  if (o.offset && !both) {
    const std::string reason = "with one direction only, an offset is not told from coulomb";
    for (const double sign : {1.0, -1.0}) {
      mark(shape.begin(sign), reason);
      if (stribeck) mark(shape.begin(sign) + 2, reason);
    }
    mark(p - 1, reason);
  }
  if (!o.separate) {
    // One speed in both directions is one speed.
    Sliding speeds = sliding;
    speeds.raw = sliding.raw.cwiseAbs();
    if (IsOneVelocity(speeds, 1))
      for (const int i : {0, 1}) mark(i, "there is one speed only");
  }
  bool without_stribeck = false;
  for (int d = 0; stribeck && d < (o.separate ? 2 : 1); ++d) {
    const int c = d * shape.each(), e = c + 2, w = c + 3;
    if (known.unknown[static_cast<std::size_t>(c)] && !known.unknown[static_cast<std::size_t>(e)] &&
        !known.unknown[static_cast<std::size_t>(w)])
      continue;
    const double excess = at.x(e) - at.x(c);
    const double deviation = std::sqrt(std::max(
        0.0, known.covariance(e, e) + known.covariance(c, c) - 2 * known.covariance(e, c)));
    double slowest = 1;
    for (Index k = 0; k < sliding.velocity.size(); ++k)
      if (!o.separate || shape.begin(sliding.velocity(k)) == c)
        slowest =
            std::min(slowest, 1 - std::exp(-std::pow(sliding.velocity(k) * std::exp(-at.x(w)), 2)));
    std::string reason;
    if (slowest > 0.95 && samples.break_away.size() == 0)
      reason = "nothing slides slowly enough to see more than coulomb";
    else if (!(std::abs(excess) > 3 * deviation))
      reason =
          "stiction cannot be told from coulomb: s − c = " + Text(std::round(1e4 * excess) / 1e4) +
          " ± " + Text(std::round(1e4 * known.quantile * deviation) / 1e4) + " N·m";
    else if (known.unknown[static_cast<std::size_t>(e)] ||
             known.unknown[static_cast<std::size_t>(w)])
      reason = "the velocities do not tell them apart";
    if (reason.empty()) continue;
    mark(e, reason);
    mark(w, reason);
    without_stribeck = true;
  }
  for (int i = 0; i < p; ++i)
    if (known.unknown[static_cast<std::size_t>(i)] && why[static_cast<std::size_t>(i)].empty())
      mark(i, "the velocities do not tell it from other parameters");

  if (without_stribeck) {
    // What is left is told by the model without it.
    FrictionFit plain = FitOf(samples, o, false);
    for (int i = 0; i < p; ++i)
      if (names[static_cast<std::size_t>(i)].starts_with("sti") ||
          names[static_cast<std::size_t>(i)].starts_with("str"))
        if (!plain.Find(names[static_cast<std::size_t>(i)]))
          plain.unidentified.push_back(
              {names[static_cast<std::size_t>(i)], why[static_cast<std::size_t>(i)].empty()
                                                       ? "the other direction's is not told"
                                                       : why[static_cast<std::size_t>(i)]});
    return plain;
  }

  std::vector<Index> told;
  for (int i = 0; i < p; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (known.unknown[static_cast<std::size_t>(i)]) {
      fit.unidentified.push_back({name, why[static_cast<std::size_t>(i)]});
      continue;
    }
    told.push_back(i);
    const double deviation = std::sqrt(known.covariance(i, i)), t = known.quantile * deviation;
    if (name.starts_with("stribeck")) {
      const double speed = std::exp(at.x(i));
      fit.estimates.push_back(
          {name, speed, speed * deviation, speed * std::exp(-t), speed * std::exp(t)});
    } else {
      fit.estimates.push_back({name, at.x(i), deviation, at.x(i) - t, at.x(i) + t});
    }
  }
  VectorXd scaled = VectorXd::Ones(std::ssize(told));
  for (Index i = 0; i < scaled.size(); ++i)
    if (fit.estimates[static_cast<std::size_t>(i)].name.starts_with("stribeck"))
      scaled(i) = fit.estimates[static_cast<std::size_t>(i)].value;
  fit.covariance = scaled.asDiagonal() * known.covariance(told, told) * scaled.asDiagonal();
  if (!stribeck) AddBreakAway(fit, samples.break_away, o.separate);

  double rho = 0;
  for (const double e : r.head(fit.samples)) rho += InfluenceOf(o.loss, e / at.scale).rho;
  fit.aic = rho / fit.inefficiency + 2 * p;
  fit.bic =
      rho / fit.inefficiency + p * std::log(static_cast<double>(fit.samples) / fit.inefficiency);
  AddLackOfFit(fit, sliding, r);
  if (o.folds > 0 && fit.unidentified.empty())
    fit.cross_validation = CrossValidation(shape, o, sliding, at);
  else if (o.folds > 0)
    fit.cross_validation = kNaN;
  return fit;
}

}  // namespace

double NoiseOf(const VectorXd& samples) {
  std::vector<double> bends;
  for (Index k = 1; k + 1 < samples.size(); ++k)
    bends.push_back(std::abs(samples(k + 1) - 2 * samples(k) + samples(k - 1)));
  return 1.4826 * MedianOf(std::move(bends)) / std::sqrt(6.0);
}

void RequireSound(const FrictionFitOptions& o) {
  Require(o.least_velocity >= 0 && std::isfinite(o.least_velocity), "least_velocity must be ≥ 0",
          o.least_velocity);
  Require(o.folds == 0 || (o.folds >= 2 && o.folds <= 100), "folds must be 0 or from 2 to 100",
          o.folds);
  Require(o.scale >= 0 && std::isfinite(o.scale), "scale must be ≥ 0", o.scale);
  Require(o.inefficiency >= 0 && std::isfinite(o.inefficiency), "inefficiency must be ≥ 0",
          o.inefficiency);
}

double LeastVelocityOf(const FrictionSamples& samples, const FrictionFitOptions& options) {
  if (options.least_velocity > 0) return options.least_velocity;
  return std::max(0.005, 4 * NoiseOf(samples.velocity) / std::sqrt(2.0 * kHalfWindow + 1));
}

Index LeastSamplesOf(const FrictionFitOptions& o) {
  return 10 * Shape{o.model != FrictionModel::CoulombViscous, o.separate, o.offset}.size();
}

bool SlidingCount::both() const {
  return positive >= kLeastInDirection && negative >= kLeastInDirection;
}

SlidingCount CountSliding(const FrictionSamples& samples, const FrictionFitOptions& options) {
  return CountOf(SlidingOf(samples, options));
}

const FrictionEstimate* FrictionFit::Find(std::string_view name) const {
  const auto at = std::ranges::find(estimates, name, &FrictionEstimate::name);
  return at == estimates.end() ? nullptr : &*at;
}

const FrictionEstimate& FrictionFit::operator[](std::string_view name) const {
  if (const FrictionEstimate* estimate = Find(name)) return *estimate;
  for (const Unidentified& u : unidentified)
    if (u.name == name) throw Error("'" + u.name + "' was not identified: " + u.reason);
  throw Error("the fit has no parameter '" + std::string(name) + "'");
}

double FrictionFit::Curve(double velocity) const {
  const std::string behind = !options.separate ? "" : velocity < 0 ? "_negative" : "_positive";
  const FrictionEstimate *c = Find("coulomb" + behind), *d = Find("viscous" + behind),
                         *s = Find("stiction" + behind), *w = Find("stribeck_velocity" + behind);
  if (!c || !d) return kNaN;
  const FrictionParameters p{.coulomb = c->value,
                             .viscous = d->value,
                             .stiction = s && w ? s->value : c->value,
                             .stribeck_velocity = w ? w->value : 1};
  return std::copysign(StribeckCurve(p, velocity), velocity) + p.viscous * velocity;
}

std::optional<FrictionFit::Mean> FrictionFit::MeanOf(const std::string& name) const {
  double values = 0, squares = 0;
  int count = 0;
  for (const char* behind : {"", "_positive", "_negative"})
    if (const FrictionEstimate* e = Find(name + behind)) {
      values += e->value;
      squares += e->deviation * e->deviation;
      ++count;
    }
  if (count == 0) return std::nullopt;
  return Mean{values / count, std::sqrt(squares) / count};
}

IdentifiedFriction FrictionFit::Identified(const std::string& joint) const {
  const auto mean = [&](const std::string& name) -> std::optional<double> {
    const std::optional<Mean> of = MeanOf(name);
    if (!of || of->value < 0) return std::nullopt;
    return of->value;
  };
  IdentifiedFriction of{.joint = joint,
                        .coulomb = mean("coulomb"),
                        .viscous = mean("viscous"),
                        .stiction = mean("stiction"),
                        .stribeck_velocity = mean("stribeck_velocity"),
                        .samples = samples,
                        .residual_deviation = scale,
                        .estimates = estimates,
                        .covariance = covariance};
  // A bristle breaks away at c or above.
  if (of.stiction && of.coulomb) of.stiction = std::max(*of.stiction, *of.coulomb);
  return of;
}

FrictionFit FitFriction(const FrictionSamples& samples, const FrictionFitOptions& options) {
  RequireSound(samples);
  RequireSound(options);
  return FitOf(samples, options, options.model != FrictionModel::CoulombViscous);
}

std::vector<FrictionFit> CompareFriction(const FrictionSamples& samples,
                                         const FrictionFitOptions& options) {
  FrictionFitOptions o = options;
  o.model = FrictionModel::Stribeck;
  const FrictionFit rich = FitFriction(samples, o);
  o.scale = rich.scale;
  o.inefficiency = rich.inefficiency;
  std::vector<FrictionFit> fits;
  for (const FrictionModel model : {FrictionModel::CoulombViscous, FrictionModel::Stribeck}) {
    o.model = model;
    fits.push_back(FitFriction(samples, o));
    fits.back().options.model = model;
  }
  std::ranges::stable_sort(fits, {}, &FrictionFit::bic);
  return fits;
}

FrictionSamples Pooled(const std::vector<FrictionSamples>& joints,
                       const std::vector<FrictionFit>& fits) {
  FrictionSamples all;
  all.begin.clear();
  Index size = 0, broken = 0;
  for (const FrictionSamples& joint : joints) {
    size += joint.velocity.size();
    broken += joint.break_away.size();
  }
  all.velocity.resize(size);
  all.torque.resize(size);
  all.break_away.resize(broken);
  Index at = 0, away = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const FrictionEstimate* offset = j < fits.size() ? fits[j].Find("offset") : nullptr;
    const double b = offset ? offset->value : 0;
    const FrictionSamples& of = joints[j];
    for (const Index begin : of.begin) all.begin.push_back(at + begin);
    all.velocity.segment(at, of.velocity.size()) = of.velocity;
    all.torque.segment(at, of.torque.size()) = of.torque.array() - b;
    all.break_away.segment(away, of.break_away.size()) = of.break_away.array() - b;
    at += of.velocity.size();
    away += of.break_away.size();
  }
  return all;
}

}  // namespace pliant
