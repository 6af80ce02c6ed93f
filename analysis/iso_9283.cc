#include "pliant/analysis/iso_9283.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pliant/analysis/signal_number.h"
#include "pliant/controllers/rotation.h"
#include "pliant/systems/error.h"
#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

/// x̄ + 3 S of numbers.
double MeanAndThreeDeviations(const Eigen::VectorXd& x) {
  return x.mean() +
         3 * std::sqrt((x.array() - x.mean()).square().sum() / static_cast<double>(x.size() - 1));
}

/// l̄ + 3 S_l of the distances of points, in columns, from their mean.
double RepeatabilityOf(const Eigen::Matrix3Xd& points) {
  return MeanAndThreeDeviations(Norms(points.colwise() - points.rowwise().mean()));
}

/// A position over time, straight between rows.
Eigen::Vector3d At(const Eigen::VectorXd& times, const Series& x, double t) {
  const Eigen::Index after = std::clamp<Eigen::Index>(
      std::lower_bound(times.begin(), times.end(), t) - times.begin(), 1, times.size() - 1);
  const double part = (t - times(after - 1)) / (times(after) - times(after - 1));
  return x.col(after - 1) + part * (x.col(after) - x.col(after - 1));
}

/// Where attained positions go through the plane through c across u, in the direction of u, nearest
/// to the time t and within `window` of it.
std::optional<Eigen::Vector3d> Crossing(const Eigen::VectorXd& times, const Series& attained,
                                        const Eigen::Vector3d& c, const Eigen::Vector3d& u,
                                        double t, double window) {
  const Eigen::Index begin = std::max<Eigen::Index>((times.array() < t - window).count(), 1);
  const Eigen::Index end = (times.array() <= t + window).count();
  std::optional<Eigen::Vector3d> nearest;
  double nearest_s = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = begin; k < end; ++k) {
    const double before = u.dot(attained.col(k - 1) - c), behind = u.dot(attained.col(k) - c);
    if (!(before <= 0 && behind > 0)) continue;
    const double part = before / (before - behind);
    const double off = std::abs(times(k - 1) + part * (times(k) - times(k - 1)) - t);
    if (off >= nearest_s) continue;
    nearest_s = off;
    nearest = attained.col(k - 1) + part * (attained.col(k) - attained.col(k - 1));
  }
  return nearest;
}

}  // namespace

PoseAccuracy PoseAccuracyOf(const std::vector<Pose>& attained, const Pose& commanded) {
  const Eigen::Index n = std::ssize(attained);
  Require(n >= 2, "the accuracy of a pose is of at least 2 visits", n);
  Eigen::Matrix3Xd positions(3, n), turns(3, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Pose& pose = attained[static_cast<std::size_t>(j)];
    positions.col(j) = pose.position;
    turns.col(j) = internal::Log(pose.rotation * commanded.rotation.transpose());
  }
  PoseAccuracy of;
  of.position = (positions.rowwise().mean() - commanded.position).norm();
  of.position_repeatability = RepeatabilityOf(positions);
  const Eigen::Vector3d mean = turns.rowwise().mean();
  of.rotation = mean.cwiseAbs();
  of.rotation_repeatability =
      3 * ((turns.colwise() - mean).array().square().rowwise().sum() / static_cast<double>(n - 1))
              .sqrt()
              .matrix();
  return of;
}

PathAccuracy PathAccuracyOf(const Eigen::VectorXd& times, const Series& commanded,
                            const Series& attained, const Rounds& rounds) {
  Require(rounds.count >= 2, "the accuracy of a path is of at least 2 rounds", rounds.count);
  Require(rounds.period_s > 0, "the period of a round must be > 0", rounds.period_s);
  const double to_s = rounds.from_s + rounds.count * rounds.period_s;
  Require(times.size() >= 2 && times(0) <= rounds.from_s && to_s <= times(times.size() - 1) + 1e-9,
          "the rounds, from " + Text(rounds.from_s) + " s to " + Text(to_s) +
              " s, must lie within the times that there are",
          times.size() == 0 ? "none"
                            : Text(times(0)) + " s to " + Text(times(times.size() - 1)) + " s");

  // The path, at equal parts of a round: fine enough that a point more changes nothing to see.
  constexpr int kPoints = 200;
  const double step = rounds.period_s / kPoints;
  Eigen::Matrix3Xd points(3, kPoints), velocities(3, kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const double t = rounds.from_s + (i + 0.5) * step;
    points.col(i) = At(times, commanded, t);
    velocities.col(i) =
        (At(times, commanded, t + 0.5 * step) - At(times, commanded, t - 0.5 * step)) / step;
  }
  const Eigen::VectorXd speeds = Norms(velocities);
  const double fastest = Largest(speeds);
  Require(std::isfinite(fastest), "what is commanded must be finite");
  Require(fastest > 0, "the accuracy of a path is of one along which something is to move");

  // A tool that is nowhere follows nothing.
  const RowsBetween seen(times, rounds.from_s - 0.25 * rounds.period_s,
                         to_s + 0.25 * rounds.period_s);
  if (!attained.middleCols(seen.begin, seen.size()).allFinite())
    return {.accuracy = kUnbounded, .repeatability = kUnbounded, .points = 0};

  PathAccuracy of;
  for (int i = 0; i < kPoints; ++i) {
    if (speeds(i) < 0.5 * fastest) continue;
    ++of.points;
    Eigen::Matrix3Xd passed(3, rounds.count);
    bool all = true;
    for (int j = 0; j < rounds.count && all; ++j) {
      const double t = rounds.from_s + (i + 0.5) * step + j * rounds.period_s;
      const auto at =
          Crossing(times, attained, points.col(i), velocities.col(i), t, 0.25 * rounds.period_s);
      all = at.has_value();
      if (at) passed.col(j) = *at;
    }
    of.accuracy =
        std::max(of.accuracy, all ? (passed.rowwise().mean() - points.col(i)).norm() : kUnbounded);
    of.repeatability = std::max(of.repeatability, all ? RepeatabilityOf(passed) : kUnbounded);
  }
  return of;
}

}  // namespace pliant
