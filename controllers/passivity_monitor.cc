#include "pliant/controllers/passivity_monitor.h"

#include "pliant/systems/elements.h"

namespace pliant {

PassivityMonitor::PassivityMonitor(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      desired_velocity{this, "desired_velocity", o.joints},
      external_torque{this, "external_torque", o.joints},
      o_{o} {
  RequireEachInRange("damping", o.damping, "N·s/m", kNotNegative);
  RequireEachInRange("stiffness", o.stiffness, "N·m/rad", kNotNegative);
  RequireInRange("", "rate_gain_s", o.rate_gain_s, "s", kNotNegative);
  RequireInRange("", "from_s", o.from_s, "s", kNotNegative);
  Every(o.period)
      .Compute(account_)
      .From(account_, clock, dynamics, desired_velocity, orientation_error, velocity_error,
            external_torque)
      .As(&PassivityMonitor::Next);
  Compute(storage).From(account_).As([](const Account& a) { return a.storage; });
  Compute(supply).From(account_).As([](const Account& a) { return a.supply; });
  Compute(excess).From(account_).As(
      [](const Account& a) { return a.storage - a.first - a.supply; });
}

PassivityMonitor::Account PassivityMonitor::Next(
    const Account& last, double t, const RobotDynamics& d, const JointVelocity& qd_dot,
    const OrientationError& e_r, const LinearVelocity& e_p, const JointTorque& tau_e) const {
  if (t < o_.from_s) return last;
  const PerJoint e_q = qd_dot - d.v;
  const PerJoint momentum = d.M.lazyProduct(e_q);
  const double storage = 0.5 * e_q.dot(momentum) + 0.5 * e_r.dot(o_.stiffness.cwiseProduct(e_r)) +
                         0.5 * o_.rate_gain_s * e_p.dot(o_.damping.cwiseProduct(e_p));
  const double power = -e_q.dot(tau_e);
  if (!last.started) return {storage, storage, power, 0, true};
  return {storage, last.first, power, last.supply + 0.5 * seconds(o_.period) * (last.power + power),
          true};
}

}  // namespace pliant
