#include "pliant/controllers/null_space_impedance.h"

#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

NullSpaceImpedance::NullSpaceImpedance(const Options& o)
    : null_space{this, "null_space", o.joints, NullSpace(o.joints.size())},
      velocity{this, "velocity", o.joints},
      desired_velocity{this, "desired_velocity", o.joints},
      torque{this, "torque", o.joints},
      o_{o} {
  RequireInRange("", "damping", o.damping, "N·m·s/rad", kPositive);
  RequireInRange("", "friction_gain", o.friction_gain, "", kNotNegative);
  RequireInRange("", "damping_gain", o.damping_gain, "N·m·s/rad", kNotNegative);
  if (o.coulomb.size() > 0)
    RequireEachInRange("coulomb", o.coulomb, "N·m", Range{.least = 0, .most = kUnbounded},
                       o.joints);
  Compute(desired_velocity)
      .From(null_space, desired)
      .As([](const NullSpace& of, const LinearVelocity& v) {
        return JointVelocity(of.inverse.rightCols<3>().lazyProduct(v));
      });
  Compute(torque).From(null_space, desired_velocity, velocity).As(&NullSpaceImpedance::Act);
}

JointTorque NullSpaceImpedance::Act(const NullSpace& of, const JointVelocity& qd_dot,
                                    const JointVelocity& v) const {
  PerJoint wanted;
  if (o_.law == NullSpaceLaw::Printed) {
    wanted = o_.damping * (o_.friction_gain * qd_dot + o_.damping_gain / o_.damping * (qd_dot - v));
  } else {
    wanted = o_.damping_gain * (qd_dot - v);
    for (Eigen::Index j = 0; j < o_.coulomb.size(); ++j) {
      const double c = o_.coulomb(j), viscous = o_.damping * v(j);
      const double friction = c == kUnbounded ? viscous : c > 0 ? c * std::tanh(viscous / c) : 0;
      wanted(j) += o_.friction_gain * friction;
    }
  }
  return of.projector.lazyProduct(wanted);
}

}  // namespace pliant
