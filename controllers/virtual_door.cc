#include "pliant/controllers/virtual_door.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/controllers/frame_force.h"
#include "pliant/plants/hunt_crossley.h"
#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// n, once all is checked that can be wrong.
Vector3d AxisOf(const VirtualDoor::Options& o) {
  constexpr double kLeastRadius = 1e-3;
  RequireInRange("", o);
  RequireEachInRange("hinge", o.hinge, "m", kAnyNumber);
  RequireEachInRange("center", o.center, "m", kAnyNumber);
  RequireEachInRange("gravity", o.gravity, "m/s²", kAnyNumber);
  Require(o.axis.allFinite() && o.axis.norm() > 0, "axis must be finite and not zero",
          o.axis.transpose());
  const Eigen::Matrix3d& R = o.closed.rotation;
  Require(
      o.closed.position.allFinite() && (R * R.transpose()).isIdentity(1e-8) && R.determinant() > 0,
      "closed must be a pose: finite, R Rᵀ = I, det R = 1, got\n" + Text(R));
  if (o.stops)
    Require(o.stops->lower < o.stops->upper,
            "stops.lower must be below stops.upper = " + Text(o.stops->upper) + " rad",
            Text(o.stops->lower) + " rad");
  const Vector3d n = o.axis.normalized();
  const double radius = n.cross(Vector3d(o.closed.position - o.hinge)).norm();
  Require(radius >= kLeastRadius,
          "the closed door's handle must be at least 0.001 m from the axis of the hinge",
          Text(radius) + " m");
  return n;
}

Vector3d AlongRadius(const VirtualDoor::Options& o, const Vector3d& n) {
  const Vector3d r = o.closed.position - o.hinge;
  return (r - n.dot(r) * n).normalized();
}

}  // namespace

VirtualDoor::VirtualDoor(const Options& o)
    : frame{this, "frame"},
      dynamics{this, "dynamics", o.joints},
      external_acceleration{this, "external_acceleration", o.joints,
                            JointAcceleration::Zero(o.joints)},
      mobility{this, "mobility", {}, TaskMatrix::Zero(6, 6)},
      door{this, "door"},
      pose{this, "pose"},
      twist{this, "twist"},
      acceleration{this, "acceleration"},
      o_{o},
      n_{AxisOf(o)},
      u_{AlongRadius(o, n_)},
      w_{n_.cross(u_)},
      handle_{this, "handle"} {
  Compute(door).From(frame, dynamics, external_acceleration).As(&VirtualDoor::Swing);
  Compute(handle_).From(door).As(&VirtualDoor::Handle);
  Compute(pose).From(handle_).As([](const PoseMotion& m) { return m.pose; });
  Compute(twist).From(handle_).As([](const PoseMotion& m) { return m.twist; });
  Compute(acceleration).From(handle_).As([](const PoseMotion& m) { return m.acceleration; });
  Compute(mobility).From(door).As(&VirtualDoor::Mobility);
}

DoorMotion VirtualDoor::Swing(const FrameDynamics& tool, const RobotDynamics& d,
                              const JointAcceleration& qdd_e) const {
  const Vector3d from_hinge = tool.pose.position - o_.hinge, v = tool.twist.tail<3>();
  const double x = u_.dot(from_hinge), y = w_.dot(from_hinge), square = x * x + y * y;
  DoorMotion now;
  now.angle = std::atan2(y, x);
  // On the axis itself there is no angle, and no rate.
  now.rate = square > 0 ? (x * w_.dot(v) - y * u_.dot(v)) / square : 0;
  now.external = Screw(now.angle).dot(FrameForce(d, tool, qdd_e, o_.inertia_limit));
  now.passive = Passive(now.angle, now.rate);
  const double torque = now.external + now.passive;
  now.friction =
      std::clamp(o_.inertia * now.rate / o_.stopping_time + torque, -o_.coulomb, o_.coulomb);
  now.acceleration = (torque - now.friction) / o_.inertia;
  return now;
}

double VirtualDoor::Passive(double theta, double rate) const {
  const Vector3d weight = o_.mass * o_.gravity, arm = Turned(theta, o_.center) - o_.hinge;
  double tau = -o_.closer * (theta - o_.rest_angle) + n_.dot(arm.cross(weight)) - o_.viscous * rate;
  if (o_.stops) {
    const auto& [lower, upper, k, c] = *o_.stops;
    tau += HuntCrossleyForce(k, c, lower - theta, -rate) -
           HuntCrossleyForce(k, c, theta - upper, rate);
  }
  return tau;
}

PoseMotion VirtualDoor::Handle(const DoorMotion& now) const {
  const Vector6 s = Screw(now.angle);
  const Vector3d toward = n_.cross(Vector3d(s.tail<3>()));  // the hinge, as long as the radius
  PoseMotion handle;
  handle.pose.position = Turned(now.angle, o_.closed.position);
  handle.pose.rotation = AngleAxisd(now.angle, n_).toRotationMatrix() * o_.closed.rotation;
  handle.twist = s * now.rate;
  handle.acceleration = s * ((now.passive - now.friction) / o_.inertia);
  handle.acceleration.tail<3>() += now.rate * now.rate * toward;
  return handle;
}

TaskMatrix VirtualDoor::Mobility(const DoorMotion& now) const {
  const Vector6 s = Screw(now.angle);
  return s * s.transpose() / o_.inertia;
}

/// Where a point of the closed door is.
Vector3d VirtualDoor::Turned(double theta, const Vector3d& point) const {
  return o_.hinge + AngleAxisd(theta, n_) * Vector3d(point - o_.hinge);
}

/// s.
Vector6 VirtualDoor::Screw(double theta) const {
  Vector6 s;
  s << n_, n_.cross(Vector3d(Turned(theta, o_.closed.position) - o_.hinge));
  return s;
}

}  // namespace pliant
