#include "pliant/controllers/friction_compensation.h"

#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

FrictionCompensation::FrictionCompensation(const Options& o)
    : velocity{this, "velocity", o.joints},
      acceleration{this, "acceleration", o.joints},
      torque{this, "torque", o.joints},
      o_{o} {
  RequireEachInRange("coulomb", o.coulomb, "N·m", kNotNegative, o.joints);
  RequireEachInRange("viscous", o.viscous, "N·m·s/rad", kNotNegative, o.joints);
  RequireEachInRange("stiction", o.stiction, "N·m", kNotNegative, o.joints);
  RequireInRange("", "velocity_threshold", o.velocity_threshold, "rad/s", kPositive);
  RequireInRange("", "acceleration_threshold", o.acceleration_threshold, "rad/s²", kPositive);
  Compute(torque).From(velocity, acceleration).As(&FrictionCompensation::Compensate);
}

JointTorque FrictionCompensation::Compensate(const JointVelocity& v,
                                             const JointAcceleration& a) const {
  JointTorque tau = PerJoint::Zero(v.size());
  for (Eigen::Index j = 0; j < v.size(); ++j)
    if (std::abs(v(j)) >= o_.velocity_threshold)
      tau(j) = std::copysign(o_.coulomb(j), v(j)) + o_.viscous(j) * v(j);
    else if (std::abs(a(j)) >= o_.acceleration_threshold)
      tau(j) = std::copysign(o_.stiction(j), a(j));
  return tau;
}

}  // namespace pliant
