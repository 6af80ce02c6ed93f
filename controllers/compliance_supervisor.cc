#include "pliant/controllers/compliance_supervisor.h"

#include <algorithm>
#include <cmath>

#include "pliant/controllers/rotation.h"
#include "pliant/systems/elements.h"

namespace pliant {

namespace {

enum : int { kPoseStiffness, kPoseDamping, kPoseCompliance, kStiffness, kDamping, kCompliance };

Vector6 Numbers(const ComplianceGains& g) {
  Vector6 numbers;
  numbers << g.pose_stiffness, g.pose_damping, g.pose_compliance, g.posture_stiffness,
      g.posture_damping, g.posture_compliance;
  return numbers;
}

TaskVector Same(double x) { return TaskVector::Constant(6, x); }

/// [log(R R°ᵀ); p − p°]
Vector6 Away(const Pose& X, const Pose& target) {
  Vector6 e;
  e << internal::Log(X.rotation * target.rotation.transpose()), X.position - target.position;
  return e;
}

}  // namespace

ComplianceSupervisor::ComplianceSupervisor(const Options& o)
    : mode{this, "mode", {}, ComplianceMode::NullSpace},
      dynamic{this, "dynamic", {}, false},
      brakes{this, "brakes", {}, false},
      contact{this, "contact", {}, Wrench()},
      tool{this, "tool"},
      yields{this, "yields"},
      target{this, "target"},
      target_twist{this, "target_twist"},
      target_acceleration{this, "target_acceleration"},
      pose_stiffness{this, "pose_stiffness", {}, Same(0)},
      pose_damping{this, "pose_damping", {}, Same(0)},
      pose_compliance{this, "pose_compliance", {}, TaskMatrix::Zero(6, 6)},
      posture_stiffness{this, "posture_stiffness", {}, PerJoint::Zero(o.joints)},
      posture_damping{this, "posture_damping", {}, PerJoint::Zero(o.joints)},
      posture_compliance{this, "posture_compliance", {}, JointMatrix::Zero(o.joints, o.joints)},
      o_{o},
      h_{seconds(o.period)},
      memory_{this, "memory"} {
  RequireInRange("", o);
  Require(o.joints > 0 && o.joints <= kMaxJoints, "joints must be from 1 to " + Text(kMaxJoints),
          o.joints);
  Require(o.leave < o.enter, "leave must be below enter, " + Text(o.enter) + " N", o.leave);
  RequireEachInRange("swing", o.swing, "m", kAnyNumber);
  Every(o.period)
      .Compute(memory_)
      .From(memory_, mode, dynamic, brakes, contact, tool)
      .As(&ComplianceSupervisor::Next);
  Compute(yields).From(memory_).As([](const Memory& m) { return m.yields; });
  Compute(target).From(memory_).As(&ComplianceSupervisor::Target);
  Compute(target_twist).From(memory_).As(&ComplianceSupervisor::TargetTwist);
  Compute(target_acceleration).From(memory_).As(&ComplianceSupervisor::TargetAcceleration);
  Compute(pose_stiffness).From(memory_).As([](const Memory& m) {
    return Same(m.gains(kPoseStiffness));
  });
  Compute(pose_damping).From(memory_).As([](const Memory& m) {
    return Same(m.gains(kPoseDamping));
  });
  Compute(pose_compliance).From(memory_).As([](const Memory& m) {
    return TaskMatrix(m.gains(kPoseCompliance) * TaskMatrix::Identity(6, 6));
  });
  Compute(posture_stiffness).From(memory_).As(&ComplianceSupervisor::PostureStiffness);
  Compute(posture_damping).From(memory_).As(&ComplianceSupervisor::PostureDamping);
  Compute(posture_compliance).From(memory_).As(&ComplianceSupervisor::PostureCompliance);
}

const ComplianceGains& ComplianceSupervisor::GainsOf(const Memory& m) const {
  if (m.brakes) return o_.braking;
  if (m.yields) return o_.yielding;
  switch (m.mode) {
    case ComplianceMode::Stiff:
      return o_.stiff;
    case ComplianceMode::FullBody:
      return o_.full_body;
    default:
      return o_.null_space;
  }
}

ComplianceSupervisor::Memory ComplianceSupervisor::Next(const Memory& last,
                                                        const ComplianceMode& asked,
                                                        const bool& moves, const bool& halts,
                                                        const Wrench& W,
                                                        const FrameDynamics& at) const {
  Memory m = last;
  m.mode = asked;
  m.brakes = halts;
  const bool swings = moves && !halts;
  const double push = o_.norm == WrenchNorm::Force ? W.tail<3>().norm() : W.norm();
  // A push that is no number changes nothing.
  m.yields = asked == ComplianceMode::Dual && (last.yields ? !(push < o_.leave) : push >= o_.enter);
  if (!last.started) {
    m.started = true;
    m.anchor = at.pose;
    m.from = m.gains = Numbers(GainsOf(m));
  }

  const double part = h_ / o_.change_s;
  if (m.swings != swings && (m.swung == 0 || m.swung == 1)) {
    if (!m.swings) m.time = 0;
    m.swings = swings;
  }
  m.swung = std::clamp(m.swung + (m.swings ? part : -part), 0.0, 1.0);
  m.time += h_;

  const bool changes =
      last.started && (m.mode != last.mode || m.yields != last.yields || m.brakes != last.brakes);
  if (changes) {
    const Vector6 e = Away(at.pose, Target(m));
    m.held = (1 - last.changed) * last.held + last.gains(kPoseStiffness) * e;
    m.anchor.position += e.tail<3>();
    m.anchor.rotation = at.pose.rotation;
    m.from = last.gains;
    m.changed = 0;
  }
  m.changed = std::min(1.0, m.changed + part);
  m.gains = m.from + m.changed * (Numbers(GainsOf(m)) - m.from);
  return m;
}

/// A ½ (1 − cos 2π f t)
internal::Course ComplianceSupervisor::Way(const Memory& m) const {
  internal::Course A = internal::LeastJerk(m.swung * o_.change_s, o_.change_s);
  if (!m.swings) A.rate = -A.rate;
  const internal::Course wave = internal::Swing(m.time, o_.swing_hz);
  return {A.s * wave.s, A.rate * wave.s + A.s * wave.rate,
          A.acceleration * wave.s + 2 * A.rate * wave.rate + A.s * wave.acceleration};
}

Pose ComplianceSupervisor::Target(const Memory& m) const {
  Pose X = m.anchor;
  X.position += Way(m).s * o_.swing;
  return X;
}

Twist ComplianceSupervisor::TargetTwist(const Memory& m) const {
  Twist V;
  V << 0, 0, 0, Way(m).rate * o_.swing;
  return V;
}

Twist ComplianceSupervisor::TargetAcceleration(const Memory& m) const {
  Twist a;
  a << 0, 0, 0, Way(m).acceleration * o_.swing;
  return a - Twist((1 - m.changed) * m.held);
}

PerJoint ComplianceSupervisor::PostureStiffness(const Memory& m) const {
  return PerJoint::Constant(o_.joints, m.gains(kStiffness));
}

PerJoint ComplianceSupervisor::PostureDamping(const Memory& m) const {
  return PerJoint::Constant(o_.joints, m.gains(kDamping));
}

JointMatrix ComplianceSupervisor::PostureCompliance(const Memory& m) const {
  return m.gains(kCompliance) * JointMatrix::Identity(o_.joints, o_.joints);
}

}  // namespace pliant
