#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// Uncoupled joints without a robot: q̇ = v, m v̇ = τ − τ_f.
class Masses final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint inertia;  ///< m [kg·m²]
    JointPosition start = {};
  };

  explicit Masses(const Options& o)
      : torque{this, "torque", o.joints, JointTorque::Zero(o.joints)},
        friction{this, "friction", o.joints, JointTorque::Zero(o.joints)},
        position{this, "position", o.joints},
        velocity{this, "velocity", o.joints},
        acceleration{this, "acceleration", o.joints},
        q{this, "q", o.joints, o.start.size() > 0 ? o.start : JointPosition::Zero(o.joints)},
        v{this, "v", o.joints},
        m_{o.inertia} {
    Derivative(q).From(v).As([](const JointVelocity& now) { return now; });
    Derivative(v).From(acceleration).As([](const JointAcceleration& now) { return now; });
    Compute(position).From(q).As([](const JointPosition& now) { return now; });
    Compute(velocity).From(v).As([](const JointVelocity& now) { return now; });
    Compute(acceleration).From(torque, friction).As(&Masses::Accelerate);
  }

  Input<JointTorque> torque, friction;
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Continuous<JointPosition> q;
  Continuous<JointVelocity> v;

 private:
  JointAcceleration Accelerate(const JointTorque& tau, const JointTorque& tau_f) const {
    return (tau - tau_f).cwiseQuotient(m_);
  }
  const PerJoint m_;
};

}  // namespace pliant
