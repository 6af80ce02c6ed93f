#include "pliant/estimators/super_twisting_observer.h"

#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

SuperTwistingObserver::Memory Blank(const Joints& joints) {
  return {JointTorque::Zero(joints), JointMomentum::Zero(joints), JointMomentum::Zero(joints),
          JointTorque::Zero(joints), false};
}

}  // namespace

SuperTwistingObserver::SuperTwistingObserver(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      torque{this, "torque", o.joints},
      residual{this, "residual", o.joints},
      k1_{1.5 * o.rate.cwiseSqrt()},
      k3_{1.1 * o.rate},
      B_{EachInRangeOr0("rotor_inertia", o.rotor_inertia, "kg·m²", kNotNegative, o.joints)},
      h_{seconds(o.period)},
      memory_{this, "memory", o.joints, Blank(o.joints)} {
  RequireEachInRange("rate", o.rate, "N·m/s", kPositive, o.joints);
  Every(o.period).Compute(memory_).From(memory_, dynamics, torque).As(&SuperTwistingObserver::Next);
  Compute(residual).From(memory_).As([](const Memory& m) { return m.sigma; });
}

SuperTwistingObserver::Memory SuperTwistingObserver::Next(const Memory& last,
                                                          const RobotDynamics& d,
                                                          const JointTorque& tau) const {
  Memory now{last.sigma, last.s, d.p - B_.cwiseProduct(d.v), d.coriolis_transposed - d.gravity,
             true};
  if (!last.started) return now;
  const PerJoint h_tau_e = now.p - last.p - h_ * (tau + 0.5 * (now.beta + last.beta));
  for (Eigen::Index j = 0; j < h_tau_e.size(); ++j) {
    const double b = last.s(j) + h_tau_e(j) - h_ * last.sigma(j);
    const double beyond = std::abs(b) - h_ * h_ * k3_(j);
    if (beyond <= 0) {
      now.s(j) = 0;
      now.sigma(j) = last.sigma(j) + b / h_;
    } else {
      const double hk = h_ * k1_(j);
      const double root = 0.5 * (-hk + std::sqrt(hk * hk + 4 * beyond));
      now.s(j) = std::copysign(root * root, b);
      now.sigma(j) = last.sigma(j) + std::copysign(h_ * k3_(j), b);
    }
  }
  return now;
}

}  // namespace pliant
