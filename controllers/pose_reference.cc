#include "pliant/controllers/pose_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant {

namespace {

using Eigen::Vector3d;

/// A number and its first two rates.
struct Course {
  double s, rate, acceleration;
};

/// 10 x³ − 15 x⁴ + 6 x⁵ of x = t/T, held at both ends.
Course LeastJerk(double t, double T) {
  const double x = std::clamp(t / T, 0.0, 1.0);
  return {x * x * x * (10 + x * (-15 + 6 * x)), 30 * x * x * (1 - x) * (1 - x) / T,
          60 * x * (1 - x) * (1 - 2 * x) / (T * T)};
}

Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

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

Vector3d RadiusOf(const PoseCircle::Options& o) { return o.start.position - o.center; }

}  // namespace

PoseReference::PoseReference() {
  Compute(pose).From(motion_).As([](const PoseMotion& m) { return m.pose; });
  Compute(twist).From(motion_).As([](const PoseMotion& m) { return m.twist; });
  Compute(acceleration).From(motion_).As([](const PoseMotion& m) { return m.acceleration; });
}

PoseWaypoints::PoseWaypoints(const Options& o) : waypoints_{o.waypoints} {
  Require(!waypoints_.empty(), "waypoints must have at least one");
  for (std::size_t i = 0; i < waypoints_.size(); ++i) {
    RequirePose(waypoints_[i].pose);
    RequireInRange("", "time_s", waypoints_[i].time_s, "s", kAnyNumber);
    if (i == 0) continue;
    const Waypoint &a = waypoints_[i - 1], &b = waypoints_[i];
    Require(a.time_s < b.time_s, "waypoints are in order of time: behind " + Text(a.time_s) + " s",
            Text(b.time_s) + " s");
    const double angle = Log(b.pose.rotation * a.pose.rotation.transpose()).norm();
    Require(angle < std::numbers::pi - 1e-6,
            "neighbouring waypoints are less than half a turn apart", Text(angle) + " rad");
  }
  Compute(motion_).From(clock).As(&PoseWaypoints::At);
}

PoseMotion PoseWaypoints::At(double t) const {
  const auto after = std::ranges::upper_bound(waypoints_, t, {}, &Waypoint::time_s);
  const Waypoint& b = after == waypoints_.end() ? waypoints_.back() : *after;
  const Waypoint& a = after == waypoints_.begin() ? b : *std::prev(after);
  const double T = b.time_s > a.time_s ? b.time_s - a.time_s : 1;
  return Along(a.pose, b.pose.position - a.pose.position,
               Log(b.pose.rotation * a.pose.rotation.transpose()), LeastJerk(t - a.time_s, T));
}

PoseSwing::PoseSwing(const Options& o) : o_{o} {
  RequirePose(o.start);
  Require(o.way.allFinite() && o.turn.allFinite(), "way and turn must be finite");
  RequireInRange("", "frequency_hz", o.frequency_hz, "Hz", kPositive);
  RequireInRange("", "start_s", o.start_s, "s", kAnyNumber);
  Compute(motion_).From(clock).As(&PoseSwing::At);
}

PoseMotion PoseSwing::At(double t) const {
  const double w = 2 * std::numbers::pi * o_.frequency_hz, T = t - o_.start_s;
  const Course course = T < 0 ? Course{0, 0, 0}
                              : Course{0.5 * (1 - std::cos(w * T)), 0.5 * w * std::sin(w * T),
                                       0.5 * w * w * std::cos(w * T)};
  return Along(o_.start, o_.way, o_.turn, course);
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
  Compute(motion_).From(clock).As(&PoseCircle::At);
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
