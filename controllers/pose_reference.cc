#include "pliant/controllers/pose_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>

#include "pliant/controllers/course.h"
#include "pliant/controllers/rotation.h"

namespace pliant {

namespace {

using Eigen::Vector3d;
using internal::Course;
using internal::LeastJerk;

/// s of the way d and the turn φ from X.
PoseMotion Along(const Pose& X, const Vector3d& d, const Vector3d& phi, const Course& c) {
  PoseMotion motion;
  const double angle = phi.norm();
  const Vector3d axis = angle > 0 ? Vector3d(phi / angle) : Vector3d::UnitX();
  motion.pose.position = X.position + c.s * d;
  motion.pose.rotation = Eigen::AngleAxisd(c.s * angle, axis).toRotationMatrix() * X.rotation;
  motion.twist << c.rate * phi, c.rate * d;
  motion.acceleration << c.acceleration * phi, c.acceleration * d;
  return motion;
}

void RequirePose(const Pose& X) {
  Require(X.position.allFinite(), "a position must be finite", X.position.transpose());
  Require((X.rotation * X.rotation.transpose()).isIdentity(1e-8) && X.rotation.determinant() > 0,
          "a rotation must have R Rᵀ = I, det R = 1, got\n" + Text(X.rotation));
}

/// Throws unless they are in order of time, and neighbours no further apart than `most`.
void RequireTimedPoses(const std::string& name, const std::vector<TimedPose>& poses, double most,
                       const std::string& apart) {
  Require(!poses.empty(), name + " must have at least one");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    RequirePose(poses[i].pose);
    RequireInRange("", "time_s", poses[i].time_s, "s", kAnyNumber);
    if (i == 0) continue;
    const TimedPose &a = poses[i - 1], &b = poses[i];
    Require(a.time_s < b.time_s, name + " are in order of time: behind " + Text(a.time_s) + " s",
            Text(b.time_s) + " s");
    const double angle = internal::Log(b.pose.rotation * a.pose.rotation.transpose()).norm();
    Require(angle <= most, "neighbouring " + name + " are " + apart + " apart",
            Text(angle) + " rad");
  }
}

Vector3d RadiusOf(const PoseCircle::Options& o) { return o.start.position - o.center; }

}  // namespace

PoseReference::PoseReference() {
  Compute(pose).From(motion_).As([](const PoseMotion& m) { return m.pose; });
  Compute(twist).From(motion_).As([](const PoseMotion& m) { return m.twist; });
  Compute(acceleration).From(motion_).As([](const PoseMotion& m) { return m.acceleration; });
}

template <class Path>
PoseMotion PoseReference::InTime(double t, const PathTime& phi, const Path& path) {
  if (phi.by_clock) return path(t);
  PoseMotion motion = path(phi.phase);
  motion.acceleration = phi.rate * phi.rate * motion.acceleration + phi.acceleration * motion.twist;
  motion.twist *= phi.rate;
  return motion;
}

