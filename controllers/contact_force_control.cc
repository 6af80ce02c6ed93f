#include "pliant/controllers/contact_force_control.h"

#include <algorithm>

#include "pliant/controllers/compliance.h"
#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Status = ContactForceStatus;

Eigen::Matrix3d Gain(const TaskMatrix& given, std::string_view name, std::string_view symbol) {
  return ComplianceOf<TaskMatrix>(given, 3, name, symbol);
}

}  // namespace

ContactForceControl::ContactForceControl(const Options& o)
    : contact{this, "contact"},
      dynamics{this, "dynamics", o.model.joints()},
      status{this, "status", {}, Status::Idle},
      wanted{this, "wanted"},
      objective{this, "objective", o.model.joints(), Objective::Zero(3, o.model.size())},
      model_{o.model},
      settings_{o.settings},
      inertia_{o.settings.inertia},
      K_d_{Gain(o.settings.damping, "damping", "K_d")},
      K_f_{Gain(o.settings.force_gain, "force_gain", "K_f")},
      K_h_{Gain(o.settings.hold_stiffness, "hold_stiffness", "K_h")},
      D_h_{Gain(o.settings.hold_damping, "hold_damping", "D_h")},
      weight_{o.weight},
      memory_{this, "memory"} {
  RequireInRange("", "weight", o.weight, "", kPositive);
  RequireInRange("", o.settings);
  if (const FixedForce* fixed = std::get_if<FixedForce>(&o.settings.wanted))
    RequireEachInRange("wanted.force", fixed->force, "N", kAnyNumber);
  else
    RequireInRange("wanted", std::get<CompatibleForce>(o.settings.wanted));
  Every(o.period).Compute(memory_).From(memory_, contact, dynamics).As(&ContactForceControl::Next);
  Compute(status).From(memory_).As([](const Memory& m) { return m.status; });
  Compute(wanted).From(memory_, contact).As(&ContactForceControl::Wanted);
  Compute(objective).From(memory_, contact, dynamics, wanted).As(&ContactForceControl::Want);
}

ContactForceControl::Memory ContactForceControl::Next(const Memory& last, const AnchoredContact& c,
                                                      const RobotDynamics& d) const {
  if (!IsLink(model_, c.link)) return Memory{};
  const PointMotion x = MotionOf(model_, d, c.link, c.point);
  Memory now = last;
  const bool guarded = last.status == Status::TooFast || last.status == Status::TooFar;
  if (c.touched && (last.status == Status::Idle || last.status == Status::Holding))
    now.status = Status::Regulating;
  if (c.begins || now.status != last.status) now.start = x.position;
  if (c.begins && guarded) now.hold = x.position;
  if (!c.touched && last.status != Status::Holding) {
    if (!guarded) now.hold = x.position;
    now.status = Status::Holding;
  }
  if (now.status == Status::Regulating) {
    const bool fast = x.velocity.norm() > settings_.speed_limit;
    const bool far = (x.position - now.start).norm() > settings_.way_limit;
    if (fast || far) now.hold = x.position;
    if (far) now.status = Status::TooFar;
    if (fast) now.status = Status::TooFast;
  }
  return now;
}

Force ContactForceControl::Wanted(const Memory& m, const AnchoredContact& c) const {
  if (m.status != Status::Regulating) return Force();
  if (const FixedForce* fixed = std::get_if<FixedForce>(&settings_.wanted)) return fixed->force;
  const CompatibleForce& compatible = std::get<CompatibleForce>(settings_.wanted);
  return compatible.force / std::max(c.force.norm(), compatible.floor) * c.force;
}

void ContactForceControl::Want(Objective& out, const Memory& m, const AnchoredContact& c,
                               const RobotDynamics& d, const Force& F_d) const {
  out.weight = 0;
  if (m.status == Status::Idle || !IsLink(model_, c.link)) return;
  const FrameDynamics x = PointDynamics(model_, d, c.link, c.point);
  const Eigen::Vector3d v = x.twist.tail<3>();
  Eigen::Vector3d f;
  if (m.status == Status::Regulating)
    f = K_f_ * (c.force - F_d) - K_d_ * v;
  else
    f = K_h_ * (m.hold - x.pose.position) - D_h_ * v + c.force;
  const Eigen::Vector3d xddot = inertia_.Accelerate(d, x, f);
  if (!xddot.allFinite()) return;
  out.A = x.J.bottomRows<3>();
  out.b = xddot - x.Jdot_v.tail<3>();
  out.weight = weight_;
}

}  // namespace pliant
