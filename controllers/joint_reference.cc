#include "pliant/controllers/joint_reference.h"

#include <algorithm>

#include "pliant/controllers/course.h"
#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using internal::Course;

/// s of the way d from q, of a course in φ.
JointMotion Along(const JointPosition& q, const PerJoint& d, const Course& c, const PathTime& phi) {
  if (phi.by_clock) return {q + c.s * d, c.rate * d, c.acceleration * d};
  return {q + c.s * d, c.rate * phi.rate * d,
          (c.acceleration * phi.rate * phi.rate + c.rate * phi.acceleration) * d};
}

double TimeOf(double t, const PathTime& phi) { return phi.by_clock ? t : phi.phase; }

const JointPosition& First(const std::vector<JointWaypoints::Waypoint>& waypoints) {
  Require(!waypoints.empty(), "waypoints must have at least one");
  return waypoints.front().position;
}

}  // namespace

JointReference::JointReference(const Joints& joints, const JointPosition& start)
    : phase{this, "phase", {}, PathTime{}},
      position{this, "position", joints},
      velocity{this, "velocity", joints},
      acceleration{this, "acceleration", joints},
      motion_{this, "motion", joints,
              JointMotion{start, JointVelocity::Zero(joints), JointAcceleration::Zero(joints)}} {
  Compute(position).From(motion_).As([](const JointMotion& m) { return m.position; });
  Compute(velocity).From(motion_).As([](const JointMotion& m) { return m.velocity; });
  Compute(acceleration).From(motion_).As([](const JointMotion& m) { return m.acceleration; });
}

JointWaypoints::JointWaypoints(const Options& o)
    : JointReference{o.joints, First(o.waypoints)}, waypoints_{o.waypoints} {
  for (std::size_t i = 0; i < waypoints_.size(); ++i) {
    const Waypoint& b = waypoints_[i];
    RequireEachInRange("position", b.position, "rad", kAnyNumber, o.joints);
    RequireInRange("", "time_s", b.time_s, "s", kAnyNumber);
    if (i == 0) continue;
    Require(waypoints_[i - 1].time_s < b.time_s,
            "waypoints are in order of time: behind " + Text(waypoints_[i - 1].time_s) + " s",
            Text(b.time_s) + " s");
  }
  Compute(motion_).From(clock, phase).As(&JointWaypoints::Move);
}

JointMotion JointWaypoints::Move(double t, const PathTime& phi) const {
  const double s = TimeOf(t, phi);
  const auto after = std::ranges::upper_bound(waypoints_, s, {}, &Waypoint::time_s);
  const Waypoint& b = after == waypoints_.end() ? waypoints_.back() : *after;
  const Waypoint& a = after == waypoints_.begin() ? b : *std::prev(after);
  const double T = b.time_s > a.time_s ? b.time_s - a.time_s : 1;
  return Along(a.position, b.position - a.position, internal::LeastJerk(s - a.time_s, T), phi);
}

JointSwing::JointSwing(const Options& o) : JointReference{o.joints, o.start}, o_{o} {
  RequireEachInRange("start", o.start, "rad", kAnyNumber, o.joints);
  RequireEachInRange("way", o.way, "rad", kAnyNumber, o.joints);
  RequireInRange("", "frequency_hz", o.frequency_hz, "Hz", kPositive);
  RequireInRange("", "start_s", o.start_s, "s", kAnyNumber);
  Compute(motion_).From(clock, phase).As(&JointSwing::Move);
}

JointMotion JointSwing::Move(double t, const PathTime& phi) const {
  return Along(o_.start, o_.way, internal::Swing(TimeOf(t, phi) - o_.start_s, o_.frequency_hz),
               phi);
}

}  // namespace pliant
