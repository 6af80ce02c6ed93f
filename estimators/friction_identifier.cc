#include "pliant/estimators/friction_identifier.h"

#include <cmath>
#include <string>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

FrictionIdentifier::Memory Empty(const Joints& joints, int capacity) {
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(capacity, joints.size());
  return {.velocity = none, .torque = none};
}

IdentifiedJoints Unknown(const Joints& joints) {
  IdentifiedJoints found;
  found.Fields(
      [&](const char*, PerJoint& each, const char*) { each = PerJoint::Zero(joints.size()); });
  return found;
}

}  // namespace

FrictionIdentifier::FrictionIdentifier(const Options& o)
    : velocity{this, "velocity", o.joints},
      motor_torque{this, "motor_torque", o.joints},
      torque{this, "torque", o.joints},
      acceleration{this, "acceleration", o.joints, JointAcceleration::Zero(o.joints)},
      trigger{this, "trigger"},
      gate{this, "gate", {}, true},
      friction{this, "friction", o.joints, Unknown(o.joints)},
      B_{EachInRangeOr0("reflected_inertia", o.reflected_inertia, "kg·m²", kNotNegative, o.joints)},
      fit_{o.fit},
      capacity_{o.capacity},
      memory_{this, "memory", o.joints, Empty(o.joints, o.capacity)} {
  Require(o.capacity >= 64 && o.capacity <= 65'536, "capacity must be from 64 to 65536",
          o.capacity);
  RequireSound(o.fit);
  Every(o.period)
      .Compute(memory_)
      .From(velocity, motor_torque, torque, acceleration, trigger, gate)
      .As(&FrictionIdentifier::Gather);
  Every(o.period).Compute(friction).From(memory_).As(&FrictionIdentifier::Solve);
}

void FrictionIdentifier::Gather(Memory& m, const JointVelocity& v, const JointTorque& tau_m,
                                const JointTorque& tau, const JointAcceleration& a,
                                bool trigger_now, bool gate_now) const {
  m.solve = trigger_now && !m.triggered;
  m.triggered = trigger_now;
  const PerJoint y = tau_m - tau - B_.cwiseProduct(a);
  if (!gate_now || !v.allFinite() || !y.allFinite()) return;
  const bool taken = std::fmod(m.seen, m.stride) == 0;
  ++m.seen;
  if (!taken) return;
  if (m.count == capacity_) {
    m.count = (m.count + 1) / 2;
    for (int k = 0; k < m.count; ++k) {
      m.velocity.row(k) = m.velocity.row(2 * k);
      m.torque.row(k) = m.torque.row(2 * k);
    }
    m.stride *= 2;
    if (std::fmod(m.seen - 1, m.stride) != 0) return;
  }
  m.velocity.row(m.count) = v.transpose();
  m.torque.row(m.count) = y.transpose();
  ++m.count;
}

void FrictionIdentifier::Solve(IdentifiedJoints& found, const Memory& m) const {
  if (!m.solve) return;
  for (Eigen::Index j = 0; j < m.velocity.cols(); ++j) {
    FrictionSamples samples{.velocity = m.velocity.col(j).head(m.count),
                            .torque = m.torque.col(j).head(m.count)};
    found.Fields([&](const char*, PerJoint& each, const char*) { each(j) = 0; });
    if (CountSliding(samples, fit_).all() < LeastSamplesOf(fit_)) {
      found.status(j) = static_cast<double>(FrictionStatus::TooFewSamples);
      continue;
    }
    const FrictionFit fit = FitFriction(samples, fit_);
    const auto put = [&](const char* name, PerJoint& value, PerJoint& error) {
      if (const auto mean = fit.MeanOf(name)) {
        value(j) = mean->value;
        error(j) = mean->deviation;
      }
    };
    put("coulomb", found.coulomb, found.coulomb_error);
    put("viscous", found.viscous, found.viscous_error);
    put("stiction", found.stiction, found.stiction_error);
    put("stribeck_velocity", found.stribeck_velocity, found.stribeck_error);
    put("offset", found.offset, found.offset_error);
    const FrictionEstimate *c = fit.Find("coulomb"), *d = fit.Find("viscous");
    if (c && d)
      found.coulomb_viscous(j) = fit.covariance(c - fit.estimates.data(), d - fit.estimates.data());
    found.residual(j) = fit.scale;
    found.lack_of_fit(j) = fit.lack_of_fit;
    found.status(j) = static_cast<double>(
        fit.unidentified.empty() ? FrictionStatus::Identified : FrictionStatus::PartlyIdentified);
  }
}

}  // namespace pliant
