#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// Damped springs at the joints, also called joint stiffness control:
///
///   τ = K (q₀ − q) + D (v₀ − v) + τ₀
///
/// τ₀ is what is to be there anyway, such as the torque of gravity. All but q and v may be wired or
/// stay at what the options say, and gains may change while running. Source: Hogan, ASME J. Dynamic
/// Systems, Measurement, and Control 107 (1985) 1, part I.
class JointImpedance final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint stiffness;  ///< K [N·m/rad], each ≥ 0
    PerJoint damping;    ///< D [N·m·s/rad], each ≥ 0
  };

  explicit JointImpedance(const Options& o)
      : position{this, "position", o.joints},
        velocity{this, "velocity", o.joints},
        rest{this, "rest", o.joints},
        rest_velocity{this, "rest_velocity", o.joints, JointVelocity::Zero(o.joints)},
        feedforward{this, "feedforward", o.joints, JointTorque::Zero(o.joints)},
        stiffness{this, "stiffness", o.joints, Checked("stiffness", o.stiffness, "N·m/rad", o)},
        damping{this, "damping", o.joints, Checked("damping", o.damping, "N·m·s/rad", o)},
        torque{this, "torque", o.joints} {
    Compute(torque)
        .From(position, velocity, rest, rest_velocity, feedforward, stiffness, damping)
        .As(&JointImpedance::Law);
  }

  Input<JointPosition> position;       ///< q
  Input<JointVelocity> velocity;       ///< v
  Input<JointPosition> rest;           ///< q₀
  Input<JointVelocity> rest_velocity;  ///< v₀; 0 if not connected
  Input<JointTorque> feedforward;      ///< τ₀; 0 if not connected
  Input<PerJoint> stiffness;           ///< K
  Input<PerJoint> damping;             ///< D
  Output<JointTorque> torque;          ///< τ

 private:
  static PerJoint Checked(const char* name, const PerJoint& gain, const char* unit,
                          const Options& o) {
    RequireEachInRange(name, gain, unit, kNotNegative, o.joints);
    return gain;
  }

  JointTorque Law(const JointPosition& q, const JointVelocity& v, const JointPosition& q0,
                  const JointVelocity& v0, const JointTorque& tau0, const PerJoint& K,
                  const PerJoint& D) const {
    return K.cwiseProduct(q0 - q) + D.cwiseProduct(v0 - v) + tau0;
  }
};

}  // namespace pliant
