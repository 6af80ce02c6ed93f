#include "pliant/analysis/friction_log.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "pliant/analysis/with_unit.h"
#include "pliant/systems/error.h"

namespace pliant {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr Index kMean = 5;
constexpr Index kRest = 20;
const std::string kDriving =
    "friction would drive it; has the torque the sign of the current? An arm that reports what the "
    "link does to the joint wants --torque-unit=-Nm";

constexpr Index kLongRest = 100;

/// The direction of a joint that moves, from the fewest samples from `at` on, forwards or
/// backwards, whose mean is no noise; 0 if it rests.
double DirectionFrom(const VectorXd& velocity, Index at, Index step, Index most, double noise) {
  double sum = 0;
  for (Index m = 1; m <= std::min(most, kLongRest); ++m, at += step) {
    sum += velocity(at);
    const auto count = static_cast<double>(m);
    if (m >= kMean && std::abs(sum) > 4 * noise * std::sqrt(count)) return sum > 0 ? 1 : -1;
  }
  return 0;
}

/// Where the current steps: the first sample of each new level, and the beginnings of files. Where
/// the joint turns back its friction changes sign and the current with it: that is no step.
std::vector<Index> StepsOf(const VectorXd& current, const VectorXd& velocity,
                           const std::vector<Index>& files) {
  const double range = current.maxCoeff() - current.minCoeff();
  const double least = std::max(0.04 * range, 6 * NoiseOf(current) * std::sqrt(2.0 / kMean));
  const double noise = NoiseOf(velocity);
  std::vector<Index> steps(files);
  if (!(range > 0)) return steps;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Index begin = files[i], end = i + 1 < files.size() ? files[i + 1] : current.size();
    const auto jump = [&](Index k) {
      return std::abs(current.segment(k, kMean).mean() - current.segment(k - kMean, kMean).mean());
    };
    for (Index k = begin + kMean; k + kMean <= end; ++k) {
      double greatest = jump(k);
      if (!(greatest > least)) continue;
      // The greatest of the run of samples about a step is where it lies.
      Index at = k;
      for (; k + kMean <= end && jump(k) > least; ++k) {
        if (jump(k) <= greatest) continue;
        at = k;
        greatest = jump(k);
      }
      const double before = DirectionFrom(velocity, at - 1, -1, at - begin, noise),
                   after = DirectionFrom(velocity, at, 1, end - at, noise);
      if (before * after >= 0) steps.push_back(at);
    }
  }
  std::ranges::sort(steps);
  return steps;
}

/// How many samples after a step have not settled.
Index Unsettled(const VectorXd& velocity, double noise) {
  const Index n = velocity.size(), most = 3 * n / 4;
  if (n < 4 * kMean) return most;
  const double last = MedianOf({velocity.end() - n / 4, velocity.end()});
  const auto mean = [&](Index k) { return velocity.segment(k, kMean).mean(); };
  const double near =
      std::max(0.02 * std::abs(last - mean(0)), 4 * noise / std::sqrt(static_cast<double>(kMean)));
  for (Index k = most; k > 0; --k)
    if (std::abs(mean(k - 1) - last) > near) return k;
  return 0;
}

void AddDoubts(FrictionLog& log, const VectorXd& velocity, const VectorXd& current,
               const VectorXd& torque) {
  const double fastest = velocity.cwiseAbs().maxCoeff(), strongest = current.cwiseAbs().maxCoeff(),
               heaviest = torque.cwiseAbs().maxCoeff();
  // The fastest joints of arms turn at some 10 rad/s.
  if (fastest > 15)
    log.doubts.push_back("it turns at up to " + WithUnit(fastest, "rad/s") +
                         "; is the velocity in deg/s? Then give --velocity-unit deg/s (" +
                         WithUnit(fastest * std::numbers::pi / 180, "rad/s") + ")");
  if (fastest < 1e-3)
    log.doubts.push_back("it hardly moves, " + WithUnit(fastest, "rad/s") +
                         " at most; is this the column of the velocity?");
  if (strongest > 100)
    log.doubts.push_back("its current is up to " + WithUnit(strongest, "A") +
                         "; is it in mA? Then give --current-unit mA");
  if (heaviest > 1000)
    log.doubts.push_back("its torque is up to " + WithUnit(heaviest, "N·m") +
                         "; is it in mN·m? Then give --torque-unit mNm");
  const FrictionSamples& s = log.samples;
  double along = 0, size = 0;
  for (Index k = 0; k < s.velocity.size(); ++k) {
    along += s.torque(k) * s.velocity(k);
    size += std::abs(s.torque(k) * s.velocity(k));
  }
  if (along < -0.2 * size) log.doubts.push_back(kDriving);
}

}  // namespace

FrictionLog FrictionOf(const Samples& samples, Index row, const DriveFigures& drive,
                       double least_velocity) {
  FrictionLog log{.joint = samples.joints[static_cast<std::size_t>(row)], .samples = {}};
  const VectorXd velocity = samples.velocity.row(row), current = samples.current.row(row),
                 torque = samples.torque.row(row);
  const Index n = velocity.size();
  VectorXd y = drive.torque_per_ampere * current - torque;
  if (samples.acceleration.size() > 0 && drive.reflected_inertia != 0)
    y -= drive.reflected_inertia * samples.acceleration.row(row).transpose();
  const double noise = NoiseOf(velocity);
  const double least = least_velocity > 0 ? least_velocity : std::max(0.005, 4 * noise);

  const std::vector<Index> steps = StepsOf(current, velocity, samples.begin);
  log.steps = std::ssize(steps) - std::ssize(samples.begin);
  std::vector<bool> keep(static_cast<std::size_t>(n), true), stepped(keep.size(), false);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Index from = steps[i], to = i + 1 < steps.size() ? steps[i + 1] : n;
    for (Index k = std::max<Index>(0, from - kRest); k < std::min(n, from + kRest); ++k)
      stepped[static_cast<std::size_t>(k)] = true;
    if (log.steps == 0) continue;
    const Index drop = Unsettled(velocity.segment(from, to - from), noise);
    std::fill_n(keep.begin() + from, drop, false);
    log.transient += drop;
  }

  std::vector<Index> kept;
  log.samples.begin.clear();
  for (Index k = 0; k < n; ++k) {
    if (!keep[static_cast<std::size_t>(k)]) continue;
    const bool starts = std::ranges::find(samples.begin, k) != samples.begin.end();
    if (kept.empty() || kept.back() != k - 1 || starts)
      log.samples.begin.push_back(std::ssize(kept));
    kept.push_back(k);
  }
  log.samples.velocity = velocity(kept);
  log.samples.torque = y(kept);

  std::vector<double> away;
  Index resting = 0;
  std::size_t files = 0;
  for (Index k = 0; k + kMean <= n; ++k) {
    if (files < samples.begin.size() && samples.begin[files] <= k) {
      resting = 0;
      ++files;
    }
    if (std::abs(velocity(k)) < least) {
      ++resting;
      continue;
    }
    const VectorXd after = velocity.segment(k, kMean);
    const bool moves = (after.array() > least).all() || (after.array() < -least).all();
    if (moves && resting >= kRest && !stepped[static_cast<std::size_t>(k)]) {
      const double level = y.segment(k - kMean, kMean).mean();
      if (level * velocity(k) > 0) away.push_back(level);
    }
    resting = 0;
  }
  log.samples.break_away = VectorXd::Map(away.data(), std::ssize(away));
  AddDoubts(log, velocity, current, torque);
  return log;
}

}  // namespace pliant
