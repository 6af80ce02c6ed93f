#include "pliant/controllers/contact_impedance.h"

#include "pliant/controllers/compliance.h"

namespace pliant {

ContactImpedance::ContactImpedance(const Options& o)
    : contact{this, "contact"},
      dynamics{this, "dynamics", o.model.joints()},
      displacement{this, "displacement", {}, Position()},
      displacement_velocity{this, "displacement_velocity", {}, LinearVelocity()},
      displacement_acceleration{this, "displacement_acceleration", {}, LinearAcceleration()},
      error{this, "error"},
      objective{this, "objective", o.model.joints(), Objective::Zero(3, o.model.size())},
      model_{o.model},
      inertia_{o.gains.inertia},
      K_d_{ComplianceOf<TaskMatrix>(o.gains.damping, 3, "damping", "K_d")},
      K_p_{ComplianceOf<TaskMatrix>(o.gains.stiffness, 3, "stiffness", "K_p")},
      weight_{o.weight} {
  RequireInRange("", "weight", o.weight, "", kPositive);
  Compute(error).From(contact, dynamics, displacement).As(&ContactImpedance::Error);
  Compute(objective)
      .From(contact, dynamics, error, displacement_velocity, displacement_acceleration)
      .As(&ContactImpedance::Want);
}

Position ContactImpedance::Error(const AnchoredContact& c, const RobotDynamics& d,
                                 const Position& moved) const {
  if (!IsLink(model_, c.link)) return Position();
  return c.anchor + moved - MotionOf(model_, d, c.link, c.point).position;
}

void ContactImpedance::Want(Objective& out, const AnchoredContact& c, const RobotDynamics& d,
                            const Position& e, const LinearVelocity& xdot_d,
                            const LinearAcceleration& xddot_d) const {
  out.weight = 0;
  if (!IsLink(model_, c.link)) return;
  const FrameDynamics x = PointDynamics(model_, d, c.link, c.point);
  const Eigen::Vector3d edot = xdot_d - x.twist.tail<3>();
  const Eigen::Vector3d xddot = inertia_.Accelerate(d, x, K_d_ * edot + K_p_ * e + c.force);
  if (!xddot.allFinite()) return;
  out.A = x.J.bottomRows<3>();
  out.b = xddot_d + xddot - x.Jdot_v.tail<3>();
  out.weight = weight_;
}

}  // namespace pliant
