#include "pliant/plants/joint_sensors.h"

#include <cmath>
#include <numbers>
#include <string>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

/// What random numbers are for: other numbers than in other sensors, so that all may have one seed.
enum Use : std::uint64_t {
  kPosition = 100,
  kVelocity,
  kTorque,
  kDrift,
  kCurrent,
  kBias,
};

/// x + σ ∘ ξ_k, and x itself where σ is 0.
PerJoint Noisy(PerJoint x, const PerJoint& sigma, const RandomStream& random, std::uint64_t k) {
  for (int i = 0; i < x.size(); ++i)
    if (sigma(i) > 0) x(i) += sigma(i) * random.Part(static_cast<std::uint64_t>(i)).Normal(k);
  return x;
}

}  // namespace

JointSensors::JointSensors(const Options& o)
    : position{this, "position", o.joints},
      velocity{this, "velocity", o.joints},
      torque{this, "torque", o.joints},
      current{this, "current", o.joints, MotorCurrent::Zero(o.joints)},
      measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints},
      measured_current{this, "measured_current", o.joints},
      h_{seconds(o.period)},
      quantum_{
          EachInRangeOr0("position_quantum", o.position_quantum, "rad", kNotNegative, o.joints)},
      sigma_q_{EachInRangeOr0("position_noise", o.position_noise, "rad", kNotNegative, o.joints)},
      alpha_{1 - (-2 * std::numbers::pi * h_ *
                  EachInRangeOr0("velocity_cutoff_hz", o.velocity_cutoff_hz, "Hz", kNotNegative,
                                 o.joints)
                      .array())
                     .exp()},
      sigma_v_{EachInRangeOr0("velocity_noise", o.velocity_noise, "rad/s", kNotNegative, o.joints)},
      sigma_tau_{EachInRangeOr0("torque_noise", o.torque_noise, "N·m", kNotNegative, o.joints)},
      bias_{EachInRangeOr0("torque_bias", o.torque_bias, "N·m", kAnyNumber, o.joints)},
      sigma_d_{EachInRangeOr0("torque_drift", o.torque_drift, "N·m", kNotNegative, o.joints)},
      sigma_i_{EachInRangeOr0("current_noise", o.current_noise, "A", kNotNegative, o.joints)},
      a_{std::exp(-h_ / o.torque_drift_time_s)},
      fresh_{std::sqrt(-std::expm1(-2 * h_ / o.torque_drift_time_s))},
      random_{o.seed},
      last_position_{this, "last_position", o.joints},
      drift_{this, "drift", o.joints} {
  RequireInRange("", "torque_drift_time_s", o.torque_drift_time_s, "s", kPositive);
  for (int i = 0; i < o.joints.size(); ++i)
    Require(alpha_(i) == 0 || sigma_v_(i) == 0,
            "velocity_noise[" + o.joints[i] +
                "] must be 0 rad/s where velocity_cutoff_hz is > 0: position_noise makes it",
            sigma_v_(i));
  const PeriodicEvent tick = Every(o.period);
  tick.Compute(measured_position).From(position, clock).As(&JointSensors::MeasurePosition);
  tick.Compute(measured_velocity)
      .From(measured_velocity, measured_position, last_position_, velocity, clock)
      .As(&JointSensors::MeasureVelocity);
  tick.Update(last_position_).From(measured_position).As([](const JointPosition& q) { return q; });
  tick.Compute(drift_).From(drift_, clock).As(&JointSensors::Drift);
  tick.Compute(measured_torque).From(torque, drift_, clock).As(&JointSensors::MeasureTorque);
  tick.Compute(measured_current).From(current, clock).As(&JointSensors::MeasureCurrent);
}

JointPosition JointSensors::MeasurePosition(const JointPosition& q, double t) const {
  JointPosition measured = Noisy(q, sigma_q_, random_.Part(kPosition), TickAt(t, h_));
  for (int i = 0; i < measured.size(); ++i)
    if (quantum_(i) > 0) measured(i) = quantum_(i) * std::round(measured(i) / quantum_(i));
  return measured;
}

JointVelocity JointSensors::MeasureVelocity(const JointVelocity& last, const JointPosition& q,
                                            const JointPosition& last_q, const JointVelocity& v,
                                            double t) const {
  const std::uint64_t k = TickAt(t, h_);
  JointVelocity measured = Noisy(v, sigma_v_, random_.Part(kVelocity), k);
  for (int i = 0; i < measured.size(); ++i)
    if (k > 0 && alpha_(i) > 0)
      measured(i) = last(i) + alpha_(i) * ((q(i) - last_q(i)) / h_ - last(i));
  return measured;
}

JointTorque JointSensors::Drift(const JointTorque& last, double t) const {
  const std::uint64_t k = TickAt(t, h_);
  const RandomStream random = random_.Part(kDrift);
  if (k == 0) return Noisy(PerJoint::Zero(last.size()), sigma_d_, random, k);
  return Noisy(a_ * last, fresh_ * sigma_d_, random, k);
}

JointTorque JointSensors::MeasureTorque(const JointTorque& tau, const JointTorque& drift,
                                        double t) const {
  return Noisy(tau + bias_ + drift, sigma_tau_, random_.Part(kTorque), TickAt(t, h_));
}

MotorCurrent JointSensors::MeasureCurrent(const MotorCurrent& i, double t) const {
  return Noisy(i, sigma_i_, random_.Part(kCurrent), TickAt(t, h_));
}

JointSensors::Options Gen3JointSensors(const Joints& joints, Duration period, std::uint64_t seed) {
  Require(joints.size() == 7, "a Gen3 has 7 joints", joints.size());
  const RandomStream random = RandomStream(seed).Part(kBias);
  PerJoint bias(7);
  for (int i = 0; i < 7; ++i) bias(i) = random.Uniform(static_cast<std::uint64_t>(i)) - 0.5;
  return {.joints = joints,
          .period = period,
          .position_quantum = PerJoint::Constant(7, 5e-7),
          .position_noise = PerJoint::Constant(7, 1e-5),
          .velocity_cutoff_hz = PerJoint::Constant(7, 95),
          .torque_noise = PerJoint{{0.15, 0.15, 0.15, 0.15, 0.08, 0.08, 0.08}},
          .torque_bias = bias,
          .torque_drift = PerJoint::Constant(7, 0.05),
          .torque_drift_time_s = 600,
          .seed = seed};
}

}  // namespace pliant