PoseWaypoints::PoseWaypoints(const Options& o) : waypoints_{o.waypoints} {
  RequireTimedPoses("waypoints", waypoints_, std::numbers::pi - 1e-6, "less than half a turn");
  RequireInRange("", "laps", o.laps, "", Between(1, 100'000));
  const Waypoint &first = o.waypoints.front(), &last = o.waypoints.back();
  Require(o.laps == 1 || (last.time_s > first.time_s && last.pose.position == first.pose.position &&
                          last.pose.rotation == first.pose.rotation),
          "with laps the last waypoint must be at the pose of the first, and later");
  for (int lap = 1; lap < o.laps; ++lap)
    for (Waypoint next : o.waypoints | std::views::drop(1)) {
      next.time_s += lap * (last.time_s - first.time_s);
      waypoints_.push_back(next);
    }
  Compute(motion_).From(clock, phase).As(&PoseWaypoints::Move);
}

PoseMotion PoseWaypoints::Move(double t, const PathTime& phi) const {
  return InTime(t, phi, [this](double s) { return At(s); });
}

PoseMotion PoseWaypoints::At(double t) const {
  const auto after = std::ranges::upper_bound(waypoints_, t, {}, &Waypoint::time_s);
  const Waypoint& b = after == waypoints_.end() ? waypoints_.back() : *after;
  const Waypoint& a = after == waypoints_.begin() ? b : *std::prev(after);
  const double T = b.time_s > a.time_s ? b.time_s - a.time_s : 1;
  return Along(a.pose, b.pose.position - a.pose.position,
               internal::Log(b.pose.rotation * a.pose.rotation.transpose()),
               LeastJerk(t - a.time_s, T));
}

PoseTable::PoseTable(const Options& o) {
  const std::vector<TimedPose>& rows = o.rows;
  RequireTimedPoses("rows", rows, std::numbers::pi / 2 + 1e-6, "at most a quarter turn");
  std::vector<Vector7> x;
  for (const TimedPose& row : rows) {
    times_.push_back(row.time_s);
    Vector7 now;
    now << row.pose.position, Eigen::Quaterniond(row.pose.rotation).coeffs();
    // Of the two quaternions of a rotation the one on this side.
    if (!x.empty() && now.tail<4>().dot(x.back().tail<4>()) < 0) now.tail<4>() *= -1;
    x.push_back(now);
  }
  const std::size_t n = x.size();
  std::vector<Vector7> rate(n, Vector7::Zero()), second(n, Vector7::Zero());
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h = times_[i] - times_[i - 1], next = times_[i + 1] - times_[i];
    const Vector7 d = (x[i] - x[i - 1]) / h, d_next = (x[i + 1] - x[i]) / next;
    rate[i] = (h * d_next + next * d) / (h + next);
    second[i] = 2 * (d_next - d) / (h + next);
  }
  for (std::size_t i = 0; i < n; ++i) {
    Quintic c = Quintic::Zero();
    c.col(0) = x[i];
    if (i + 1 < n) {
      const double T = times_[i + 1] - times_[i];
      const Vector7 v0 = rate[i] * T, v1 = rate[i + 1] * T;
      const Vector7 a0 = second[i] * T * T, a1 = second[i + 1] * T * T;
      const Vector7 p = x[i + 1] - x[i] - v0 - 0.5 * a0, v = v1 - v0 - a0, a = a1 - a0;
      c.col(1) = v0 / T;
      c.col(2) = 0.5 * a0 / std::pow(T, 2);
      c.col(3) = (10 * p - 4 * v + 0.5 * a) / std::pow(T, 3);
      c.col(4) = (-15 * p + 7 * v - a) / std::pow(T, 4);
      c.col(5) = (6 * p - 3 * v + 0.5 * a) / std::pow(T, 5);
      for (int k = 1; k < 64; ++k) {
        Vector7 between = c.col(5);
        for (int j = 4; j >= 0; --j) between = c.col(j) + between * (T * k / 64);
        // A way that leaves the unit quaternions that far turns elsewhere on it.
        const double length = between.tail<4>().norm();
        Require(length > 0.5 && length < 2, "rows are too uneven in time to turn between " +
                                                Text(times_[i]) + " s and " + Text(times_[i + 1]) +
                                                " s: add rows between");
      }
    }
    pieces_.push_back(c);
  }
  Compute(motion_).From(clock, phase).As(&PoseTable::Move);
}

PoseMotion PoseTable::Move(double t, const PathTime& phi) const {
  return InTime(t, phi, [this](double s) { return At(s); });
}

PoseMotion PoseTable::At(double t) const {
  const auto after = std::ranges::upper_bound(times_, t);
  const std::size_t i =
      after == times_.begin() ? 0 : static_cast<std::size_t>(after - times_.begin()) - 1;
  const Quintic& c = pieces_[i];
  const double s = std::max(0.0, t - times_[i]);
  Vector7 x = c.col(5), rate = 5 * c.col(5), second = 20 * c.col(5);
  for (int j = 4; j >= 0; --j) x = c.col(j) + s * x;
  for (int j = 4; j >= 1; --j) rate = j * c.col(j) + s * rate;
  for (int j = 4; j >= 2; --j) second = j * (j - 1) * c.col(j) + s * second;

  // With u = q/‖q‖: ω = 2 u̇ ū, of which ‖q‖ changes the real part alone.
  const Eigen::Quaterniond q(x.tail<4>()), dq(rate.tail<4>()), ddq(second.tail<4>());
  const double length = q.squaredNorm();
  const Vector3d w = 2 / length * (dq * q.conjugate()).vec();
  const Vector3d alpha =
      2 / length * (ddq * q.conjugate()).vec() - 2 * rate.tail<4>().dot(x.tail<4>()) / length * w;
  PoseMotion motion;
  motion.pose = {x.head<3>(), q.normalized().toRotationMatrix()};
  motion.twist << w, rate.head<3>();
  motion.acceleration << alpha, second.head<3>();
  return motion;
}

PoseSwing::PoseSwing(const Options& o) : o_{o} {
  RequirePose(o.start);
  Require(o.way.allFinite() && o.turn.allFinite(), "way and turn must be finite");
  RequireInRange("", "frequency_hz", o.frequency_hz, "Hz", kPositive);
  RequireInRange("", "start_s", o.start_s, "s", kAnyNumber);
  Compute(motion_).From(clock, phase).As(&PoseSwing::Move);
}

PoseMotion PoseSwing::Move(double t, const PathTime& phi) const {
  return InTime(t, phi, [this](double s) { return At(s); });
}

PoseMotion PoseSwing::At(double t) const {
  return Along(o_.start, o_.way, o_.turn, internal::Swing(t - o_.start_s, o_.frequency_hz));
}

PoseCircle::PoseCircle(const Options& o)
    : o_{o}, radius_{RadiusOf(o)}, normal_{o.normal.normalized()} {
  RequirePose(o.start);
  Require(o.normal.allFinite() && o.normal.norm() > 0, "normal must be finite and not zero",
          o.normal.transpose());
  Require(
      radius_.allFinite() && std::abs(normal_.dot(radius_)) <= 1e-9 * radius_.norm(),
      "normal must be perpendicular to the way from center to start, " + Text(radius_.transpose()),
      o.normal.transpose());
  RequireInRange("", "speed", o.speed, "rad/s", kAnyNumber);
  RequireInRange("", "rise_s", o.rise_s, "s", kPositive);
  RequireInRange("", "start_s", o.start_s, "s", kAnyNumber);
  Compute(motion_).From(clock, phase).As(&PoseCircle::Move);
}

PoseMotion PoseCircle::Move(double t, const PathTime& phi) const {
  return InTime(t, phi, [this](double s) { return At(s); });
}

PoseMotion PoseCircle::At(double t) const {
  const double T = o_.rise_s, x = std::clamp((t - o_.start_s) / T, 0.0, 1.0);
  const Course rise = LeastJerk(t - o_.start_s, T);
  // ∫ of the rise, and steadily on from there.
  const double steady = std::max(0.0, t - o_.start_s - T);
  const double theta = o_.speed * (T * x * x * x * x * (2.5 + x * (-3 + x)) + steady);
  const double rate = o_.speed * rise.s, acceleration = o_.speed * rise.rate;
  const Vector3d out = radius_ * std::cos(theta) + normal_.cross(radius_) * std::sin(theta);
  const Vector3d along = normal_.cross(out);
  PoseMotion motion;
  motion.pose = {o_.center + out, o_.start.rotation};
  motion.twist << Vector3d::Zero(), rate * along;
  motion.acceleration << Vector3d::Zero(), acceleration * along - rate * rate * out;
  return motion;
}

}  // namespace pliant
