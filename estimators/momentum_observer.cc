#include "pliant/estimators/momentum_observer.h"

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

MomentumObserver::Memory Blank(const Joints& joints) {
  return {JointTorque::Zero(joints), JointMomentum::Zero(joints), JointTorque::Zero(joints), false};
}

}  // namespace

MomentumObserver::MomentumObserver(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      torque{this, "torque", o.joints},
      residual{this, "residual", o.joints},
      decay_{(-o.gain * seconds(o.period)).array().exp()},
      B_{EachInRangeOr0("rotor_inertia", o.rotor_inertia, "kg·m²", kNotNegative, o.joints)},
      h_{seconds(o.period)},
      memory_{this, "memory", o.joints, Blank(o.joints)} {
  RequireEachInRange("gain", o.gain, "1/s", kPositive, o.joints);
  Every(o.period).Compute(memory_).From(memory_, dynamics, torque).As(&MomentumObserver::Next);
  Compute(residual).From(memory_).As([](const Memory& m) { return m.r; });
}

MomentumObserver::Memory MomentumObserver::Next(const Memory& last, const RobotDynamics& d,
                                                const JointTorque& tau) const {
  Memory now{last.r, d.p - B_.cwiseProduct(d.v), d.coriolis_transposed - d.gravity, true};
  if (!last.started) return now;
  const PerJoint tau_e = (now.p - last.p) / h_ - tau - 0.5 * (now.beta + last.beta);
  now.r = decay_.cwiseProduct(last.r) + (1 - decay_.array()).matrix().cwiseProduct(tau_e);
  return now;
}

}  // namespace pliant
